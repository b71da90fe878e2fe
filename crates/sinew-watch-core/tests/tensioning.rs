//! Re-tensioned and replaced ropes: new baseline, and continuity of the other tendons.

use crate::support::{Harness, biorob_like, config, later, longer, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::MonitorState;
use sinew_watch_core::alarm::{AlarmState, Condition};
use sinew_watch_core::command::{CommandError, CommandKind};
use sinew_watch_core::journal::{BaselineWaits, Event};
use sinew_watch_core::snapshot::{Learning, NoEstimateReason};

const PITCH: usize = 1;
const ELBOW: usize = 2;

fn tension(joints: &[&str]) -> CommandKind {
    CommandKind::Tensioned {
        joints: joints.iter().map(|j| j.to_string()).collect(),
    }
}

/// Frames with shoulder pitch and elbow elongated, mrad.
fn elongated(frames: &[Frame], pitch_mrad: f64, elbow_mrad: f64) -> Vec<Frame> {
    let frames = longer(frames, PITCH, 1e-3 * pitch_mrad);
    longer(&frames, ELBOW, 1e-3 * elbow_mrad)
}

fn offset_mrad(harness: &Harness, joint: &str) -> (f64, f64) {
    let offset = harness.last(joint).offset().expect("an offset");
    (1e3 * offset.mean, 1e3 * offset.half_width_95())
}

fn assert_near(harness: &Harness, joint: &str, truth_mrad: f64) {
    let (mean, half) = offset_mrad(harness, joint);
    assert!(
        (mean - truth_mrad).abs() < half,
        "{joint}: {mean} ± {half}, {truth_mrad} in truth"
    );
    assert!(half < 3.0, "{joint}: ± {half}");
}

#[test]
fn retensioning_one_rope_keeps_other_references() {
    let mut harness = Harness::new(tensioned());
    harness.session(&elongated(seconds(60, 120), 8.0, 10.0));
    assert_near(&harness, "shoulder_pitch", 8.0);
    assert_near(&harness, "elbow", 10.0);

    harness
        .command(tension(&["elbow"]), "with the new spanner")
        .unwrap();
    let snapshot = harness.snapshot();
    assert!(matches!(
        snapshot.learning,
        Learning::Baseline { poses: 0, .. }
    ));
    let reasons: Vec<_> = snapshot.tendons.iter().map(|t| t.reason).collect();
    assert_eq!(reasons, [Some(NoEstimateReason::NoData); 4]);
    assert_eq!(
        snapshot.tendons[ELBOW].tensioned_utc_s,
        Some(harness.now.utc_s())
    );
    assert_eq!(snapshot.tendons[PITCH].tensioned_utc_s, None);

    // Baseline in two parts.
    harness.play(&elongated(seconds(0, 30), 8.0, 0.0));
    let snapshot = harness.snapshot();
    assert_eq!(
        snapshot.tendons[0].reason,
        Some(NoEstimateReason::BaselineAcquisition)
    );
    harness.pass(70.0);
    let waits = harness.store.events(|event| match event {
        Event::BaselinePending { reason } => Some(*reason),
        _ => None,
    });
    assert_eq!(waits, [BaselineWaits::FewPoses]);
    let Learning::Baseline { duration_s, .. } = harness.snapshot().learning else {
        panic!("learns");
    };
    assert!(duration_s > 15.0, "{duration_s}");
    harness.session(&later(&elongated(seconds(30, 120), 8.0, 0.0), 100.0));
    let learned = harness.store.events(|event| match event {
        Event::Baseline { poses } => Some(*poses),
        _ => None,
    });
    assert!(learned.len() == 1 && learned[0] >= 12, "{learned:?}");

    harness.session(&elongated(seconds(120, 180), 9.0, 1.0));
    // Shoulder pitch keeps its reference; the elbow refers to its re-tensioning.
    assert_near(&harness, "shoulder_pitch", 9.0);
    assert_near(&harness, "elbow", 1.0);
    let state = harness.store.stored.state.as_ref().unwrap();
    let before = state.tendons[ELBOW].before_m;
    assert!(
        (before.mean - 10e-3 * 0.025).abs() < 2.0 * before.std.max(2e-5),
        "{before:?}"
    );
    // Earlier elongation counts towards the replacement limit.
    let record = harness.last("elbow");
    let strain = record.strain_ratio.unwrap();
    assert!((strain - 11e-3 * 0.025 / 0.7).abs() < 1e-4, "{strain}");
    assert_eq!(record.baseline, state.tendons[ELBOW].since);
    assert!(
        record
            .baseline
            .as_deref()
            .is_some_and(|b| b.starts_with("tensioned 2026-11-02"))
    );
    assert_eq!(
        harness.last("wrist").baseline.as_deref(),
        Some("first minute")
    );

    // A new rope has no earlier elongation.
    let elbow = vec!["elbow".to_string()];
    harness
        .command(CommandKind::Replaced { joints: elbow }, "")
        .unwrap();
    let tendon = &harness.store.stored.state.as_ref().unwrap().tendons[ELBOW];
    assert_eq!(tendon.before_m.mean, 0.0);
    assert_eq!(tendon.replaced_utc_s, Some(harness.now.utc_s()));
}

#[test]
fn retensioning_within_session_uses_its_result_first() {
    let mut harness = Harness::new(tensioned());
    harness.play(&elongated(seconds(60, 100), 0.0, 6.0));
    assert!(harness.store.records.is_empty());
    harness.command(tension(&["elbow"]), "").unwrap();
    assert_near(&harness, "elbow", 6.0);
    let state = harness.store.stored.state.as_ref().unwrap();
    let before = state.tendons[ELBOW].before_m;
    assert!(
        (before.mean - 6e-3 * 0.025).abs() < 3.0 * before.std,
        "{before:?}"
    );
    assert_eq!(state.tendons[ELBOW].last_rad, None);
    assert!(state.tendons[PITCH].last_rad.is_some());
    assert_eq!(state.learns.as_ref().unwrap().joints, ["elbow"]);
}

#[test]
fn limit_alarms_name_origin_and_clear_on_retensioning() {
    let mut harness = Harness::new(tensioned());
    // 25 mm × 30 mrad = 0.75 mm exceeds the limit of 0.5 mm.
    harness.session(&elongated(seconds(60, 120), 0.0, 30.0));
    assert_eq!(
        harness.alarm(Some("elbow"), Condition::RetensionLimit),
        None
    );
    harness.pass(600.0);
    let state = harness.alarm(Some("elbow"), Condition::RetensionLimit);
    assert_eq!(state, Some(AlarmState::Active));
    let alarms = harness.snapshot().alarms;
    let text = serde_json::to_string(&alarms).unwrap();
    assert!(text.contains(r#""origin":"robot-toml""#), "{text}");
    assert_eq!(
        harness.alarm(Some("shoulder_pitch"), Condition::RetensionLimit),
        None
    );
    harness.command(tension(&["elbow"]), "").unwrap();
    harness.pass(2000.0);
    assert_eq!(
        harness.alarm(Some("elbow"), Condition::RetensionLimit),
        None
    );
}

#[test]
fn limits_without_baseline_are_never_exceeded() {
    let mut harness = Harness::new(config(&biorob_like()));
    harness.session(&elongated(seconds(60, 120), 0.0, 40.0));
    harness.pass(2000.0);
    assert_eq!(harness.snapshot().learning, Learning::NoBaseline);
    assert_eq!(
        harness.alarm(Some("elbow"), Condition::RetensionLimit),
        None
    );
    assert_eq!(harness.last("elbow").baseline, None);
}

#[test]
fn invalid_commands_are_rejected_without_effect() {
    let mut harness = Harness::new(tensioned());
    let before = harness.store.journal.len();
    let error = harness.command(tension(&["knee"]), "").unwrap_err();
    let available = "shoulder_yaw, shoulder_pitch, elbow, wrist".to_string();
    let joint = "knee".to_string();
    assert_eq!(error, CommandError::Joint { joint, available });
    assert_eq!(
        harness.command(CommandKind::Note, "  "),
        Err(CommandError::NoNote)
    );
    let long = "x".repeat(5000);
    assert!(matches!(
        harness.command(CommandKind::Note, &long),
        Err(CommandError::TooLong { .. })
    ));
    assert_eq!(harness.store.journal.len(), before);
    harness
        .command(CommandKind::Note, "greased the wrist")
        .unwrap();
    assert_eq!(harness.store.journal.len(), before + 1);
}

/// The waiting motion belongs to the previous baseline and has no result for any tendon.
#[test]
fn retensioning_during_acquisition_counts_once() {
    let mut harness = Harness::new(tensioned());
    harness.session(&elongated(seconds(60, 120), 8.0, 10.0));
    harness.command(tension(&["elbow"]), "").unwrap();
    harness.play(&elongated(seconds(0, 30), 8.0, 0.0));
    harness.command(tension(&["shoulder_pitch"]), "").unwrap();
    let then = harness.store.stored.state.as_ref().unwrap().tendons.clone();
    harness.session(&later(seconds(0, 120), 100.0));
    harness.session(&elongated(seconds(120, 180), 2.0, 1.0));
    let now = &harness.store.stored.state.as_ref().unwrap().tendons;
    for (joint, i) in [("shoulder_pitch", PITCH), ("elbow", ELBOW)] {
        // All later sessions use the new reference, including the rest of the session that gave the baseline.
        let own = harness.store.records.iter().filter(|r| r.joint == joint);
        for record in own.skip(1) {
            assert_eq!(record.baseline, now[i].since, "{joint}: {record:?}");
        }
        assert_eq!(harness.last(joint).baseline, now[i].since, "{joint}");
        assert_eq!(now[i].since, then[i].since, "{joint}");
        assert_eq!(now[i].before_m, then[i].before_m, "{joint}");
        assert!(now[i].last_rad.is_some(), "{joint}");
    }
    assert_near(&harness, "shoulder_pitch", 2.0);
}

/// Days of work, with and without an entry that is withdrawn two sessions and a restart later.
fn days_of_work(is_entered: bool) -> Harness {
    const DAY_S: f64 = 86_400.0;
    let mut harness = Harness::new(tensioned());
    for day in 0..4 {
        harness.session(&elongated(
            seconds(60, 120),
            3.0,
            2.0 + 0.1 * f64::from(day),
        ));
        harness = harness.restart(DAY_S);
    }
    harness.session(&elongated(seconds(60, 100), 3.0, 2.5));
    if is_entered {
        harness.command(tension(&["elbow"]), "").unwrap();
    }
    harness.session(&elongated(seconds(100, 125), 3.0, 2.5));
    harness = harness.restart(DAY_S);
    harness.session(&elongated(seconds(60, 85), 3.0, 2.6));
    if is_entered {
        assert!(matches!(
            harness.snapshot().learning,
            Learning::Baseline { .. }
        ));
        harness
            .command(CommandKind::Withdraw { entry: 1 }, "it was arm-8")
            .unwrap();
    }
    harness.session(&elongated(seconds(85, 145), 3.0, 2.6));
    harness = harness.restart(DAY_S);
    harness.session(&elongated(seconds(60, 120), 3.0, 2.7));
    harness.pass(3700.0);
    harness
}

#[test]
fn withdrawn_entry_leaves_state_trend_and_records_unchanged() {
    let (entered, never) = (days_of_work(true), days_of_work(false));
    let state = |harness: &Harness| harness.store.stored.state.clone().unwrap();
    let (mut entered_state, never_state) = (state(&entered), state(&never));
    let [entry] = &entered_state.maintenance[..] else {
        panic!("{:?}", entered_state.maintenance);
    };
    assert!(entry.is_withdrawn() && entry.correction.as_ref().unwrap().who == "ada");
    entered_state.maintenance.clear();
    assert_eq!(entered_state, never_state);
    let records = |harness: &Harness| -> Vec<(f64, String, Option<f64>, Option<String>)> {
        let mut records = harness.store.records.clone();
        records.sort_by(|a, b| a.time_utc_s.total_cmp(&b.time_utc_s));
        (records.into_iter())
            .map(|r| (r.time_utc_s, r.joint, r.offset_rad, r.baseline))
            .collect()
    };
    assert_eq!(records(&entered), records(&never));
    assert_eq!(entered.store.stored.history, never.store.stored.history);
    let trends = |harness: &Harness| {
        let tendons = harness.snapshot().tendons;
        let trends = tendons.into_iter().map(|tendon| tendon.trend);
        trends.collect::<Vec<_>>()
    };
    assert!(trends(&never)[ELBOW].is_some());
    assert_eq!(trends(&entered), trends(&never));
    // The entry remains in the journal.
    let tensioned = |event: &Event| match event {
        Event::Command { command } => Some(command.what.clone()),
        _ => None,
    };
    let commands = [tension(&["elbow"]), CommandKind::Withdraw { entry: 1 }];
    assert_eq!(entered.store.events(tensioned), commands);
}

/// The entry ends a session of an arm at work: with and without the entry, its records are the same.
#[test]
fn withdrawn_entry_during_session_stores_records_once() {
    let mut harness = Harness::new(tensioned());
    harness.play(&elongated(seconds(60, 100), 3.0, 2.0));
    harness.command(tension(&["elbow"]), "").unwrap();
    let before = harness.store.records.clone();
    assert_eq!(before.len(), 4);
    harness
        .command(CommandKind::Withdraw { entry: 1 }, "it was arm-8")
        .unwrap();
    assert_eq!(harness.store.records, before);
}

/// The elbow was recorded, but it was the wrist; then the entry is dated, and withdrawn as a whole.
#[test]
fn corrected_entry_applies_to_other_tendon_and_date() {
    const WRIST: usize = 3;
    let tendons = |harness: &Harness| harness.store.stored.state.clone().unwrap().tendons;
    let mut harness = Harness::new(tensioned());
    harness.session(&longer(seconds(60, 120), WRIST, 4e-3));
    let (before, ended_utc_s) = (tendons(&harness), harness.now.utc_s() - 60.0);
    harness.pass(600.0);
    harness.command(tension(&["elbow"]), "").unwrap();
    let recorded_utc_s = harness.now.utc_s();
    harness.session(seconds(120, 150));
    let correct = |joint: &str, time_utc_s: f64| CommandKind::Correct {
        entry: 1,
        joints: vec![joint.into()],
        time_utc_s,
    };
    for time_utc_s in [recorded_utc_s + 1.0, ended_utc_s - 100.0, f64::NAN] {
        let error = harness.command(correct("wrist", time_utc_s), "");
        assert!(matches!(error, Err(CommandError::Date { .. })), "{error:?}");
    }
    let unknown = harness.command(CommandKind::Withdraw { entry: 2 }, "");
    assert_eq!(unknown, Err(CommandError::NoEntry { entry: 2 }));
    let worked_utc_s = recorded_utc_s - 300.0;
    harness.command(correct("wrist", worked_utc_s), "").unwrap();
    let state = harness.store.stored.state.clone().unwrap();
    assert_eq!(state.learns.as_ref().unwrap().joints, ["wrist"]);
    assert_eq!(state.tendons[ELBOW].since, before[ELBOW].since);
    assert_eq!(state.tendons[ELBOW].tensioned_utc_s, Vec::<f64>::new());
    assert_eq!(state.tendons[WRIST].tensioned_utc_s, [worked_utc_s]);
    // The elongation before the work is that of the session before the entry, not of the one after it.
    let geometry = harness.config.robot.transmissions[WRIST].clone().unwrap();
    let radius_m = geometry.tendon.unwrap().joint_pulley_radius_m;
    let expected_m = before[WRIST].last_rad.unwrap().scaled(radius_m);
    assert_eq!(state.tendons[WRIST].before_m.mean, expected_m.mean);

    harness
        .command(correct("wrist", worked_utc_s + 100.0), "")
        .unwrap();
    let dated = tendons(&harness);
    assert_eq!(dated[WRIST].tensioned_utc_s, [worked_utc_s + 100.0]);
    assert_eq!(dated[WRIST].since, state.tendons[WRIST].since);
    harness
        .command(CommandKind::Withdraw { entry: 1 }, "")
        .unwrap();
    let state: MonitorState = harness.store.stored.state.clone().unwrap();
    assert_eq!((state.learns, state.without), (None, None));
    assert_eq!(state.tendons[WRIST].since, before[WRIST].since);
    let again = harness.command(correct("wrist", worked_utc_s), "");
    assert_eq!(again, Err(CommandError::NoEntry { entry: 1 }));
}

#[test]
fn entry_before_another_can_only_be_dated() {
    let mut harness = Harness::new(tensioned());
    harness.session(seconds(60, 120));
    harness.pass(100.0);
    harness.command(tension(&["elbow"]), "").unwrap();
    harness.pass(100.0);
    harness.command(tension(&["wrist"]), "").unwrap();
    let withdrawn = harness.command(CommandKind::Withdraw { entry: 1 }, "");
    assert!(matches!(
        withdrawn,
        Err(CommandError::TooLate { entry: 1, .. })
    ));
    let correct = CommandKind::Correct {
        entry: 1,
        joints: vec!["elbow".into()],
        time_utc_s: harness.now.utc_s() - 150.0,
    };
    harness.command(correct, "").unwrap();
    harness
        .command(CommandKind::Withdraw { entry: 2 }, "")
        .unwrap();
    let state = harness.store.stored.state.clone().unwrap();
    assert_eq!(state.learns.as_ref().unwrap().joints, ["elbow"]);
    assert_eq!(
        state.tendons[ELBOW].tensioned_utc_s,
        [harness.now.utc_s() - 150.0]
    );
}
