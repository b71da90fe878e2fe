//! Records of sessions: what is read, what is refused, and what a trend says of them.

use sinew_lab::robot_dir;
use sinew_lab::rope::Catalogue;
use sinew_lab::trend::{
    RecordError, SessionRecord, Stated, TrendReport, TrendRequest, analyze, date::parse_utc_s,
    html, prior, records_from_csv, records_from_json, sort,
};
use sinew_model::robot::Robot;
use std::path::Path;

const DAY_S: f64 = 86_400.0;

fn robot() -> Robot {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/biorob-like");
    robot_dir::load(&place, None).unwrap().robot
}

fn utc(text: &str) -> f64 {
    parse_utc_s(text).unwrap()
}

/// A session of the elbow, so many days after 2026-03-01.
fn session(day: f64, offset_mrad: f64) -> SessionRecord {
    SessionRecord {
        source: format!("day {day}"),
        robot: Some("biorob-like".into()),
        recording: None,
        baseline: Some("march".into()),
        time_utc_s: utc("2026-03-01") + day * DAY_S,
        duration_s: Some(60.0),
        joint: "elbow".into(),
        offset_mrad: Some([offset_mrad, 0.6]),
        temperature_c: Some(21.0),
        stiffness_percent: None,
    }
}

fn report(records: Vec<SessionRecord>, stated: Vec<Stated>) -> TrendReport {
    let robot = robot();
    let catalogue = Catalogue::shipped().unwrap();
    let request = TrendRequest {
        robot: Some(&robot),
        catalogue: &catalogue,
        stated,
        duty: None,
        horizon_days: 1095.0,
        seed: 1,
    };
    analyze(sort(records, None).unwrap(), &request).unwrap()
}

fn tensioned(day: f64) -> Stated {
    Stated {
        joint: None,
        time_utc_s: utc("2026-03-01") + day * DAY_S,
        replaced: false,
    }
}

/// Errors of about 0.25 mrad without a generator: irrational steps.
fn wobble(i: f64) -> f64 {
    0.35 * (i * 12.9898).sin()
}

#[test]
fn csv_says_line_and_cure() {
    let head = "time,joint,offset_mrad,interval_95_mrad,temperature_c\n";
    let good = records_from_csv(
        &format!("{head}# a note\n2026-03-01T08:30Z,elbow,1.5,0.4,21\n2026-03-02,elbow,,,\n"),
        "s.csv",
    )
    .unwrap();
    assert_eq!(good[0].offset_mrad, Some([1.5, 0.4]));
    assert_eq!(good[0].time_utc_s, utc("2026-03-01T08:30Z"));
    assert_eq!((good[1].offset_mrad, good[1].temperature_c), (None, None));
    for (row, words) in [
        ("yesterday,elbow,1,0.4,21", "no date"),
        ("2026-03-01,elbow,nan,0.4,21", "not a finite number"),
        ("2026-03-01,elbow,1,0,21", "above 0 mrad"),
        ("2026-03-01,elbow,1,-0.3,21", "above 0 mrad"),
        ("2026-03-01,elbow,1,,21", "empty beside an offset"),
        ("2026-03-01,elbow,9999,1,21", "half a turn"),
        ("2026-03-01,,1,1,21", "'joint' is empty"),
        ("2026-03-01,elbow,1,1,warm", "temperature_c"),
    ] {
        let error = records_from_csv(&format!("{head}{row}\n"), "s.csv")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(words) && error.contains("s.csv, line 2"),
            "{row}: {error}"
        );
    }
    let error = records_from_csv("time,joint\n", "s.csv")
        .unwrap_err()
        .to_string();
    assert!(error.contains("no column 'offset_mrad'"), "{error}");
}

