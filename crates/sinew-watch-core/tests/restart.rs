//! Restart: the monitor resumes from stored data, and old results are not shown as new.

use crate::support::{Harness, later, longer, seconds, tensioned};
use sinew_watch_core::alarm::{AlarmState, Condition, Level};
use sinew_watch_core::command::CommandKind;
use sinew_watch_core::snapshot::{Freshness, NoEstimateReason};

const ELBOW: usize = 2;

#[test]
fn restart_has_no_offset_before_first_window() {
    let mut harness = Harness::new(tensioned());
    harness.play(&longer(seconds(60, 130), ELBOW, 5e-3));
    assert!(harness.snapshot().tendons[ELBOW].offset_rad.is_some());
    harness.pass(70.0);
    let recorded = harness.last("elbow").clone();

    let mut harness = harness.restart(30.0);
    let snapshot = harness.snapshot();
    assert_eq!(snapshot.freshness, Freshness::Never);
    assert_eq!(
        (snapshot.level, snapshot.tendons[ELBOW].level),
        (Level::Stale, Level::Stale)
    );
    assert_eq!(
        snapshot.tendons[ELBOW].reason,
        Some(NoEstimateReason::NoData)
    );
    // The last record is available with its date.
    assert_eq!(snapshot.tendons[ELBOW].last.as_ref(), Some(&recorded));

    let frames = later(&longer(seconds(130, 200), ELBOW, 5e-3), 200.0);
    let mut seen = Vec::new();
    for second in frames.chunks(250) {
        harness.play(second);
        harness.now = harness.now.after_s(0.004);
        let tendon = &harness.snapshot().tendons[ELBOW];
        assert_eq!(
            tendon.level == Level::Stale,
            !seen.contains(&true) && tendon.offset_rad.is_none()
        );
        seen.push(tendon.offset_rad.is_some());
    }
    let available_s = seen
        .iter()
        .position(|available| *available)
        .expect("an offset is available at the end");
    assert!((2..12).contains(&available_s), "{available_s} s");
}

#[test]
fn crash_loses_at_most_one_minute_of_data() {
    let mut harness = Harness::new(tensioned());
    let frames = longer(seconds(60, 240), ELBOW, 5e-3);
    let mut worst_s = 0.0_f64;
    for (k, tenth) in frames.chunks(25).enumerate() {
        harness.play(tenth);
        harness.now = harness.now.after_s(0.004);
        let learned_s = harness
            .store
            .stored
            .state
            .as_ref()
            .and_then(|b| b.end_utc_s);
        let began_s = crate::support::MONDAY_NS as f64 * 1e-9;
        let lost_s = harness.now.utc_s() - learned_s.unwrap_or(began_s);
        worst_s = worst_s.max(lost_s);
        assert!(lost_s < 60.0, "after {k}: {lost_s} s");
    }
    println!("at worst {worst_s:.1} s");
    let harness = harness.restart(10.0);
    let state = harness.store.stored.state.as_ref().unwrap();
    assert!(state.baseline.as_ref().unwrap().recordings.len() > 1);
}

#[test]
fn restart_restores_alarms_shelving_and_state() {
    let mut harness = Harness::new(tensioned());
    harness.session(&longer(seconds(60, 120), ELBOW, 30e-3));
    harness.pass(650.0);
    let state = harness.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active));
    let alarm = harness.snapshot().alarms[0].key.clone();
    harness
        .command(
            CommandKind::Shelve {
                alarm,
                for_s: 7200.0,
            },
            "",
        )
        .unwrap();
    let before = (
        harness.snapshot().alarms,
        harness.store.stored.state.clone(),
    );
    let mut harness = harness.restart(600.0);
    let after = (
        harness.snapshot().alarms,
        harness.store.stored.state.clone(),
    );
    // No data have been received yet; the alarm is restored.
    assert_eq!(before, after);
    assert_eq!(harness.snapshot().tendons[ELBOW].level, Level::Stale);
    harness.pass(6700.0);
    let shelved = |harness: &Harness| {
        let alarms = harness.snapshot().alarms;
        alarms.iter().any(|a| a.shelved_until_utc_s.is_some())
    };
    assert!(!shelved(&harness), "the shelf ended");
    let state = harness.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active), "the limit is passed still");
}

#[test]
fn failing_store_hides_no_alarm_and_loses_no_record() {
    let mut harness = Harness::new(tensioned());
    harness.store.fails = true;
    harness.session(&longer(seconds(60, 120), ELBOW, 30e-3));
    harness.pass(700.0);
    assert_eq!(
        harness.alarm(None, Condition::Store),
        Some(AlarmState::Active)
    );
    let state = harness.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active));
    assert!(harness.store.records.is_empty() && harness.snapshot().waiting_to_be_stored > 0);
    assert_eq!(
        harness.snapshot().tendons[ELBOW].last,
        None,
        "no record is spoken of"
    );
    for k in 0..15_000 {
        harness
            .command(CommandKind::Note, &format!("note {k}"))
            .unwrap();
    }
    harness.store.fails = false;
    harness.pass(70.0);
    assert_eq!(harness.store.records.len(), 4);
    assert!(
        harness.store.journal.len() <= 10_100,
        "{}",
        harness.store.journal.len()
    );
    let told = serde_json::to_string(&harness.store.journal).unwrap();
    assert!(told.contains("given-up") && told.contains("note 14999") && !told.contains("note 1\""));
    assert_eq!(
        harness.alarm(None, Condition::Store),
        Some(AlarmState::Cleared)
    );
    assert_eq!(harness.snapshot().waiting_to_be_stored, 0);
}
