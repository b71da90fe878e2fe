//! Sudden changes: suspected once, an alarm when a second session sees them too.

use crate::support::{HZ, Watched, later, longer, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmCause, AlarmState, Condition, JumpKind, Level};
use sinew_watch_core::command::{CommandError, What};

const ELBOW: usize = 2;
const SLIP_RAD: f64 = 6e-3;

/// A minute of work in whose middle the elbow slips.
fn with_slip() -> Vec<Frame> {
    let mut frames = seconds(60, 120).to_vec();
    for frame in &mut frames[30 * HZ..] {
        frame.theta[ELBOW] += SLIP_RAD;
    }
    frames
}

fn state(watched: &Watched, condition: Condition) -> Option<AlarmState> {
    watched.alarm(Some("elbow"), condition)
}

#[test]
fn a_slip_is_suspected_then_confirmed_and_latches_until_somebody_resets_it() {
    let mut watched = Watched::new(tensioned());
    watched.session(&with_slip());
    assert_eq!(
        state(&watched, Condition::Suspicion),
        Some(AlarmState::Active)
    );
    assert_eq!(state(&watched, Condition::Jump), None);
    let began = watched.store.records[0].time_utc_s;

    watched.session(&longer(seconds(120, 180), ELBOW, SLIP_RAD));
    assert_eq!(
        state(&watched, Condition::Suspicion),
        Some(AlarmState::Cleared)
    );
    assert_eq!(state(&watched, Condition::Jump), Some(AlarmState::Latched));
    let snapshot = watched.snapshot();
    assert_eq!(
        (snapshot.level, snapshot.tendons[ELBOW].level),
        (Level::Error, Level::Error)
    );
    let alarm = snapshot.alarms[0].clone();
    let AlarmCause::Jump {
        time_utc_s,
        size_rad,
        what,
        ..
    } = alarm.cause
    else {
        panic!("{alarm:?}");
    };
    assert!(
        (time_utc_s - began - 30.0).abs() < 2.0,
        "{} s",
        time_utc_s - began
    );
    assert!((size_rad - SLIP_RAD).abs() < 1e-3, "{size_rad}");
    assert_eq!(what, JumpKind::Slip);

    // It stays, whatever comes.
    watched.session(&longer(seconds(180, 240), ELBOW, SLIP_RAD));
    assert_eq!(state(&watched, Condition::Jump), Some(AlarmState::Latched));
    assert_eq!(
        state(&watched, Condition::Suspicion),
        Some(AlarmState::Cleared)
    );
    let key = alarm.key;
    watched
        .say(What::Acknowledge { alarm: key.clone() }, "")
        .unwrap();
    assert_eq!(state(&watched, Condition::Jump), Some(AlarmState::Latched));
    let reset = What::Reset { alarm: key };
    assert_eq!(watched.say(reset.clone(), ""), Err(CommandError::NoNote));
    watched.say(reset, "clamp was loose, tightened").unwrap();
    assert_eq!(state(&watched, Condition::Jump), None);
}

#[test]
fn what_is_gone_in_the_next_session_was_no_jump() {
    let mut watched = Watched::new(tensioned());
    watched.session(&with_slip());
    assert_eq!(
        state(&watched, Condition::Suspicion),
        Some(AlarmState::Active)
    );
    watched.session(seconds(120, 180));
    assert_eq!(
        state(&watched, Condition::Suspicion),
        Some(AlarmState::Cleared)
    );
    assert_eq!(state(&watched, Condition::Jump), None);
}

#[test]
fn what_changed_while_nobody_watched_needs_a_second_session() {
    let mut watched = Watched::new(tensioned());
    watched.session(seconds(60, 120));
    let mut watched = watched.restart(3600.0);
    watched.session(&longer(&later(seconds(120, 180), 7200.0), ELBOW, SLIP_RAD));
    assert_eq!(
        state(&watched, Condition::Suspicion),
        Some(AlarmState::Active)
    );
    let text = serde_json::to_string(&watched.snapshot().alarms).unwrap();
    assert!(text.contains("while-off"), "{text}");
    watched.session(&longer(&later(seconds(180, 240), 7200.0), ELBOW, SLIP_RAD));
    assert_eq!(state(&watched, Condition::Jump), Some(AlarmState::Latched));
}

#[test]
fn a_rope_that_is_shorter_was_tensioned_by_somebody() {
    let mut watched = Watched::new(tensioned());
    watched.session(&longer(seconds(60, 120), ELBOW, 9e-3));
    watched.session(seconds(120, 180));
    let text = serde_json::to_string(&watched.snapshot().alarms).unwrap();
    assert!(text.contains("retensioned"), "{text}");
    // Somebody says so, and all that counts from before is what it was before.
    let elbow = vec!["elbow".to_string()];
    watched.say(What::Tensioned { joints: elbow }, "").unwrap();
    assert_eq!(state(&watched, Condition::Suspicion), None);
    let belief = watched.store.stored.belief.as_ref().unwrap();
    let before = belief.tendons[ELBOW].before_m;
    assert!(
        (before.mean - 9e-3 * 0.025).abs() < 3.0 * before.deviation,
        "{before:?}"
    );
}

#[test]
fn creep_is_no_jump() {
    let mut watched = Watched::new(tensioned());
    for k in 0..6 {
        let from = 60 + 30 * (k % 5);
        let crept = longer(seconds(from, from + 30), ELBOW, 0.4e-3 * k as f64);
        watched.session(&crept);
        watched.pass(3600.0);
    }
    assert_eq!(state(&watched, Condition::Suspicion), None);
    assert_eq!(state(&watched, Condition::Jump), None);
}
