//! Trends of session records.

use crate::support;

use sinew_files::date::day_of;
use sinew_model::offset::SharedError;
use sinew_model::robot::Robot;
use sinew_model::transmission::Tendon;
use sinew_model::{Gaussian, Z95};
use sinew_report::trend::{format_note, html, render_table};
use sinew_rope::Catalogue;
use sinew_trend::filter::Prior;
use sinew_trend::survival::{EventColumns, LifePrior, read_lives};
use sinew_trend::{
    ForecastPoint, JointTrend, Limit, LimitState, PriorBasis, SessionRecord, Stated, StepCause,
    TrendEventKind, TrendReport, TrendRequest, TrendVerdict, analyze, prior, read_sessions, sort,
};
use std::sync::Arc;
use support::{DAY_S, biorob_like, session_record, utc};

fn report(records: Vec<SessionRecord>, stated: Vec<Stated>) -> TrendReport {
    report_of(Some(&biorob_like()), records, stated)
}

fn report_of(
    robot: Option<&Robot>,
    records: Vec<SessionRecord>,
    stated: Vec<Stated>,
) -> TrendReport {
    let catalogue = Catalogue::shipped().unwrap();
    let request = TrendRequest {
        robot,
        catalogue: &catalogue,
        stated,
        duty: None,
        life: None,
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

/// Errors of about 0.25 mrad without a random generator: irrational steps.
fn wobble(i: f64) -> f64 {
    0.35 * (i * 12.9898).sin()
}

#[test]
fn creep_over_limit_reports_exceedance_date() {
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
        joint.events.is_empty() && !said.action_required,
        "{:?}",
        joint.events
    );
    let PriorBasis::Rope { rope, .. } = &joint.basis else {
        panic!("{:?}", joint.basis);
    };
    assert_eq!(rope, "liros-dc000-0301");
    let page = html(&said);
    assert!(page.contains("<svg") && page.contains("elbow") && !page.contains("NaN"));

    // Exceeded by 150 mrad.
    let mut over = records(40);
    over.iter_mut()
        .filter_map(|r| r.offset_rad.as_mut())
        .for_each(|y| y.mean += 15e-3);
    let said = report(over, vec![tensioned(0.0)]);
    assert_eq!(said.joints[0].limits[0].state, LimitState::Passed);
    assert!(said.action_required && said.joints[0].verdict == TrendVerdict::Retension);
    assert!(html(&said).contains("re-tension"));
    // Results are data: deserialisation restores them.
    let text = serde_json::to_string(&said).unwrap();
    assert_eq!(serde_json::from_str::<TrendReport>(&text).unwrap(), said);
}

#[test]
fn single_or_inconclusive_session_reports_unknown() {
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
    assert!(!said.action_required);
    let said = report(vec![session_record(1.0, 2.0)], Vec::new());
    let joint = &said.joints[0];
    assert!(!joint.tensioned_specified);
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
fn tensioning_removes_offset_and_keeps_strain() {
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
        assert!(!said.action_required, "a tensioning is no alarm");
    }
    // Another baseline is a re-tensioning, too; a replacement discards earlier records.
    let mut other = records.clone();
    other[45..]
        .iter_mut()
        .for_each(|r| r.baseline = Some("april".into()));
    let said = report(other, vec![tensioned(0.0)]);
    assert!(
        said.notes
            .iter()
            .any(|n| format_note(n).contains("baseline changed")),
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
fn strand_failure_is_distinguished_by_stiffness() {
    for (stiffness, cause) in [(-0.06, StepCause::StrandFailure), (0.0, StepCause::Slip)] {
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
        assert_eq!(event.kind, TrendEventKind::StepChange { cause });
        assert!(said.action_required);
    }
}

#[test]
fn rope_curves_match_rope_law() {
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
    // A load without peaks is constant: the law itself, section by section.
    let law = sinew_rope::Draws::new(rope, 0, 1).unwrap().nominal;
    let work = sinew_rope::work::Work {
        mean_factor: 1.0,
        peak_factor: 1.0,
        peak_share: 0.0,
        temperature_c: 23.0,
    };
    let values = prior::work_curve(&law, tendon, 60.0, &work).unwrap();
    let duty = sinew_rope::Duty::constant(60.0, 23.0);
    let same = prior::duty_curve(&law, tendon, 60.0, &duty).unwrap();
    assert_eq!(values.len(), same.len());
    for (a, b) in values.iter().zip(&same) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(values.windows(2).all(|w| w[1] >= w[0]));
    // A curve is that of a prediction's draw, with its model error beyond the data.
    let draws = sinew_rope::Draws::new(rope, prior::CURVES, 1).unwrap();
    let curves = prior::rope_curves(rope, tendon, 60.0, Some(&duty), 23.0, 1).unwrap();
    let each = draws.each(draws.extrapolation([60.0; 2], [23.0; 2]));
    let mut of_draws = 0;
    for draw in each.filter(|d| d.error.error_z > 0.0) {
        let law = prior::duty_curve(draw.law, tendon, 60.0, &duty).unwrap();
        let last_s = 1e10;
        let decades = (last_s / rope.tested_range().duration_s).log10();
        let factor = (0.3 * draw.error.error_z * decades.sqrt()).exp();
        let expected = factor * law.last().unwrap();
        let last = curves.iter().filter_map(|c| c.values.last());
        let mut ratios = last.map(|value| value / expected - 1.0);
        of_draws += usize::from(ratios.any(|ratio| ratio.abs() < 1e-9));
    }
    assert!(of_draws > prior::CURVES / 3, "{of_draws}");
}

// A rope without a name may be any of the catalogue; one without a pretension is itself, under any.
#[test]
fn missing_robot_entries_select_candidate_ropes() {
    use sinew_trend::{MissingFromRobot, prior::rope_prior};
    let catalogue = Catalogue::shipped().unwrap();
    let transmission = biorob_like().transmissions[2].clone().unwrap();
    let mut tendon = transmission.tendon.unwrap();
    let of = |tendon: Option<&sinew_model::transmission::Tendon>| {
        let found = rope_prior(tendon, &catalogue, None, 23.0, 1).unwrap();
        let PriorBasis::Unknown { missing, ropes } = found.basis else {
            panic!("{:?}", found.basis);
        };
        assert!(found.prior.is_possible());
        (missing, ropes)
    };
    tendon.pretension_n = None;
    assert_eq!(of(Some(&tendon)), (MissingFromRobot::Pretension, 1));
    // A misspelled rope name is an error.
    tendon.rope = Some("liros-dc000-0310".into());
    let said = rope_prior(Some(&tendon), &catalogue, None, 23.0, 1).unwrap_err();
    assert!(said.to_string().contains("liros-dc000-0310"), "{said}");
    tendon.rope = None;
    let (missing, any) = of(Some(&tendon));
    assert_eq!(missing, MissingFromRobot::Rope);
    assert!(any >= 10, "{any}");
    assert_eq!(of(None), (MissingFromRobot::Tendon, any));
}

#[test]
fn stored_trend_round_trip() {
    use sinew_trend::filter::{Prior, Record, Trend, TrendConfig, TrendNow};
    use sinew_trend::stored::{StoredTrend, StoredTrendError};
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
        if d == 23 {
            whole.rebased((t - 0.5) * DAY_S, 0.03).unwrap();
            stored.rebased((t - 0.5) * DAY_S, 0.03).unwrap();
        }
        let fallen = if d >= 20 { -5.0 } else { 0.0 } + if d >= 12 { 3.0 } else { 0.0 };
        let record = Record {
            shared: (d % 3 != 1).then_some(SharedError {
                baseline_rad: if d % 4 == 0 { 0.05e-3 } else { 0.25e-3 },
                drift_rad: 0.02e-3,
            }),
            reference_c: (d % 5 != 2).then_some(20.1),
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
        // 47 numbers per filter; just after a step change all noises are possible again.
        let filters = stored.components().len();
        assert!(
            text.len() < 47 * 21 * filters + 10_000,
            "{} bytes",
            text.len()
        );
        assert!(filters < 2500, "{filters}");
        let read: StoredTrend = serde_json::from_str(&text).unwrap();
        stored = read.resume(prior.clone(), config).unwrap();
        stored.add(record).unwrap();
    }
    // JSON numbers are exact except for the last digit.
    let (a, b) = (TrendNow::of(&whole), TrendNow::of(&stored));
    assert!(
        (a.offset_rad.mean - b.offset_rad.mean).abs() < 1e-12,
        "{a:?} {b:?}"
    );
    assert!(
        (a.offset_rad.std / b.offset_rad.std - 1.0).abs() < 1e-9,
        "{a:?} {b:?}"
    );
    assert_eq!(whole.state().baseline, stored.state().baseline);
    assert!(
        whole.state().baseline.levels[1].is_some(),
        "{:?}",
        whole.state().baseline
    );
    assert_eq!(whole.events().len(), stored.events().len());
    assert_eq!(whole.events().len(), 3, "{:?}", whole.events());
    let mut later = StoredTrend::from(&whole);
    later.version += 1;
    let version = later.version;
    let refused = later.resume(prior.clone(), config);
    assert_eq!(refused.unwrap_err(), StoredTrendError::Version(version));
    // A state of version 2 had one state variable less, and no stiffness since a step change.
    let mut earlier = serde_json::to_value(StoredTrend::from(&whole)).unwrap();
    earlier["version"] = 2.into();
    for key in ["stiffness_loss", "baseline"] {
        earlier.as_object_mut().unwrap().remove(key);
    }
    for event in earlier["events"].as_array_mut().unwrap() {
        event.as_object_mut().unwrap().remove("sessions");
    }
    for filter in earlier["filters"].as_array_mut().unwrap() {
        filter[3].as_array_mut().unwrap().truncate(5);
        filter[4].as_array_mut().unwrap().truncate(15);
    }
    // A state of version 3 had no common error.
    let mut third = earlier.clone();
    third["version"] = 3.into();
    let mut short = earlier.clone();
    short["version"] = (version - 1).into();
    let refused = |value: serde_json::Value| {
        let read: StoredTrend = serde_json::from_value(value).unwrap();
        read.resume(prior.clone(), config).unwrap_err()
    };
    assert_eq!(refused(earlier), StoredTrendError::Version(2));
    assert_eq!(refused(third), StoredTrendError::Version(3));
    assert_eq!(
        refused(short),
        StoredTrendError::Trend(sinew_trend::filter::TrendError::State)
    );
}

/// Uniform and normal random numbers, identical on every machine (splitmix64, Box and Muller).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[test]
fn constant_errors_are_covered() {
    // Checks report ± 1.1 mrad with a constant error of 0.30 or 0.44 mrad: twice 28 tendons, all
    // sessions of each identical.
    let mut random = Random(4);
    for (constant_mrad, stated) in [(0.3, true), (0.44, true), (0.3, false), (0.44, false)] {
        let mut inside = 0;
        for _ in 0..28 {
            let wrong = constant_mrad * random.normal();
            let pace = 0.6 + 0.8 * random.uniform();
            let creep = |t: f64| pace * (24.0 * t).ln();
            let mut records = Vec::new();
            for day in (1..=60).step_by(3) {
                let t = f64::from(day);
                let mut record = session_record(t, creep(t) + wrong + 0.07 * random.normal());
                let offset = record.offset_rad.as_mut().unwrap();
                offset.std = 0.55e-3;
                record.baseline_time_utc_s = Some(utc("2026-03-01") + 3600.0);
                record.systematic_error = stated.then_some(SharedError {
                    baseline_rad: 0.5e-3,
                    drift_rad: 0.0,
                });
                records.push(record);
            }
            let said = report_of(None, records, vec![tensioned(0.0)]);
            let found = said.joints[0].offset_rad;
            let error = found.mean - 1e-3 * creep(58.0);
            inside += usize::from(error.abs() < found.half_width_95());
            let half = 1e3 * found.half_width_95();
            assert!((0.8..1.3).contains(&half), "{half}");
            let shared = 1e3 * said.joints[0].baseline_error_rad.half_width_95();
            assert!(shared > 0.75, "{shared}");
        }
        println!("{constant_mrad} mrad, parts stated: {stated}: {inside} of 28 inside");
        assert!(inside >= 26, "{constant_mrad} {stated}: {inside}");
    }
}

#[test]
fn rope_break_alarms_in_same_cycle() {
    // One bin per cycle, half a minute each, dates rounded to the second.
    let at = |cycle: i32, offset_mrad: f64| SessionRecord {
        time_utc_s: (utc("2026-03-01") + 33.4 * f64::from(cycle)).round(),
        duration_s: Some(34.0),
        cycle: Some(f64::from(cycle)),
        ..session_record(0.0, offset_mrad)
    };
    let creep = |cycle: i32| 0.4 * f64::from(cycle + 1).ln() + wobble(f64::from(cycle));
    let mut records: Vec<SessionRecord> = (0..66).map(|c| at(c, creep(c))).collect();
    let sorted = sort(records.clone(), None).unwrap();
    assert_eq!(sorted.joints[0].1.len(), 66, "{:?}", sorted.notes);
    assert!(sorted.notes.is_empty(), "{:?}", sorted.notes);
    let calm = report_of(None, records.clone(), Vec::new());
    assert!(!calm.action_required, "{:?}", calm.joints[0].events);
    let cycles = calm.joints[0].cycles.unwrap();
    assert_eq!(cycles.last, 65.0);
    assert!(
        (cycles.per_s.unwrap() * 33.4 - 1.0).abs() < 0.01,
        "{cycles:?}"
    );

    records.push(at(66, creep(66) - 397.0));
    let said = report_of(None, records, Vec::new());
    let joint = &said.joints[0];
    let [event] = joint.events.as_slice() else {
        panic!("{:?}", joint.events);
    };
    assert!(event.is_jump() && event.sessions == 1, "{event:?}");
    assert!(said.action_required && joint.verdict == TrendVerdict::Inspect);
    assert!(
        (1e3 * joint.offset_rad.mean + 395.0).abs() < 3.0,
        "{:?}",
        joint.offset_rad
    );
    let text = render_table(&said);
    for words in ["inspect now", "exceeds every modelled error", "−397"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn log_of_cycles_is_reported_in_cycles() {
    let mut text = String::from("cycle,joint,offset_mrad,interval_95_mrad\n");
    for cycle in 1..=60 {
        let offset = 1.5 * f64::from(cycle).ln() + wobble(f64::from(cycle));
        text.push_str(&format!("{},elbow,{offset},0.7\n", 100 * cycle));
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    std::fs::write(&path, &text).unwrap();
    let read = |cycle_s| read_sessions(std::slice::from_ref(&path), None, cycle_s);
    let error = read(None).unwrap_err().to_string();
    assert!(
        error.contains("--cycle") && error.contains("log.csv, line 2"),
        "{error}"
    );
    let records = read(Some(12.0)).unwrap().joints[0].1.clone();
    assert_eq!(records[0].time_utc_s, 1200.0);
    let said = report_of(Some(&biorob_like()), records, Vec::new());
    let joint = &said.joints[0];
    assert!(!joint.is_dated());
    assert_eq!(joint.limits[0].at_utc_s, None);
    let shown = render_table(&said);
    for words in ["cycle 100 to cycle 6000", "re-tension in", "cycles"] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    assert!(!shown.contains("1970") && !html(&said).contains("1970"));
    assert!(html(&said).contains("cycles since the first session"));
}

#[test]
fn limits_use_their_paths_and_median_probability() {
    // 2.2 mrad per e-fold of hours, re-tensioned after 45 days: 2.4 mrad since then, 17 mrad since
    // the rope was new.
    let whole = |t: f64| 2.2 * (24.0 * t).ln();
    let records: Vec<SessionRecord> = (1..=90)
        .map(|d| {
            let t = f64::from(d);
            let taken = if d > 45 { whole(45.0) } else { 0.0 };
            session_record(t, whole(t) - taken + wobble(t))
        })
        .collect();
    let with_limits = |retension_mrad: f64, replace_mrad: f64| {
        let mut robot = biorob_like();
        let elbow = robot.arm.joint_index("elbow").unwrap();
        let transmission = robot.transmissions[elbow].as_mut().unwrap();
        let tendon = transmission.tendon.as_mut().unwrap();
        let (r, l) = (tendon.joint_pulley_radius_m, tendon.length_m);
        tendon.retension_at_m = Some(1e-3 * retension_mrad * r);
        tendon.replace_at_strain = Some(1e-3 * replace_mrad * r / l);
        let said = report_of(
            Some(&robot),
            records.clone(),
            vec![tensioned(0.0), tensioned(45.5)],
        );
        said.joints[0].clone()
    };
    let states = |joint: &JointTrend| [joint.limits[0].state, joint.limits[1].state];
    let joint = with_limits(8.0, 12.0);
    assert!(matches!(joint.limits[1].limit, Limit::Replace { .. }));
    assert_eq!(states(&joint)[1], LimitState::Passed);
    assert_ne!(states(&joint)[0], LimitState::Passed);
    assert_eq!(joint.verdict, TrendVerdict::Replace);
    let joint = with_limits(0.5, 40.0);
    assert_eq!(states(&joint)[0], LimitState::Passed);
    assert_ne!(states(&joint)[1], LimitState::Passed);

    // Half a standard deviation above and below the offset: probabilities of 69 and 31 %.
    let offset = with_limits(8.0, 40.0).offset_rad.scaled(1e3);
    for (stds, state) in [(-0.5, LimitState::Passed), (0.5, LimitState::Forecast)] {
        let joint = with_limits(offset.mean + stds * offset.std, 40.0);
        let limit = &joint.limits[0];
        assert_eq!(limit.state, state, "{limit:?}");
        let off = (limit.passed_probability - 0.5 + 0.19 * stds.signum()).abs();
        assert!(off < 0.06, "{limit:?}");
    }

    // Forecast dates are the points where the forecast's band reaches the limit: creep only grows.
    let joint = with_limits(offset.mean + 1.5, 40.0);
    let limit = &joint.limits[0];
    let band = |after_s: f64, of: &dyn Fn(&ForecastPoint) -> f64| {
        let t = joint.last_utc_s + after_s;
        let k = joint.forecast.partition_point(|f| f.time_utc_s < t).max(1);
        let (a, b) = (&joint.forecast[k - 1], &joint.forecast[k]);
        let share = (t - a.time_utc_s) / (b.time_utc_s - a.time_utc_s);
        of(a) + share * (of(b) - of(a))
    };
    let met = |after_s: Option<f64>, of: &dyn Fn(&ForecastPoint) -> f64| {
        let at = 1e3 * (band(after_s.unwrap(), of) - limit.limit_rad);
        assert!(at.abs() < 0.06, "{at} mrad off: {limit:?}");
    };
    met(limit.after_low_s, &|f| f.interval_95_rad.high);
    met(limit.after_s, &|f| f.offset_rad);
    assert_eq!(limit.at_utc_s, limit.after_s.map(|t| joint.last_utc_s + t));
    assert_eq!(
        limit.at_low_utc_s,
        limit.after_low_s.map(|t| joint.last_utc_s + t)
    );
    assert_eq!(
        limit.at_high_utc_s,
        limit.after_high_s.map(|t| joint.last_utc_s + t)
    );
    let now = joint.forecast[0].interval_95_rad;
    let half = joint.offset_rad.half_width_95();
    assert!(
        (0.5 * (now.high - now.low) / half - 1.0).abs() < 0.08,
        "{now:?} {half}"
    );
}

#[test]
fn new_baseline_uses_its_time_and_temperature() {
    // Creep of 2.2 mrad per e-fold; 0.1 mrad/K of drift; a new baseline on day 30.5 at 27 °C.
    let creep = |t: f64| 2.2 * t.ln();
    let records: Vec<SessionRecord> = (1..=60)
        .map(|d| {
            let t = f64::from(d);
            let celsius = 21.0 + 6.0 * t.sin();
            let (since, reference_c, name) = match d > 30 {
                true => (30.5_f64, 27.0, "april"),
                false => (1.0 / 24.0, 15.0, "march"),
            };
            let drift = 0.1 * (celsius - reference_c);
            let offset = creep(t) - creep(since) + drift + 0.3 * wobble(t);
            SessionRecord {
                baseline: Some(name.into()),
                baseline_time_utc_s: Some(utc("2026-03-01") + since * DAY_S),
                reference_c: Some(reference_c),
                temperature_c: Some(celsius),
                systematic_error: Some(SharedError {
                    baseline_rad: 0.1e-3,
                    drift_rad: 0.1e-3,
                }),
                ..session_record(t, offset)
            }
        })
        .collect();
    let said = report(records, Vec::new());
    let joint = &said.joints[0];
    let truth = creep(60.0) - creep(30.5);
    let found = joint.offset_rad.scaled(1e3);
    assert!((found.mean - truth).abs() < 0.3, "{found:?} {truth}");
    // The clock starts an hour before the first baseline: no user input required.
    assert!(!joint.tensioned_specified);
    assert!((joint.tensioned_utc_s - utc("2026-03-01")).abs() < 1.0);
    let notes: Vec<String> = said.notes.iter().map(format_note).collect();
    assert!(
        !notes.iter().any(|n| n.contains("--tensioned")),
        "{notes:?}"
    );
    assert!(
        notes.iter().any(|n| n.contains("baseline changed")),
        "{notes:?}"
    );
    let drift = joint.drift_rad_per_k.unwrap().scaled(1e3);
    assert!((drift.mean - 0.1).abs() < 0.03, "{drift:?}");
}

#[test]
fn lifetimes_apply_without_strain_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lives.csv");
    let mut table = String::from("age_days,end\n");
    for i in 0..40 {
        // Weibull, shape 2, scale 300 days, at its quantiles; a third was replaced half way.
        let age = 300.0 * (-(1.0 - (f64::from(i) + 0.5) / 40.0).ln()).sqrt();
        let replaced = i % 3 == 0;
        let (age, end) = if replaced {
            (0.5 * age, "replaced")
        } else {
            (age, "broken")
        };
        table.push_str(&format!("{age},{end}\n"));
    }
    std::fs::write(&path, table).unwrap();
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    let catalogue = Catalogue::shipped().unwrap();
    let mut robot = biorob_like();
    let life = |robot: &Robot, days: i32| {
        let request = TrendRequest {
            robot: Some(robot),
            catalogue: &catalogue,
            stated: vec![tensioned(0.0)],
            duty: None,
            life: Some(LifePrior::new(&lives, "lives.csv", 0.1, 1).unwrap()),
            horizon_days: 1095.0,
            seed: 1,
        };
        let records = (1..=days)
            .step_by(20)
            .map(|d| session_record(f64::from(d), 2.0));
        let sorted = sort(records.collect(), None).unwrap();
        let said = analyze(sorted, &request).unwrap();
        (said.joints[0].clone(), said.action_required)
    };
    // robot.toml has a strain limit, which takes precedence.
    let elbow = robot.arm.joint_index("elbow").unwrap();
    let limit_strain = |robot: &mut Robot, strain_ratio: Option<f64>| {
        let transmission = robot.transmissions[elbow].as_mut().unwrap();
        transmission.tendon.as_mut().unwrap().replace_at_strain = strain_ratio;
    };
    limit_strain(&mut robot, Some(0.01));
    assert!(life(&robot, 41).0.life.is_none());
    limit_strain(&mut robot, None);
    let (joint, alarm) = life(&robot, 41);
    let found = joint.life.clone().unwrap();
    assert_eq!(found.age_s, 41.0 * DAY_S);
    assert!(!alarm && !found.is_passed());
    // 10 % of them break within some 100 days.
    let at = (found.age_s + found.after_s) / DAY_S;
    assert!((70.0..130.0).contains(&at), "{at}");
    assert!(found.after_low_s < found.after_s && found.after_s < found.after_high_s);
    assert!((found.broken_by_now_ratio - 0.02).abs() < 0.02, "{found:?}");
    let (joint, alarm) = life(&robot, 161);
    assert!(alarm && joint.life.as_ref().unwrap().is_passed());
    assert_eq!(joint.verdict, TrendVerdict::ReplaceByAge);
    // Two ropes that broke together do not determine a law.
    std::fs::write(&path, "age_days,end\n5,broken\n9,running\n").unwrap();
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    let error = LifePrior::new(&lives, "lives.csv", 0.1, 1).unwrap_err();
    assert!(error.to_string().contains("fewer than two"), "{error}");
    std::fs::write(&path, "age_cycles,end\n5,broken\n9,broken\n").unwrap();
    let lives = read_lives(&path, &EventColumns::default()).unwrap();
    let error = LifePrior::new(&lives, "lives.csv", 0.1, 1).unwrap_err();
    assert!(error.to_string().contains("cycles"), "{error}");
}

#[test]
fn resumed_trend_equals_trend_from_start() {
    use sinew_trend::{LoadedTrend, mean_temperature_c, prior::rope_prior, resume_joint};
    let robot = biorob_like();
    let catalogue = Catalogue::shipped().unwrap();
    let index = robot.arm.joint_index("elbow").unwrap();
    let tendon = robot.transmissions[index].as_ref().unwrap().tendon.as_ref();
    // A strand fails on day 20; a re-tensioning after day 30 is followed by a new baseline.
    let record = |d: i32| {
        let t = f64::from(d);
        let jumped = if d >= 20 { 5.0 } else { 0.0 };
        let mrad = if d > 30 {
            0.1
        } else {
            0.8 * (24.0 * t).ln() + jumped
        } + wobble(t);
        SessionRecord {
            baseline: Some(if d > 30 { "new" } else { "old" }.into()),
            ..session_record(t, mrad)
        }
    };
    let records: Vec<SessionRecord> = (1..=36).map(record).collect();
    let rope = rope_prior(tendon, &catalogue, None, mean_temperature_c(&records), 1).unwrap();
    let asked = |days: usize, records: &[SessionRecord], kept: Option<LoadedTrend>| {
        let stated = if days > 30 {
            vec![tensioned(30.5)]
        } else {
            Vec::new()
        };
        let request = TrendRequest {
            robot: Some(&robot),
            catalogue: &catalogue,
            stated,
            duty: None,
            life: None,
            horizon_days: 365.0,
            seed: 1,
        };
        resume_joint("elbow", &records[..days], &rope, &request, kept).unwrap()
    };
    let mut kept: Option<LoadedTrend> = None;
    for days in [15, 21, 22, 33, 33, 36] {
        let anew = asked(days, &records, None);
        let on = asked(days, &records, kept.take());
        assert_eq!((anew.is_resumed, on.is_resumed), (false, days > 15));
        assert_eq!((&on.trend, &on.kept), (&anew.trend, &anew.kept));
        kept = Some(on.kept);
    }
    let whole = asked(36, &records, kept.clone());
    assert_eq!(whole.trend.events.len(), 2, "{:?}", whole.trend.events);
    // An earlier session estimated again, and a rope with a changed prior.
    let mut corrected = records.clone();
    corrected[9] = session_record(10.0, 4.4);
    corrected[9].baseline = Some("old".into());
    assert!(!asked(36, &corrected, kept.clone()).is_resumed);
    let warmer = rope_prior(tendon, &catalogue, None, 30.0, 1).unwrap();
    let request = TrendRequest {
        robot: Some(&robot),
        catalogue: &catalogue,
        stated: vec![tensioned(30.5)],
        duty: None,
        life: None,
        horizon_days: 365.0,
        seed: 1,
    };
    let other = resume_joint("elbow", &records, &warmer, &request, kept).unwrap();
    assert!(!other.is_resumed);
    // The report is identical, and additionally contains the series and the forecast.
    let report = analyze(sort(records, None).unwrap(), &request).unwrap();
    let mut found = report.joints[0].clone();
    assert_eq!(found.series.len(), 36);
    (found.series, found.forecast) = (Vec::new(), Vec::new());
    assert_eq!(found, whole.trend);
}

#[test]
fn tendons_with_shared_priors_equal_separate_ones() {
    use sinew_trend::fleet::{FleetTendon, RopePriors, best_of_days, trend_of_tendon};
    let robot = biorob_like();
    let index = robot.arm.joint_index("elbow").unwrap();
    let tendon = robot.transmissions[index].as_ref().unwrap().tendon.as_ref();
    let events = [tensioned(0.0)];
    let of = FleetTendon {
        joint: "elbow",
        robot: Some(&robot),
        tendon,
        events: &events,
    };
    let sessions = |pace: f64| -> Vec<SessionRecord> {
        let session = |day: i32| {
            let t = f64::from(day);
            session_record(t, pace * (24.0 * t).ln() + wobble(t))
        };
        best_of_days((1..=20).map(session))
    };
    let new = || RopePriors::new(Catalogue::shipped().unwrap());
    let trend = |priors: &RopePriors, pace| {
        trend_of_tendon(of, &sessions(pace), priors, None, None).unwrap()
    };
    let shared = new();
    let both = std::thread::scope(|scope| {
        [0.5, 0.8]
            .map(|pace| {
                let (trend, shared) = (&trend, &shared);
                scope.spawn(move || trend(shared, pace))
            })
            .map(|thread| thread.join().unwrap())
    });
    assert_eq!(both, [0.5, 0.8].map(|pace| trend(&new(), pace)));
    // Temperatures that round to one degree share the draws, other tendons do not.
    let prior = |tendon, mean_c| shared.of(tendon, mean_c).unwrap();
    assert!(Arc::ptr_eq(&prior(tendon, 19.8), &prior(tendon, 20.2)));
    assert!(!Arc::ptr_eq(&prior(tendon, 19.8), &prior(tendon, 21.0)));
    let longer = tendon.cloned().map(|own| Tendon {
        length_m: 2.0 * own.length_m,
        ..own
    });
    assert!(!Arc::ptr_eq(
        &prior(tendon, 20.0),
        &prior(longer.as_ref(), 20.0)
    ));
    // An adjusted prior is that of one tendon only.
    let warmer = |prior: &mut Prior| prior.step_rad *= 10.0;
    let adjusted = trend_of_tendon(of, &sessions(0.5), &shared, Some(&warmer), None).unwrap();
    assert_ne!(adjusted, both[0]);
    assert_eq!(trend(&shared, 0.5), both[0]);
}