#[test]
fn what_estimate_prints_is_read() {
    let joints = r#"[{"name": "elbow", "offset_mrad": 1.5, "interval_95_mrad": 0.4, "verdict": "longer",
        "stiffness_change_percent": [-2.0, 1.0]},
        {"name": "wrist", "offset_mrad": 9.0, "interval_95_mrad": 16.0, "verdict": "can't tell"}]"#;
    let estimate = format!(
        r#"{{"recording": {{"path": "a.mcap", "start_time_ns": 1772353800000000000}},
            "robot": {{"name": "arm"}}, "joints": [],
            "absolute": {{"recording": "a.mcap", "baseline": "b", "duration_s": 60.0, "joints": {joints}}}}}"#
    );
    let read = records_from_json(&estimate, "a.json").unwrap();
    assert_eq!(read.len(), 2);
    assert_eq!(read[0].time_utc_s, 1_772_353_800.0);
    assert_eq!(read[0].robot.as_deref(), Some("arm"));
    assert_eq!(read[0].stiffness_percent, Some([-2.0, 1.0]));
    assert_eq!(read[1].offset_mrad, None, "it couldn't tell");
    // The absolute estimate alone, with a date of its own; a list; one document after another.
    let alone = format!(
        r#"{{"start_time_utc_s": 1772353800.0, "temperature_c": 22.5, "joints": {joints}}}"#
    );
    assert_eq!(
        records_from_json(&alone, "a.json").unwrap()[0].temperature_c,
        Some(22.5)
    );
    assert_eq!(
        records_from_json(&format!("[{alone},{alone}]"), "a")
            .unwrap()
            .len(),
        4
    );
    assert_eq!(
        records_from_json(&format!("{alone}\n{alone}"), "a")
            .unwrap()
            .len(),
        4
    );
    for (text, words) in [
        (
            estimate.replace("1772353800000000000", "12"),
            "says no date",
        ),
        (alone.replace("1772353800.0", "0.0"), "says no date"),
        (
            r#"{"recording": {"path": "a"}, "joints": []}"#.into(),
            "--baseline",
        ),
        ("{}".into(), "not a session's estimate"),
        ("[1, 2".into(), "not JSON"),
        (" ".into(), "is empty"),
        (alone.replace("0.4", "-1"), "above 0 mrad"),
    ] {
        let error = records_from_json(&text, "a.json").unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains("a.json"),
            "{text}: {error}"
        );
    }
}

#[test]
fn records_are_put_in_order_and_freed_of_repeats() {
    let mut late = session(3.0, 2.0);
    late.source = "again".into();
    let mut overlapping = session(2.0, 7.0);
    overlapping.time_utc_s += 30.0;
    let sorted = sort(
        vec![
            session(3.0, 2.0),
            session(2.0, 1.5),
            late,
            session(1.0, 1.0),
            overlapping,
        ],
        None,
    )
    .unwrap();
    let days: Vec<f64> = (sorted.joints[0].1.iter())
        .map(|r| (r.time_utc_s - utc("2026-03-01")) / DAY_S)
        .collect();
    assert_eq!(days, [1.0, 2.0, 3.0]);
    assert!(
        sorted.notes.iter().any(|n| n.contains("counted once")),
        "{:?}",
        sorted.notes
    );
    assert!(
        sorted.notes.iter().any(|n| n.contains("overlaps")),
        "{:?}",
        sorted.notes
    );

    let conflict = sort(vec![session(1.0, 1.0), session(1.0, 2.0)], None).unwrap_err();
    assert!(conflict.to_string().contains("2026-03-02"), "{conflict}");
    let mut other = session(2.0, 1.0);
    other.robot = Some("other".into());
    let error = sort(vec![session(1.0, 1.0), other], None).unwrap_err();
    assert!(matches!(error, RecordError::Robot { .. }), "{error}");
    let joints = ["wrist".to_string()];
    let error = sort(vec![session(1.0, 1.0)], Some(("biorob-like", &joints))).unwrap_err();
    assert!(error.to_string().contains("'elbow'") && error.to_string().contains("wrist"));
    assert_eq!(sort(Vec::new(), None), Err(RecordError::Empty));
}

#[test]
fn a_tendon_that_creeps_over_its_limit_says_when() {
    // 2.2 mrad per e-fold of hours: 20 mrad (0.5 mm on 25 mm) after exp(20/2.2) h = 369 days.
    let records = |days: i32| -> Vec<SessionRecord> {
        (1..=days)
            .map(|d| {
                let t = f64::from(d);
                session(t, 2.2 * (24.0 * t).ln() + wobble(t))
            })
            .collect()
    };
    let said = report(records(150), vec![tensioned(0.0)]);
    let joint = &said.joints[0];
    let limit = &joint.limits[0];
    assert_eq!(
        (limit.kind.as_str(), limit.limit_mrad),
        ("re-tension", 20.0)
    );
    let truth = (20.0_f64 / 2.2).exp() / 24.0 - 150.0;
    let low = limit.interval_95_days[0].unwrap();
    let high = limit.interval_95_days[1].unwrap_or(f64::INFINITY);
    assert!(low < truth && truth < high, "{truth}: {limit:?}");
    assert!(
        joint.events.is_empty() && !said.attention,
        "{:?}",
        joint.events
    );
    assert!(joint.basis.contains("liros-dc000-0301"), "{}", joint.basis);
    let page = html(&said);
    assert!(page.contains("<svg") && page.contains("elbow") && !page.contains("NaN"));

    // Passed: 150 mrad more.
    let mut over = records(40);
    over.iter_mut()
        .for_each(|r| r.offset_mrad = r.offset_mrad.map(|[y, i]| [y + 15.0, i]));
    let said = report(over, vec![tensioned(0.0)]);
    assert_eq!(said.joints[0].limits[0].state, "passed");
    assert!(said.attention && said.joints[0].verdict.contains("tension it again"));
}

