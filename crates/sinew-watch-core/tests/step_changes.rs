//! Step changes: suspected in one session, alarm after confirmation by a second.

use crate::support::{
    HZ, Harness, biorob_like, frames, later, longer, seconds, tensioned, without_events,
};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmCause, AlarmKey, AlarmState, Condition, Level, StepKind};
use sinew_watch_core::command::{CommandError, CommandKind};
use sinew_watch_core::incident::{Finding, Incident, IncidentCause, IncidentPhase};
use sinew_watch_core::journal::Event;
use sinew_watch_core::snapshot::Validity;

const ELBOW: usize = 2;
const SLIP_RAD: f64 = 6e-3;

/// One minute of work; the elbow slips after 30 s.
fn with_slip() -> Vec<Frame> {
    let mut frames = seconds(60, 120).to_vec();
    for frame in &mut frames[30 * HZ..] {
        frame.theta[ELBOW] += SLIP_RAD;
    }
    frames
}

fn state(harness: &Harness, condition: Condition) -> Option<AlarmState> {
    harness.alarm(Some("elbow"), condition)
}

/// The elbow's tendon tears 30 s after the start of the session.
#[test]
fn torn_tendon_raises_alarm_without_confirmation() {
    let robot = biorob_like();
    let torn = |text: String| {
        let keys = "[truth]\nstiffness_later_factor = { elbow = 0 }\nstiffness_later_from_s = 90\n";
        without_events(text).replace("[truth]\n", keys)
    };
    // The robot of the baseline: the same draws.
    let all = frames(&robot, 51, 120.0, torn);
    let mut harness = Harness::new(tensioned());
    harness.session(&all[60 * HZ..120 * HZ]);
    assert_eq!(
        state(&harness, Condition::TransmissionLost),
        Some(AlarmState::Latched)
    );
    let snapshot = harness.snapshot();
    let alarm = &snapshot.alarms[0];
    assert_eq!(alarm.key.condition, Condition::TransmissionLost);
    let AlarmCause::StepChange {
        time_utc_s, what, ..
    } = alarm.cause
    else {
        panic!("{alarm:?}");
    };
    assert_eq!(what, StepKind::TransmissionLost);
    let began = harness.store.records[0].time_utc_s;
    assert!(
        (time_utc_s - began - 30.0).abs() < 1.5,
        "{time_utc_s} {began}"
    );
    let of_elbow = snapshot.alarms.iter();
    let of_elbow = of_elbow.filter(|alarm| {
        alarm.key.joint.as_deref() == Some("elbow") && alarm.key.condition.is_change()
    });
    assert_eq!(of_elbow.count(), 1, "{:?}", snapshot.alarms);
    // No other tendon has an alarm of its rope.
    let of_rope = |key: &AlarmKey| key.condition.latches() && key.joint.as_deref() != Some("elbow");
    assert!(
        !snapshot.alarms.iter().any(|a| of_rope(&a.key)),
        "{:?}",
        snapshot.alarms
    );
}

