//! Tensioned and replaced ropes: a new baseline, and what the others carry over it.

use crate::support::{Watched, biorob_like, config, later, longer, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmState, Condition};
use sinew_watch_core::command::{CommandError, What};
use sinew_watch_core::journal::{BaselineWaits, Event};
use sinew_watch_core::snapshot::{Learning, NotNow};

const PITCH: usize = 1;
const ELBOW: usize = 2;

fn tension(joints: &[&str]) -> What {
    What::Tensioned {
        joints: joints.iter().map(|j| j.to_string()).collect(),
    }
}

/// Pitch and elbow so much longer, mrad.
fn stretched(frames: &[Frame], pitch_mrad: f64, elbow_mrad: f64) -> Vec<Frame> {
    let frames = longer(frames, PITCH, 1e-3 * pitch_mrad);
    longer(&frames, ELBOW, 1e-3 * elbow_mrad)
}

fn offset_mrad(watched: &Watched, joint: &str) -> (f64, f64) {
    let offset = watched.last(joint).offset().expect("an offset");
    (1e3 * offset.mean, 1e3 * offset.half_width_95())
}

fn assert_near(watched: &Watched, joint: &str, truth_mrad: f64) {
    let (mean, half) = offset_mrad(watched, joint);
    assert!(
        (mean - truth_mrad).abs() < half,
        "{joint}: {mean} ± {half}, {truth_mrad} in truth"
    );
    assert!(half < 3.0, "{joint}: ± {half}");
}

#[test]
fn one_rope_is_tensioned_and_the_others_go_on() {
    let mut watched = Watched::new(tensioned());
    watched.session(&stretched(seconds(60, 120), 8.0, 10.0));
    assert_near(&watched, "shoulder_pitch", 8.0);
    assert_near(&watched, "elbow", 10.0);

    watched
        .say(tension(&["elbow"]), "with the new spanner")
        .unwrap();
    let snapshot = watched.snapshot();
    assert!(matches!(
        snapshot.learning,
        Learning::Baseline { poses: 0, .. }
    ));
    let reasons: Vec<_> = snapshot.tendons.iter().map(|t| t.reason).collect();
    assert_eq!(reasons, [Some(NotNow::NoData); 4]);
    assert_eq!(
        snapshot.tendons[ELBOW].tensioned_utc_s,
        Some(watched.now.utc_s())
    );
    assert_eq!(snapshot.tendons[PITCH].tensioned_utc_s, None);

    // The baseline, in two parts.
    watched.play(&stretched(seconds(0, 30), 8.0, 0.0));
    let snapshot = watched.snapshot();
    assert_eq!(snapshot.tendons[0].reason, Some(NotNow::LearnsBaseline));
    watched.pass(70.0);
    let waits = watched.store.events(|event| match event {
        Event::BaselineWaits { why } => Some(*why),
        _ => None,
    });
    assert_eq!(waits, [BaselineWaits::FewPoses]);
    let Learning::Baseline { duration_s, .. } = watched.snapshot().learning else {
        panic!("learns");
    };
    assert!(duration_s > 15.0, "{duration_s}");
    watched.session(&later(&stretched(seconds(30, 120), 8.0, 0.0), 100.0));
    let learned = watched.store.events(|event| match event {
        Event::Baseline { poses } => Some(*poses),
        _ => None,
    });
    assert!(learned.len() == 1 && learned[0] >= 12, "{learned:?}");

    watched.session(&stretched(seconds(120, 180), 9.0, 1.0));
    // Pitch counts from before, elbow from its tensioning.
    assert_near(&watched, "shoulder_pitch", 9.0);
    assert_near(&watched, "elbow", 1.0);
    let belief = watched.store.stored.belief.as_ref().unwrap();
    let before = belief.tendons[ELBOW].before_m;
    assert!(
        (before.mean - 10e-3 * 0.025).abs() < 2.0 * before.deviation.max(2e-5),
        "{before:?}"
    );
    // What the rope was longer before counts towards its replacement.
    let record = watched.last("elbow");
    let strain = record.strain_ratio.unwrap();
    assert!((strain - 11e-3 * 0.025 / 0.7).abs() < 1e-4, "{strain}");
    assert_eq!(record.baseline, belief.tendons[ELBOW].since);
    assert!(
        record
            .baseline
            .as_deref()
            .is_some_and(|b| b.starts_with("tensioned 2026-11-02"))
    );
    assert_eq!(
        watched.last("wrist").baseline.as_deref(),
        Some("first minute")
    );

    // A new rope has no past.
    let elbow = vec!["elbow".to_string()];
    watched.say(What::Replaced { joints: elbow }, "").unwrap();
    let tendon = &watched.store.stored.belief.as_ref().unwrap().tendons[ELBOW];
    assert_eq!(tendon.before_m.mean, 0.0);
    assert_eq!(tendon.replaced_utc_s, Some(watched.now.utc_s()));
}