#[test]
fn one_session_or_none_that_can_tell_says_unknown() {
    let nothing = |day: f64| SessionRecord {
        offset_mrad: None,
        ..session(day, 0.0)
    };
    let said = report(vec![nothing(1.0), nothing(2.0)], vec![tensioned(0.0)]);
    let joint = &said.joints[0];
    assert_eq!(joint.limits[0].state, "unknown", "{:?}", joint.limits);
    assert_eq!((joint.sessions, joint.without_information), (2, 2));
    assert!(!said.attention);
    let said = report(vec![session(1.0, 2.0)], Vec::new());
    let joint = &said.joints[0];
    assert!(!joint.tensioned_stated);
    assert!(
        said.notes.iter().any(|n| n.contains("--tensioned")),
        "{:?}",
        said.notes
    );
    assert!(
        (joint.offset_mrad[0] - 2.0).abs() < 1.0,
        "{:?}",
        joint.offset_mrad
    );
}

#[test]
fn a_tensioning_takes_the_offset_away_and_leaves_the_strain() {
    let day = |d: i32| f64::from(d);
    let whole = |t: f64| 2.2 * (24.0 * t).ln();
    let records: Vec<SessionRecord> = (1..=90)
        .map(|d| {
            let taken = if d > 45 { whole(45.0) } else { 0.0 };
            session(day(d), whole(day(d)) - taken + wobble(day(d)))
        })
        .collect();
    for stated in [vec![tensioned(0.0), tensioned(45.5)], vec![tensioned(0.0)]] {
        let how_many = stated.len();
        let said = report(records.clone(), stated);
        let joint = &said.joints[0];
        let [event] = joint.events.as_slice() else {
            panic!("{how_many} stated: {:?}", joint.events);
        };
        assert_eq!(
            (event.kind.as_str(), event.stated),
            ("tensioned", how_many == 2)
        );
        let left = whole(90.0) - whole(45.0);
        assert!(
            (joint.offset_mrad[0] - left).abs() < 0.7,
            "{:?} {left}",
            joint.offset_mrad
        );
        let strain = 0.1 * 25.0 / 700.0 * whole(90.0);
        let found = joint.strain_percent.unwrap();
        assert!((found[0] - strain).abs() < 0.01, "{found:?} {strain}");
        assert!(!said.attention, "a tensioning is no alarm");
    }
    // Another baseline is a tensioning too; a replacement forgets what was before.
    let mut other = records.clone();
    other[45..]
        .iter_mut()
        .for_each(|r| r.baseline = Some("april".into()));
    let said = report(other, vec![tensioned(0.0)]);
    assert!(
        said.notes.iter().any(|n| n.contains("another baseline")),
        "{:?}",
        said.notes
    );
    let replaced = Stated {
        replaced: true,
        ..tensioned(45.5)
    };
    let said = report(records, vec![tensioned(0.0), replaced]);
    assert_eq!(said.joints[0].sessions, 45);
    assert_eq!(said.joints[0].tensioned_day, "2026-04-15");
}

#[test]
fn a_failed_strand_is_told_from_a_slip_by_its_stiffness() {
    for (stiffness, word) in [(-6.0, "strand"), (0.0, "slip")] {
        let records = (1..=60)
            .map(|d| {
                let t = f64::from(d);
                let failed = d >= 40;
                let mut r = session(
                    t,
                    (24.0 * t).ln() + if failed { 3.0 } else { 0.0 } + wobble(t),
                );
                r.stiffness_percent = Some([if failed { stiffness } else { 0.0 }, 2.0]);
                r
            })
            .collect();
        let said = report(records, vec![tensioned(0.0)]);
        let [event] = said.joints[0].events.as_slice() else {
            panic!("{:?}", said.joints[0].events);
        };
        let [size, half] = event.size_mrad.unwrap();
        assert!((size - 3.0).abs() < half.max(0.5), "{size} ± {half}");
        assert!(event.meaning.contains(word), "{}", event.meaning);
        assert!(said.attention);
    }
}

#[test]
fn curves_of_a_rope_are_those_of_its_law() {
    let robot = robot();
    let index = robot.arm.joint_index("elbow").unwrap();
    let tendon = robot.transmissions[index]
        .as_ref()
        .unwrap()
        .tendon
        .as_ref()
        .unwrap();
    let catalogue = Catalogue::shipped().unwrap();
    let rope = catalogue.find("liros-dc000-0301").unwrap();
    let curves = prior::rope_curves(rope, tendon, 60.0, None, 23.0, 1).unwrap();
    assert!(curves.len() > prior::CURVES, "the rope's and generic ones");
    let total: f64 = curves.iter().map(|c| c.log_weight.exp()).sum();
    assert!((total - 1.0).abs() < 1e-9, "{total}");
    // Work without peaks is a constant load: the law itself, in its portions.
    let law = sinew_lab::rope::Draws::new(rope, 0, 1).unwrap().nominal;
    let work = prior::Work {
        mean_factor: 1.0,
        peak_factor: 1.0,
        peak_share: 0.0,
        temperature_c: 23.0,
    };
    let values = prior::work_curve(&law, tendon, 60.0, &work).unwrap();
    let duty = sinew_lab::rope::Duty::constant(60.0, 23.0);
    let same = prior::duty_curve(&law, tendon, 60.0, &duty).unwrap();
    for (a, b) in values.iter().zip(&same) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(values.windows(2).all(|w| w[1] >= w[0]));
}