#[test]
fn slip_is_suspected_confirmed_and_latched_until_reset() {
    let mut harness = Harness::new(tensioned());
    harness.session(&with_slip());
    assert_eq!(
        state(&harness, Condition::SuspectedStep),
        Some(AlarmState::Active)
    );
    assert_eq!(state(&harness, Condition::StepChange), None);
    let began = harness.store.records[0].time_utc_s;

    harness.session(&longer(seconds(120, 180), ELBOW, SLIP_RAD));
    // The confirmed change supersedes the suspected one.
    assert_eq!(state(&harness, Condition::SuspectedStep), None);
    assert_eq!(
        state(&harness, Condition::StepChange),
        Some(AlarmState::Latched)
    );
    let snapshot = harness.snapshot();
    assert_eq!(
        (snapshot.level, snapshot.tendons[ELBOW].level),
        (Level::Error, Level::Error)
    );
    let alarm = snapshot.alarms[0].clone();
    let AlarmCause::StepChange {
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
    assert_eq!(what, StepKind::Slip);

    // The alarm stays latched.
    harness.session(&longer(seconds(180, 240), ELBOW, SLIP_RAD));
    assert_eq!(
        state(&harness, Condition::StepChange),
        Some(AlarmState::Latched)
    );
    assert_eq!(state(&harness, Condition::SuspectedStep), None);
    let key = alarm.key;
    harness
        .command(CommandKind::Acknowledge { alarm: key.clone() }, "")
        .unwrap();
    assert_eq!(
        state(&harness, Condition::StepChange),
        Some(AlarmState::Latched)
    );
    let reset = CommandKind::Reset { alarm: key };
    assert_eq!(
        harness.command(reset.clone(), ""),
        Err(CommandError::NoNote)
    );
    harness
        .command(reset, "clamp was loose, tightened")
        .unwrap();
    assert_eq!(state(&harness, Condition::StepChange), None);
}

#[test]
fn step_absent_in_next_session_is_withdrawn() {
    let mut harness = Harness::new(tensioned());
    harness.session(&with_slip());
    assert_eq!(
        state(&harness, Condition::SuspectedStep),
        Some(AlarmState::Active)
    );
    harness.session(seconds(120, 180));
    assert_eq!(
        state(&harness, Condition::SuspectedStep),
        Some(AlarmState::Cleared)
    );
    assert_eq!(state(&harness, Condition::StepChange), None);
    // The refutation is in the journal with its evidence.
    let refuted = incident(&harness);
    assert_eq!(
        (refuted.phase, refuted.finding),
        (IncidentPhase::Closed, None)
    );
    assert!(refuted.evidence[1].probability <= 0.05, "{refuted:?}");
    assert_eq!(
        phases(&harness),
        [IncidentPhase::Suspected, IncidentPhase::Closed]
    );
}

/// Validity of the elbow's offset in a minute of work with an event after 30 s: the flag falls within 2 s of the event, and
/// rises once the offset differs from that before by `size_rad`.
fn check_validity(frames: &[Frame], size_rad: f64) {
    let mut harness = Harness::new(tensioned());
    let started = harness.snapshot().tendons[ELBOW].validity;
    assert_eq!(started, Validity::NotValid { for_s: 0.0 });
    let (mut fell_s, mut rose_s, mut for_s) = (f64::NAN, f64::NAN, 0.0);
    let mut level_rad = f64::NAN;
    for (k, tenth) in frames.chunks(HZ / 10).enumerate() {
        harness.play(tenth);
        harness.now = harness.now.after_s(1.0 / HZ as f64);
        let since_s = 0.1 * (k + 1) as f64 - 30.0;
        let elbow = harness.snapshot().tendons[ELBOW].clone();
        match elbow.validity {
            Validity::Valid => {
                assert!(elbow.provisional.is_none() && elbow.reason.is_none());
                let offset_rad = elbow.offset_rad.unwrap();
                if since_s < 0.0 {
                    level_rad = offset_rad.mean;
                } else if fell_s.is_finite() && rose_s.is_nan() {
                    rose_s = since_s;
                }
                // After the first 2 s, no offset of before the event is valid.
                let error_rad = offset_rad.mean - level_rad - size_rad;
                let is_right = error_rad.abs() < 2.0 * offset_rad.half_width_95();
                assert!(since_s < 2.0 || is_right, "{since_s:.1} s: {offset_rad:?}");
                for_s = 0.0;
            }
            Validity::NotValid { for_s: now_s } => {
                assert!(elbow.provisional.is_some() || elbow.reason.is_some());
                assert!(now_s >= for_s, "{now_s} s after {for_s} s");
                for_s = now_s;
                if since_s > 0.0 && fell_s.is_nan() {
                    fell_s = since_s;
                    assert!(now_s < 0.3, "{now_s}");
                }
            }
        }
    }
    println!("not valid from {fell_s:.1} to {rose_s:.1} s after the event");
    assert!(fell_s < 2.0, "{fell_s}");
    assert!(rose_s > fell_s + 1.0 && rose_s < 20.0, "{rose_s}");
}

/// The rope slips, simulated with the draws of the baseline: the offset contains the slip afterwards.
#[test]
fn offset_after_rope_slip_is_not_valid_until_it_follows() {
    let slip = |text: String| {
        without_events(text)
            + &format!(
                "\n[[offsets]]\njoint = \"elbow\"\nkind = \"physical\"\nshape = \"step\"\nat_s = 90.0\nrad = {SLIP_RAD:?}\n"
            )
    };
    let all = frames(&biorob_like(), 51, 120.0, slip);
    check_validity(&all[60 * HZ..120 * HZ], SLIP_RAD);
}

/// A step of the motor encoder between two samples: the rope did not slip, and the offset remains.
#[test]
fn offset_after_encoder_slip_is_not_valid_until_it_is_found() {
    check_validity(&with_slip(), 0.0);
}

fn incident(harness: &Harness) -> Incident {
    let incidents = harness.snapshot().incidents;
    let [incident] = &incidents[..] else {
        panic!("{incidents:?}");
    };
    assert_eq!(incident.joint, "elbow");
    incident.clone()
}

/// Phases of the incident according to the journal.
fn phases(harness: &Harness) -> Vec<IncidentPhase> {
    harness.store.events(|event| match event {
        Event::Incident { incident } => Some(incident.phase),
        _ => None,
    })
}

fn found(finding: Finding) -> CommandKind {
    let joint = "elbow".into();
    CommandKind::Finding { joint, finding }
}

#[test]
fn incident_lasts_from_suspected_change_to_repair_with_finding() {
    let mut harness = Harness::new(tensioned());
    let none = harness.command(found(Finding::Nothing), "");
    assert!(matches!(none, Err(CommandError::NoIncident { .. })));
    harness.session(&with_slip());
    let suspected = incident(&harness);
    assert_eq!(
        (suspected.number, suspected.phase),
        (1, IncidentPhase::Suspected)
    );
    assert_eq!(suspected.evidence.len(), 1);
    let mut harness = harness.restart(3600.0);
    assert_eq!(incident(&harness), suspected);

    harness.session(&longer(&later(seconds(120, 180), 7200.0), ELBOW, SLIP_RAD));
    let confirmed = incident(&harness);
    assert_eq!(
        (confirmed.number, confirmed.phase),
        (1, IncidentPhase::Confirmed)
    );
    assert_eq!(confirmed.evidence.len(), 2);
    assert!(confirmed.evidence[1].probability >= 0.95, "{confirmed:?}");
    let sum: f64 = confirmed.causes.iter().map(|one| one.probability).sum();
    assert!((sum - 1.0).abs() < 1e-12, "{confirmed:?}");

    let alarm = AlarmKey {
        joint: Some("elbow".into()),
        condition: Condition::StepChange,
    };
    harness
        .command(CommandKind::Acknowledge { alarm }, "")
        .unwrap();
    // A slipped clamp needs a repair.
    harness
        .command(found(Finding::ClampSlip), "M4 loose")
        .unwrap();
    assert_eq!(incident(&harness).phase, IncidentPhase::Acknowledged);
    let joints = vec!["elbow".to_string()];
    harness
        .command(CommandKind::Tensioned { joints }, "")
        .unwrap();
    let closed = incident(&harness);
    assert_eq!(
        (closed.phase, closed.finding),
        (IncidentPhase::Closed, Some(Finding::ClampSlip))
    );
    assert_eq!(closed.note, "M4 loose");
    let expected = [
        IncidentPhase::Suspected,
        IncidentPhase::Confirmed,
        IncidentPhase::Acknowledged,
        IncidentPhase::Acknowledged,
        IncidentPhase::Closed,
    ];
    assert_eq!(phases(&harness), expected);
    assert_eq!(state(&harness, Condition::StepChange), None);
}

#[test]
fn finding_of_nothing_closes_suspected_change() {
    let mut harness = Harness::new(tensioned());
    harness.session(&with_slip());
    harness.command(found(Finding::Nothing), "").unwrap();
    assert_eq!(state(&harness, Condition::SuspectedStep), None);
    harness.session(&longer(seconds(120, 180), ELBOW, SLIP_RAD));
    assert_eq!(state(&harness, Condition::StepChange), None);
    assert_eq!(state(&harness, Condition::SuspectedStep), None);
    assert_eq!(
        phases(&harness),
        [IncidentPhase::Suspected, IncidentPhase::Closed]
    );
}

/// A suspected slip that the inspection confirms needs no further session, and one that it finds to be a strand failure
/// has the alarm of a strand failure only.
#[test]
fn finding_decides_on_causes_and_alarms() {
    for (finding, cause, condition) in [
        (
            Finding::StrandFailure,
            IncidentCause::StrandFailure,
            Condition::StrandFailure,
        ),
        (
            Finding::ClampSlip,
            IncidentCause::Slip,
            Condition::StepChange,
        ),
    ] {
        let mut harness = Harness::new(tensioned());
        harness.session(&with_slip());
        let before = incident(&harness);
        assert!(before.causes.len() > 1, "{before:?}");
        harness.command(found(finding), "").unwrap();
        let after = incident(&harness);
        let causes: Vec<_> = after
            .causes
            .iter()
            .map(|c| (c.cause, c.probability))
            .collect();
        assert_eq!(causes, [(cause, 1.0)]);
        assert_eq!(after.phase, IncidentPhase::Acknowledged);
        let mut alarms = harness.snapshot().alarms;
        alarms.retain(|alarm| alarm.key.condition.is_change());
        let [alarm] = &alarms[..] else {
            panic!("{alarms:?}");
        };
        assert_eq!(
            (alarm.key.condition, alarm.state),
            (condition, AlarmState::Latched)
        );
        // A later session adds no suspected change.
        harness.session(&longer(seconds(120, 180), ELBOW, SLIP_RAD));
        assert_eq!(state(&harness, Condition::SuspectedStep), None);
    }
}

/// A repair that was recorded by mistake does not end the alarm of a change.
#[test]
fn withdrawn_repair_restores_alarm_and_incident() {
    let mut harness = Harness::new(tensioned());
    harness.session(&with_slip());
    harness.session(&longer(seconds(120, 180), ELBOW, SLIP_RAD));
    let confirmed = incident(&harness);
    let joints = vec!["elbow".to_string()];
    harness
        .command(CommandKind::Tensioned { joints }, "")
        .unwrap();
    assert_eq!(state(&harness, Condition::StepChange), None);
    assert_eq!(incident(&harness).phase, IncidentPhase::Repaired);
    harness
        .command(CommandKind::Withdraw { entry: 1 }, "wrong arm")
        .unwrap();
    assert_eq!(
        state(&harness, Condition::StepChange),
        Some(AlarmState::Latched)
    );
    assert_eq!(incident(&harness), confirmed);
}

#[test]
fn step_while_off_needs_second_session() {
    let mut harness = Harness::new(tensioned());
    harness.session(seconds(60, 120));
    let mut harness = harness.restart(3600.0);
    harness.session(&longer(&later(seconds(120, 180), 7200.0), ELBOW, SLIP_RAD));
    assert_eq!(
        state(&harness, Condition::SuspectedStep),
        Some(AlarmState::Active)
    );
    let text = serde_json::to_string(&harness.snapshot().alarms).unwrap();
    assert!(text.contains("while-off"), "{text}");
    harness.session(&longer(&later(seconds(180, 240), 7200.0), ELBOW, SLIP_RAD));
    assert_eq!(
        state(&harness, Condition::StepChange),
        Some(AlarmState::Latched)
    );
}

#[test]
fn offset_decrease_is_reported_as_retensioning() {
    let mut harness = Harness::new(tensioned());
    harness.session(&longer(seconds(60, 120), ELBOW, 9e-3));
    harness.session(seconds(120, 180));
    let text = serde_json::to_string(&harness.snapshot().alarms).unwrap();
    assert!(text.contains("retensioned"), "{text}");
    // After the operator records the re-tensioning, only the earlier elongation remains.
    let elbow = vec!["elbow".to_string()];
    harness
        .command(CommandKind::Tensioned { joints: elbow }, "")
        .unwrap();
    assert_eq!(state(&harness, Condition::SuspectedStep), None);
    let state = harness.store.stored.state.as_ref().unwrap();
    let before = state.tendons[ELBOW].before_m;
    assert!(
        (before.mean - 9e-3 * 0.025).abs() < 3.0 * before.std,
        "{before:?}"
    );
}

#[test]
fn creep_is_not_a_step() {
    let mut harness = Harness::new(tensioned());
    for k in 0..6 {
        let from = 60 + 30 * (k % 5);
        let crept = longer(seconds(from, from + 30), ELBOW, 0.4e-3 * k as f64);
        harness.session(&crept);
        harness.pass(3600.0);
    }
    assert_eq!(state(&harness, Condition::SuspectedStep), None);
    assert_eq!(state(&harness, Condition::StepChange), None);
}