#[test]
fn a_tensioning_amid_a_session_hears_its_last_word_first() {
    let mut watched = Watched::new(tensioned());
    watched.play(&stretched(seconds(60, 100), 0.0, 6.0));
    assert!(watched.store.records.is_empty());
    watched.say(tension(&["elbow"]), "").unwrap();
    assert_near(&watched, "elbow", 6.0);
    let belief = watched.store.stored.belief.as_ref().unwrap();
    let before = belief.tendons[ELBOW].before_m;
    assert!(
        (before.mean - 6e-3 * 0.025).abs() < 3.0 * before.deviation,
        "{before:?}"
    );
    assert_eq!(belief.tendons[ELBOW].last_rad, None);
    assert!(belief.tendons[PITCH].last_rad.is_some());
    assert_eq!(belief.learns.as_ref().unwrap().joints, ["elbow"]);
}

#[test]
fn limits_are_alarms_with_their_origin_and_tensioning_clears_them() {
    let mut watched = Watched::new(tensioned());
    // 25 mm times 30 mrad: 0.75 mm, where 0.5 mm is the limit.
    watched.session(&stretched(seconds(60, 120), 0.0, 30.0));
    assert_eq!(
        watched.alarm(Some("elbow"), Condition::RetensionLimit),
        None
    );
    watched.pass(600.0);
    let state = watched.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active));
    let alarms = watched.snapshot().alarms;
    let text = serde_json::to_string(&alarms).unwrap();
    assert!(text.contains(r#""origin":"robot-toml""#), "{text}");
    assert_eq!(
        watched.alarm(Some("shoulder_pitch"), Condition::RetensionLimit),
        None
    );
    watched.say(tension(&["elbow"]), "").unwrap();
    watched.pass(2000.0);
    assert_eq!(
        watched.alarm(Some("elbow"), Condition::RetensionLimit),
        None
    );
}

#[test]
fn without_a_baseline_no_limit_is_passed() {
    let mut watched = Watched::new(config(&biorob_like()));
    watched.session(&stretched(seconds(60, 120), 0.0, 40.0));
    watched.pass(2000.0);
    assert_eq!(watched.snapshot().learning, Learning::NoBaseline);
    assert_eq!(
        watched.alarm(Some("elbow"), Condition::RetensionLimit),
        None
    );
    assert_eq!(watched.last("elbow").baseline, None);
}

#[test]
fn commands_that_can_t_be_are_refused_and_change_nothing() {
    let mut watched = Watched::new(tensioned());
    let before = watched.store.journal.len();
    let refused = watched.say(tension(&["knee"]), "").unwrap_err();
    let known = "shoulder_yaw, shoulder_pitch, elbow, wrist".to_string();
    let joint = "knee".to_string();
    assert_eq!(refused, CommandError::Joint { joint, known });
    assert_eq!(watched.say(What::Note, "  "), Err(CommandError::NoNote));
    let long = "x".repeat(5000);
    assert!(matches!(
        watched.say(What::Note, &long),
        Err(CommandError::TooLong { .. })
    ));
    assert_eq!(watched.store.journal.len(), before);
    watched.say(What::Note, "greased the wrist").unwrap();
    assert_eq!(watched.store.journal.len(), before + 1);
}

/// What waits then is motion for the baseline of the rope before: it has no last word on any tendon.
#[test]
fn a_rope_tensioned_while_a_baseline_is_learned_counts_once() {
    let mut watched = Watched::new(tensioned());
    watched.session(&stretched(seconds(60, 120), 8.0, 10.0));
    watched.say(tension(&["elbow"]), "").unwrap();
    watched.play(&stretched(seconds(0, 30), 8.0, 0.0));
    watched.say(tension(&["shoulder_pitch"]), "").unwrap();
    let then = watched
        .store
        .stored
        .belief
        .as_ref()
        .unwrap()
        .tendons
        .clone();
    watched.session(&later(seconds(0, 120), 100.0));
    watched.session(&stretched(seconds(120, 180), 2.0, 1.0));
    let now = &watched.store.stored.belief.as_ref().unwrap().tendons;
    for (joint, i) in [("shoulder_pitch", PITCH), ("elbow", ELBOW)] {
        // Every session since counts from there, the rest of the one that taught the baseline as well.
        let own = watched.store.records.iter().filter(|r| r.joint == joint);
        for record in own.skip(1) {
            assert_eq!(record.baseline, now[i].since, "{joint}: {record:?}");
        }
        assert_eq!(watched.last(joint).baseline, now[i].since, "{joint}");
        assert_eq!(now[i].since, then[i].since, "{joint}");
        assert_eq!(now[i].before_m, then[i].before_m, "{joint}");
        assert!(now[i].last_rad.is_some(), "{joint}");
    }
    assert_near(&watched, "shoulder_pitch", 2.0);
}