#[test]
fn a_trend_survives_being_stored() {
    use sinew_lab::trend::stored::{StoredTrend, StoredTrendError};
    use sinew_model::trend::{Prior, Record, Trend, TrendConfig};
    let prior = Prior::new(prior::generic(None));
    let config = TrendConfig::default();
    let mut whole = Trend::new(prior.clone(), config).unwrap();
    let mut stored = whole.clone();
    for d in 1..=25 {
        let t = f64::from(d);
        if d == 20 {
            whole.tensioned((t - 0.5) * DAY_S).unwrap();
            stored.tensioned((t - 0.5) * DAY_S).unwrap();
        }
        let fallen = if d >= 20 { -5.0 } else { 0.0 } + if d >= 12 { 3.0 } else { 0.0 };
        let record = Record {
            time_s: t * DAY_S,
            offset_rad: (d != 7).then_some([1e-3 * ((24.0 * t).ln() + fallen + wobble(t)), 0.3e-3]),
            temperature_c: (d != 9).then_some(21.3),
        };
        whole.add(record).unwrap();
        let text = serde_json::to_string(&StoredTrend::from(&stored)).unwrap();
        assert!(text.len() < 1 << 20, "{} bytes", text.len());
        let read: StoredTrend = serde_json::from_str(&text).unwrap();
        stored = read.resume(prior.clone(), config).unwrap();
        stored.add(record).unwrap();
    }
    // JSON numbers are read to the last digit but one.
    let (a, b) = (whole.now(), stored.now());
    assert!(
        (a.offset_rad[0] - b.offset_rad[0]).abs() < 1e-12,
        "{a:?} {b:?}"
    );
    assert!(
        (a.offset_rad[1] / b.offset_rad[1] - 1.0).abs() < 1e-9,
        "{a:?} {b:?}"
    );
    assert_eq!(whole.events().len(), stored.events().len());
    assert_eq!(whole.events().len(), 2, "{:?}", whole.events());
    let mut later = StoredTrend::from(&whole);
    later.version = 2;
    let refused = later.resume(prior, config);
    assert_eq!(refused.unwrap_err(), StoredTrendError::Version(2));
}

#[test]
fn damaged_files_are_refused_and_never_break_anything() {
    let csv = "time,joint,offset_mrad,interval_95_mrad,temperature_c,stiffness_change_percent\n\
               2026-03-01T08:30Z,elbow,1.5,0.4,21,-2\n2026-03-02,elbow,,,,\n";
    let json = r#"{"start_time_utc_s": 1772353800.0, "joints": [{"name": "elbow", "offset_mrad": 1.5,
        "interval_95_mrad": 0.4, "verdict": "longer", "stiffness_change_percent": [-2.0, 1.0]}]}"#;
    // Bytes replaced, cut out and doubled at places of a simple generator.
    let mut state = 7_u64;
    let mut next = |most: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % most.max(1)
    };
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..4000 {
        for (text, is_csv) in [(csv, true), (json, false)] {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..=next(4) {
                if bytes.is_empty() {
                    break;
                }
                let at = next(bytes.len());
                match next(3) {
                    0 => {
                        let with = b"0123456789-+.eE,:\"[]{}\n \xffnaif";
                        bytes[at] = with[next(with.len())];
                    }
                    1 => drop(bytes.drain(at..(at + next(20)).min(bytes.len()))),
                    _ => {
                        let piece = bytes[at..(at + next(20)).min(bytes.len())].to_vec();
                        bytes.splice(at..at, piece);
                    }
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            let read = if is_csv {
                records_from_csv(&text, "f")
            } else {
                records_from_json(&text, "f")
            };
            match read.and_then(|records| sort(records, None)) {
                Ok(sorted) => {
                    taken += 1;
                    for (_, records) in sorted.joints {
                        for r in records {
                            assert!(r.time_utc_s.is_finite());
                            assert!(r.offset_mrad.is_none_or(|[y, i]| y.is_finite() && i > 0.0));
                        }
                    }
                }
                Err(error) => {
                    refused += 1;
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
    assert!(taken > 100 && refused > 100, "{taken} {refused}");
}
