//! What a trend says of the records of sessions.

use crate::support;

use sinew_estimate::trend::{
    JumpCause, Limit, LimitState, PriorBasis, SessionRecord, Stated, TrendEventKind, TrendReport,
    TrendRequest, TrendVerdict, analyze, prior, sort,
};
use sinew_files::date::day_of;
use sinew_model::{Gaussian, Z95};
use sinew_report::trend::{format_note, html};
use sinew_rope::Catalogue;
use support::{DAY_S, biorob_like, session_record, utc};

fn report(records: Vec<SessionRecord>, stated: Vec<Stated>) -> TrendReport {
    let robot = biorob_like();
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
fn a_tendon_that_creeps_over_its_limit_says_when() {
    // 2.2 mrad per e-fold of hours: 20 mrad (0.5 mm on 25 mm) after exp(20/2.2) h = 369 days.
    let records = |days: i32| -> Vec<SessionRecord> {
        (1..=days)
            .map(|d| {
                let t = f64::from(d);
                session_record(t, 2.2 * (24.0 * t).ln() + wobble(t))
            })
            .collect()
    };
    let said = report(records(150), vec![tensioned(0.0)]);
    let joint = &said.joints[0];
    let limit = &joint.limits[0];
    assert!(matches!(limit.limit, Limit::Retension { .. }));
    assert_eq!(1e3 * limit.limit_rad, 20.0);
    let truth = (20.0_f64 / 2.2).exp() / 24.0 - 150.0;
    let low = limit.after_low_s.unwrap() / DAY_S;
    let high = limit.after_high_s.map_or(f64::INFINITY, |t| t / DAY_S);
    assert!(low < truth && truth < high, "{truth}: {limit:?}");
    assert!(
        joint.events.is_empty() && !said.needs_attention,
        "{:?}",
        joint.events
    );
    let PriorBasis::Rope { rope, .. } = &joint.basis else {
        panic!("{:?}", joint.basis);
    };
    assert_eq!(rope, "liros-dc000-0301");
    let page = html(&said);
    assert!(page.contains("<svg") && page.contains("elbow") && !page.contains("NaN"));

    // Passed: 150 mrad more.
    let mut over = records(40);
    over.iter_mut()
        .filter_map(|r| r.offset_rad.as_mut())
        .for_each(|y| y.mean += 15e-3);
    let said = report(over, vec![tensioned(0.0)]);
    assert_eq!(said.joints[0].limits[0].state, LimitState::Passed);
    assert!(said.needs_attention && said.joints[0].verdict == TrendVerdict::Retension);
    assert!(html(&said).contains("tension it again"));
    // Results are data: they are read as they were written.
    let text = serde_json::to_string(&said).unwrap();
    assert_eq!(serde_json::from_str::<TrendReport>(&text).unwrap(), said);
}

#[test]
fn one_session_or_none_that_can_tell_says_unknown() {
    let nothing = |day: f64| SessionRecord {
        offset_rad: None,
        ..session_record(day, 0.0)
    };
    let said = report(vec![nothing(1.0), nothing(2.0)], vec![tensioned(0.0)]);
    let joint = &said.joints[0];
    assert_eq!(
        joint.limits[0].state,
        LimitState::TooFewSessions,
        "{:?}",
        joint.limits
    );
    assert_eq!((joint.sessions, joint.without_information), (2, 2));
    assert!(!said.needs_attention);
    let said = report(vec![session_record(1.0, 2.0)], Vec::new());
    let joint = &said.joints[0];
    assert!(!joint.tensioned_stated);
    assert!(
        said.notes
            .iter()
            .any(|n| format_note(n).contains("--tensioned")),
        "{:?}",
        said.notes
    );
    assert!(
        (1e3 * joint.offset_rad.mean - 2.0).abs() < 1.0,
        "{:?}",
        joint.offset_rad
    );
}

#[test]
fn a_tensioning_takes_the_offset_away_and_leaves_the_strain() {
    let day = |d: i32| f64::from(d);
    let whole = |t: f64| 2.2 * (24.0 * t).ln();
    let records: Vec<SessionRecord> = (1..=90)
        .map(|d| {
            let taken = if d > 45 { whole(45.0) } else { 0.0 };
            session_record(day(d), whole(day(d)) - taken + wobble(day(d)))
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
            event.kind,
            TrendEventKind::Tensioned {
                stated: how_many == 2
            }
        );
        let left = whole(90.0) - whole(45.0);
        assert!(
            (1e3 * joint.offset_rad.mean - left).abs() < 0.7,
            "{:?} {left}",
            joint.offset_rad
        );
        let strain = 0.1 * 25.0 / 700.0 * whole(90.0);
        let found = joint.strain_ratio.unwrap();
        assert!(
            (100.0 * found.mean - strain).abs() < 0.01,
            "{found:?} {strain}"
        );
        assert!(!said.needs_attention, "a tensioning is no alarm");
    }
    // Another baseline is a tensioning too; a replacement forgets what was before.
    let mut other = records.clone();
    other[45..]
        .iter_mut()
        .for_each(|r| r.baseline = Some("april".into()));
    let said = report(other, vec![tensioned(0.0)]);
    assert!(
        said.notes
            .iter()
            .any(|n| format_note(n).contains("another baseline")),
        "{:?}",
        said.notes
    );
    let replaced = Stated {
        replaced: true,
        ..tensioned(45.5)
    };
    let said = report(records, vec![tensioned(0.0), replaced]);
    assert_eq!(said.joints[0].sessions, 45);
    assert_eq!(day_of(said.joints[0].tensioned_utc_s), "2026-04-15");
}

#[test]
fn a_failed_strand_is_told_from_a_slip_by_its_stiffness() {
    for (stiffness, cause) in [(-0.06, JumpCause::StrandFailure), (0.0, JumpCause::Slip)] {
        let records = (1..=60)
            .map(|d| {
                let t = f64::from(d);
                let failed = d >= 40;
                let mut r = session_record(
                    t,
                    (24.0 * t).ln() + if failed { 3.0 } else { 0.0 } + wobble(t),
                );
                let stiffness = if failed { stiffness } else { 0.0 };
                r.stiffness_ratio = Some(Gaussian::new(stiffness, 0.02 / Z95));
                r
            })
            .collect();
        let said = report(records, vec![tensioned(0.0)]);
        let [event] = said.joints[0].events.as_slice() else {
            panic!("{:?}", said.joints[0].events);
        };
        let size = event.size_rad.unwrap().scaled(1e3);
        let (size, half) = (size.mean, size.half_width_95());
        assert!((size - 3.0).abs() < half.max(0.5), "{size} ± {half}");
        assert_eq!(event.kind, TrendEventKind::Jump { cause });
        assert!(said.needs_attention);
    }
}

#[test]
fn curves_of_a_rope_are_those_of_its_law() {
    let robot = biorob_like();
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
    let law = sinew_rope::Draws::new(rope, 0, 1).unwrap().nominal;
    let work = prior::Work {
        mean_factor: 1.0,
        peak_factor: 1.0,
        peak_share: 0.0,
        temperature_c: 23.0,
    };
    let values = prior::work_curve(&law, tendon, 60.0, &work).unwrap();
    let duty = sinew_rope::Duty::constant(60.0, 23.0);
    let same = prior::duty_curve(&law, tendon, 60.0, &duty).unwrap();
    for (a, b) in values.iter().zip(&same) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(values.windows(2).all(|w| w[1] >= w[0]));
}

#[test]
fn a_trend_survives_being_stored() {
    use sinew_estimate::trend::stored::{StoredTrend, StoredTrendError};
    use sinew_model::trend::{Prior, Record, Trend, TrendConfig, TrendNow};
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
            offset_rad: (d != 7).then_some(Gaussian::new(
                1e-3 * ((24.0 * t).ln() + fallen + wobble(t)),
                0.3e-3,
            )),
            temperature_c: (d != 9).then_some(21.3),
            stiffness: (d != 5).then_some(Gaussian::new(0.02 - 0.001 * t, 0.01)),
        };
        whole.add(record).unwrap();
        let text = serde_json::to_string(&StoredTrend::from(&stored)).unwrap();
        // 30 numbers a filter; just after a jump all noises are possible again.
        let filters = stored.components().len();
        assert!(
            text.len() < 30 * 21 * filters + 10_000,
            "{} bytes",
            text.len()
        );
        assert!(filters < 2500, "{filters}");
        let read: StoredTrend = serde_json::from_str(&text).unwrap();
        stored = read.resume(prior.clone(), config).unwrap();
        stored.add(record).unwrap();
    }
    // JSON numbers are read to the last digit but one.
    let (a, b) = (TrendNow::of(&whole), TrendNow::of(&stored));
    assert!(
        (a.offset_rad.mean - b.offset_rad.mean).abs() < 1e-12,
        "{a:?} {b:?}"
    );
    assert!(
        (a.offset_rad.deviation / b.offset_rad.deviation - 1.0).abs() < 1e-9,
        "{a:?} {b:?}"
    );
    assert_eq!(whole.events().len(), stored.events().len());
    assert_eq!(whole.events().len(), 2, "{:?}", whole.events());
    let mut later = StoredTrend::from(&whole);
    later.version += 1;
    let version = later.version;
    let refused = later.resume(prior.clone(), config);
    assert_eq!(refused.unwrap_err(), StoredTrendError::Version(version));
    // One of version 2 had a state less, and didn't know the stiffness since a jump.
    let mut earlier = serde_json::to_value(StoredTrend::from(&whole)).unwrap();
    earlier["version"] = 2.into();
    earlier.as_object_mut().unwrap().remove("softened");
    for filter in earlier["filters"].as_array_mut().unwrap() {
        filter[3].as_array_mut().unwrap().truncate(5);
        filter[4].as_array_mut().unwrap().truncate(15);
    }
    let mut short = earlier.clone();
    short["version"] = (version - 1).into();
    let refused = |value: serde_json::Value| {
        let read: StoredTrend = serde_json::from_value(value).unwrap();
        read.resume(prior.clone(), config).unwrap_err()
    };
    assert_eq!(refused(earlier), StoredTrendError::Version(2));
    assert_eq!(
        refused(short),
        StoredTrendError::Trend(sinew_model::trend::TrendError::State)
    );
}
