//! Limits of robot.toml or the manufacturer, exceeded or near.

use crate::support::{Harness, MONDAY_NS, biorob_like, config, later, longer, seconds, tensioned};
use sinew_rope::Catalogue;
use sinew_watch_core::alarm::{AlarmCause, AlarmKey, AlarmState, Condition, LimitOrigin};
use sinew_watch_core::record::Clock;
use sinew_watch_core::snapshot::LimitNow;
use sinew_watch_core::{History, Instant, MonitorState, Record};
use std::sync::Arc;

const ELBOW: usize = 2;
const DAY_S: f64 = 86_400.0;

/// Shipped ropes, with a manufacturer limit for the rope of the elbow.
fn with_manufacturer_limit(percent: f64) -> Catalogue {
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
fn manufacturer_limit_used_without_robot_toml_limit() {
    let mut config = tensioned();
    config.catalogue = Arc::new(with_manufacturer_limit(0.1));
    let mut harness = Harness::new(config);
    let limits = harness.snapshot().tendons[ELBOW].limits.clone();
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
    // 25 mm × 40 mrad / 700 mm = 0.14 %.
    harness.session(&longer(seconds(60, 120), ELBOW, 40e-3));
    harness.pass(700.0);
    let state = |harness: &Harness, joint| harness.alarm(Some(joint), Condition::ReplaceLimit);
    assert_eq!(state(&harness, "elbow"), Some(AlarmState::Active));
    assert_eq!(state(&harness, "shoulder_pitch"), None);
    // Only a replacement clears the alarm.
    harness.session(&later(seconds(120, 180), 1000.0));
    harness.pass(700.0);
    assert_eq!(state(&harness, "elbow"), Some(AlarmState::Latched));
}

/// Record of the elbow, `days_before` days before Monday.
pub(crate) fn record(days_before: f64, offset_rad: f64) -> Record {
    Record {
        robot: "arm-7".into(),
        robot_type: "biorob-like".into(),
        joint: "elbow".into(),
        time_utc_s: MONDAY_NS as f64 * 1e-9 - days_before * DAY_S,
        duration_s: 600.0,
        offset_rad: Some(offset_rad),
        offset_std_rad: Some(0.3e-3),
        elongation_m: None,
        elongation_std_m: None,
        strain_ratio: None,
        strain_std_ratio: None,
        temperature_c: Some(22.0),
        stiffness_ratio: None,
        stiffness_std_ratio: None,
        baseline: Some("first minute".into()),
        source: "test".into(),
        clock: Clock::Utc,
        provisional: false,
        reason: None,
        poses: 20,
        frames: 10_000,
        frames_lost: 0,
        sinew_version: "0".into(),
    }
}

#[test]
fn limit_exceeded_within_14_days_raises_near_alarm() {
    // Limit 20 mrad; increase of 0.1 mrad per day for 30 days.
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
    let mut harness = Harness::restored(tensioned(), store, now);
    harness.pass(700.0);
    let alarms = harness.snapshot().alarms;
    let key = AlarmKey {
        joint: Some("elbow".into()),
        condition: Condition::LimitNear,
    };
    let near = alarms.iter().find(|alarm| alarm.key == key);
    let Some(AlarmCause::Soon {
        at_low_utc_s: Some(at_low_utc_s),
        at_utc_s,
        ..
    }) = near.map(|alarm| &alarm.cause)
    else {
        panic!("{alarms:?}");
    };
    let trend = harness.snapshot().tendons[ELBOW].trend.clone().unwrap();
    // The dates of alarm and row are the same.
    let limit = &trend.limits[0];
    let low_s = at_low_utc_s - trend.last_utc_s;
    assert!(low_s <= 14.0 * DAY_S, "{} days", low_s / DAY_S);
    // f64 resolves 0.2 µs of the civil time.
    assert!((low_s - limit.after_low_s.unwrap()).abs() < 1e-6);
    assert_eq!(*at_utc_s, limit.after_s.map(|s| trend.last_utc_s + s));
    assert_eq!(trend.sessions, 30);
    assert!(trend.series.is_empty() && !trend.forecast.is_empty());

    // The exceeded limit ends the alarm of the same limit that was near.
    harness.session(&longer(seconds(60, 120), ELBOW, 30e-3));
    harness.pass(700.0);
    let state = |condition| harness.alarm(Some("elbow"), condition);
    assert_eq!(state(Condition::RetensionLimit), Some(AlarmState::Active));
    assert_eq!(state(Condition::LimitNear), Some(AlarmState::Cleared));
}

#[test]
fn history_keeps_best_record_per_day_with_valid_date() {
    let mut history = History::default();
    assert!(history.push(&record(2.0, 1e-3)));
    let worse = Record {
        offset_std_rad: Some(0.5e-3),
        ..record(1.9, 1.2e-3)
    };
    assert!(!history.push(&worse), "wider interval on the same day");
    let better = Record {
        offset_std_rad: Some(0.2e-3),
        ..record(1.8, 1.1e-3)
    };
    assert!(history.push(&better));
    let tensioned = Record {
        baseline: Some("tensioned".into()),
        ..record(1.75, 0.0)
    };
    assert!(
        history.push(&tensioned),
        "a re-tensioning divides a day into two"
    );
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
fn state_of_another_robot_is_ignored_and_reported() {
    let mut harness = Harness::new(tensioned());
    harness.session(seconds(60, 100));
    let mut store = harness.store.clone();
    let mut robot = (*biorob_like()).clone();
    if let Some(elbow) = &mut robot.transmissions[ELBOW] {
        elbow.stiffness_nm_per_rad = 25.0;
    }
    let other = config(&Arc::new(robot));
    let again = Harness::restored(other, store.clone(), harness.now);
    let text = serde_json::to_string(&again.store.journal).unwrap();
    assert!(
        text.contains("stored-state-ignored") && text.contains("stiffness_nm_per_rad"),
        "{text}"
    );
    if let Some(state) = &mut store.stored.state {
        *state = MonitorState {
            version: 99,
            ..state.clone()
        };
    }
    let again = Harness::restored(tensioned(), store, harness.now);
    let text = serde_json::to_string(&again.store.journal).unwrap();
    assert!(text.contains("stored-state-ignored"), "{text}");
}
