//! Power off and on: what was stored goes on, an old number is no new one.

use crate::support::{Watched, later, longer, seconds, tensioned};
use sinew_watch_core::alarm::{AlarmState, Condition, Level};
use sinew_watch_core::command::What;
use sinew_watch_core::snapshot::{Freshness, NotNow};

const ELBOW: usize = 2;

#[test]
fn after_a_restart_nothing_is_known_until_a_window_has_been_solved() {
    let mut watched = Watched::new(tensioned());
    watched.play(&longer(seconds(60, 130), ELBOW, 5e-3));
    assert!(watched.snapshot().tendons[ELBOW].offset_rad.is_some());
    watched.pass(70.0);
    let recorded = watched.last("elbow").clone();

    let mut watched = watched.restart(30.0);
    let snapshot = watched.snapshot();
    assert_eq!(snapshot.freshness, Freshness::Never);
    assert_eq!(
        (snapshot.level, snapshot.tendons[ELBOW].level),
        (Level::Stale, Level::Stale)
    );
    assert_eq!(snapshot.tendons[ELBOW].reason, Some(NotNow::NoData));
    // The last record is there, and says of when it is.
    assert_eq!(snapshot.tendons[ELBOW].last.as_ref(), Some(&recorded));

    let frames = later(&longer(seconds(130, 200), ELBOW, 5e-3), 200.0);
    let mut seen = Vec::new();
    for second in frames.chunks(250) {
        watched.play(second);
        watched.now = watched.now.after_s(0.004);
        let tendon = &watched.snapshot().tendons[ELBOW];
        assert_eq!(
            tendon.level == Level::Stale,
            !seen.contains(&true) && tendon.offset_rad.is_none()
        );
        seen.push(tendon.offset_rad.is_some());
    }
    let known_s = seen
        .iter()
        .position(|known| *known)
        .expect("it is known in the end");
    assert!((2..12).contains(&known_s), "{known_s} s");
}

#[test]
fn a_crash_loses_a_minute_of_learning_at_most() {
    let mut watched = Watched::new(tensioned());
    let frames = longer(seconds(60, 240), ELBOW, 5e-3);
    let mut worst_s = 0.0_f64;
    for (k, tenth) in frames.chunks(25).enumerate() {
        watched.play(tenth);
        watched.now = watched.now.after_s(0.004);
        let learned_s = watched
            .store
            .stored
            .belief
            .as_ref()
            .and_then(|b| b.end_utc_s);
        let began_s = crate::support::MONDAY_NS as f64 * 1e-9;
        let lost_s = watched.now.utc_s() - learned_s.unwrap_or(began_s);
        worst_s = worst_s.max(lost_s);
        assert!(lost_s < 60.0, "after {k}: {lost_s} s");
    }
    println!("at worst {worst_s:.1} s");
    let watched = watched.restart(10.0);
    let belief = watched.store.stored.belief.as_ref().unwrap();
    assert!(belief.baseline.as_ref().unwrap().recordings.len() > 1);
}

#[test]
fn alarms_shelves_and_beliefs_are_as_they_were() {
    let mut watched = Watched::new(tensioned());
    watched.session(&longer(seconds(60, 120), ELBOW, 30e-3));
    watched.pass(650.0);
    let state = watched.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active));
    let alarm = watched.snapshot().alarms[0].key.clone();
    watched
        .say(
            What::Shelve {
                alarm,
                for_s: 7200.0,
            },
            "",
        )
        .unwrap();
    let before = (
        watched.snapshot().alarms,
        watched.store.stored.belief.clone(),
    );
    let mut watched = watched.restart(600.0);
    let after = (
        watched.snapshot().alarms,
        watched.store.stored.belief.clone(),
    );
    // No data came yet: that alarm is of before, too.
    assert_eq!(before, after);
    assert_eq!(watched.snapshot().tendons[ELBOW].level, Level::Stale);
    watched.pass(6700.0);
    let shelved = |watched: &Watched| {
        let alarms = watched.snapshot().alarms;
        alarms.iter().any(|a| a.shelved_until_utc_s.is_some())
    };
    assert!(!shelved(&watched), "the shelf ended");
    let state = watched.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active), "the limit is passed still");
}

#[test]
fn a_store_that_fails_hides_no_alarm_and_loses_no_record() {
    let mut watched = Watched::new(tensioned());
    watched.store.fails = true;
    watched.session(&longer(seconds(60, 120), ELBOW, 30e-3));
    watched.pass(700.0);
    assert_eq!(
        watched.alarm(None, Condition::Store),
        Some(AlarmState::Active)
    );
    let state = watched.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active));
    assert!(watched.store.records.is_empty() && watched.snapshot().waiting_to_be_stored > 0);
    assert_eq!(
        watched.snapshot().tendons[ELBOW].last,
        None,
        "no record is spoken of"
    );
    for k in 0..15_000 {
        watched.say(What::Note, &format!("note {k}")).unwrap();
    }
    watched.store.fails = false;
    watched.pass(70.0);
    assert_eq!(watched.store.records.len(), 4);
    assert!(
        watched.store.journal.len() <= 10_100,
        "{}",
        watched.store.journal.len()
    );
    let told = serde_json::to_string(&watched.store.journal).unwrap();
    assert!(told.contains("given-up") && told.contains("note 14999") && !told.contains("note 1\""));
    assert_eq!(
        watched.alarm(None, Condition::Store),
        Some(AlarmState::Cleared)
    );
    assert_eq!(watched.snapshot().waiting_to_be_stored, 0);
}
