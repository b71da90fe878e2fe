//! Limits: of robot.toml or of the rope's maker, passed or near.

use crate::support::{MONDAY_NS, Watched, biorob_like, config, later, longer, seconds, tensioned};
use sinew_rope::Catalogue;
use sinew_watch_core::alarm::{AlarmCause, AlarmKey, AlarmState, Condition, LimitOrigin};
use sinew_watch_core::record::Clock;
use sinew_watch_core::snapshot::LimitNow;
use sinew_watch_core::{Belief, History, Instant, Record};
use std::sync::Arc;

const ELBOW: usize = 2;
const DAY_S: f64 = 86_400.0;

/// The shipped ropes, and the elbow's with a limit of its maker.
fn with_maker_s_limit(percent: f64) -> Catalogue {
    let shipped = Catalogue::shipped().unwrap();
    let rope = shipped.find("liros-dc000-0301").unwrap();
    let line = format!(
        "[published]\ndiscard_strain_percent = {{ value = {percent:?}, origin = \"published\", source = \"sheet\" }}"
    );
    let text = rope.entry.to_toml();
    let text = text.replace("[published]", &line);
    let text = text.replace("[sources]", "[sources]\nsheet = \"the maker's sheet\"");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.toml"), text).unwrap();
    Catalogue::with_folders(&[folder.path()]).unwrap()
}

#[test]
fn the_maker_s_limit_counts_where_robot_toml_has_none() {
    let mut config = tensioned();
    config.catalogue = Arc::new(with_maker_s_limit(0.1));
    let mut watched = Watched::new(config);
    let limits = watched.snapshot().tendons[ELBOW].limits.clone();
    let replace = LimitNow::Replace {
        strain_ratio: 1e-3,
        origin: LimitOrigin::Catalogue,
    };
    assert!(limits.contains(&replace), "{limits:?}");
    assert!(limits.iter().any(|l| matches!(
        l,
        LimitNow::Retension {
            origin: LimitOrigin::RobotToml,
            ..
        }
    )));
    // 25 mm times 40 mrad of 700 mm: 0.14 %.
    watched.session(&longer(seconds(60, 120), ELBOW, 40e-3));
    watched.pass(700.0);
    let state = |watched: &Watched, joint| watched.alarm(Some(joint), Condition::ReplaceLimit);
    assert_eq!(state(&watched, "elbow"), Some(AlarmState::Active));
    assert_eq!(state(&watched, "shoulder_pitch"), None);
    // It is over only with another rope.
    watched.session(&later(seconds(120, 180), 1000.0));
    watched.pass(700.0);
    assert_eq!(state(&watched, "elbow"), Some(AlarmState::Latched));
}

/// A record of the elbow, so many days before Monday.
pub(crate) fn record(days_before: f64, offset_rad: f64) -> Record {
    Record {
        robot: "arm-7".into(),
        robot_type: "biorob-like".into(),
        joint: "elbow".into(),
        time_utc_s: MONDAY_NS as f64 * 1e-9 - days_before * DAY_S,
        duration_s: 600.0,
        offset_rad: Some(offset_rad),
        offset_deviation_rad: Some(0.3e-3),
        elongation_m: None,
        elongation_deviation_m: None,
        strain_ratio: None,
        strain_deviation_ratio: None,
        temperature_c: Some(22.0),
        stiffness_ratio: None,
        stiffness_deviation_ratio: None,
        baseline: Some("first minute".into()),
        source: "test".into(),
        clock: Clock::Utc,
        in_doubt: false,
        reason: None,
        poses: 20,
        frames: 10_000,
        frames_lost: 0,
        sinew_version: "0".into(),
    }
}

#[test]
fn a_limit_that_will_be_passed_within_two_weeks_is_near() {
    // 20 mrad is the limit; 0.1 mrad a day, from 30 days ago.
    let mut store = crate::support::Store::default();
    let mut history = History::default();
    for day in 0..30 {
        history.push(&record(
            30.0 - f64::from(day),
            1e-3 * (16.0 + 0.1 * f64::from(day)),
        ));
    }
    store.stored.history = history;
    let now = Instant {
        monotonic_ns: 0,
        utc_ns: MONDAY_NS,
    };
    let mut watched = Watched::restored(tensioned(), store, now);
    watched.pass(700.0);
    let alarms = watched.snapshot().alarms;
    let key = AlarmKey {
        joint: Some("elbow".into()),
        condition: Condition::LimitNear,
    };
    let near = alarms.iter().find(|alarm| alarm.key == key);
    let Some(AlarmCause::Soon { after_low_s, .. }) = near.map(|alarm| &alarm.cause) else {
        panic!("{alarms:?}");
    };
    assert!(*after_low_s <= 14.0 * DAY_S, "{} days", after_low_s / DAY_S);
    let trend = watched.snapshot().tendons[ELBOW].trend.clone().unwrap();
    assert_eq!(trend.sessions, 30);
    assert!(trend.series.is_empty() && !trend.forecast.is_empty());
}

#[test]
fn of_a_day_the_best_record_counts_and_none_with_a_wrong_date() {
    let mut history = History::default();
    assert!(history.push(&record(2.0, 1e-3)));
    let worse = Record {
        offset_deviation_rad: Some(0.5e-3),
        ..record(1.9, 1.2e-3)
    };
    assert!(!history.push(&worse), "a wider one of the same day");
    let better = Record {
        offset_deviation_rad: Some(0.2e-3),
        ..record(1.8, 1.1e-3)
    };
    assert!(history.push(&better));
    let tensioned = Record {
        baseline: Some("tensioned".into()),
        ..record(1.75, 0.0)
    };
    assert!(history.push(&tensioned), "a tensioning parts a day in two");
    for clock in [Clock::Stamp, Clock::Stepped] {
        assert!(!history.push(&Record {
            clock,
            ..record(1.0, 1e-3)
        }));
    }
    assert!(!history.push(&Record {
        offset_rad: None,
        ..record(0.5, 0.0)
    }));
}

#[test]
fn a_belief_of_another_robot_is_left_alone_and_told() {
    let mut watched = Watched::new(tensioned());
    watched.session(seconds(60, 100));
    let mut store = watched.store.clone();
    let mut robot = (*biorob_like()).clone();
    if let Some(elbow) = &mut robot.transmissions[ELBOW] {
        elbow.stiffness_nm_per_rad = 25.0;
    }
    let other = config(&Arc::new(robot));
    let again = Watched::restored(other, store.clone(), watched.now);
    let text = serde_json::to_string(&again.store.journal).unwrap();
    assert!(
        text.contains("belief-left") && text.contains("stiffness_nm_per_rad"),
        "{text}"
    );
    if let Some(belief) = &mut store.stored.belief {
        *belief = Belief {
            version: 99,
            ..belief.clone()
        };
    }
    let again = Watched::restored(tensioned(), store, watched.now);
    let text = serde_json::to_string(&again.store.journal).unwrap();
    assert!(text.contains("belief-left"), "{text}");
}
