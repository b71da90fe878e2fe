//! Detection of invalid data.

use crate::support::{HZ, Harness, longer, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmCause, AlarmState, Condition, DataFault, Level};
use sinew_watch_core::journal::Event;

const ELBOW: usize = 2;
const WRIST: usize = 3;

/// Reported data fault of the robot or of a joint.
fn data_fault(harness: &Harness, joint: Option<&str>) -> Option<DataFault> {
    let alarms = harness.snapshot().alarms;
    let data = alarms.into_iter().find(|alarm| {
        alarm.key.joint.as_deref() == joint && alarm.key.condition == Condition::Data
    })?;
    match data.cause {
        AlarmCause::Data { trouble: fault } => Some(fault),
        other => panic!("{other:?}"),
    }
}

/// 40 s of work with each frame modified.
fn corrupted(corrupt: impl Fn(usize, &mut Frame)) -> Harness {
    let mut harness = Harness::new(tensioned());
    let mut frames = seconds(60, 100).to_vec();
    for (k, frame) in frames.iter_mut().enumerate() {
        corrupt(k, frame);
    }
    harness.play(&frames);
    harness
}

#[test]
fn valid_data_raise_no_alarm() {
    let harness = corrupted(|_, _| {});
    assert!(
        harness.snapshot().alarms.is_empty(),
        "{:?}",
        harness.snapshot().alarms
    );
    assert!((harness.snapshot().rate_hz - 250.0).abs() < 5.0);
    assert_eq!(harness.snapshot().tendons[0].level, Level::Ok);
}

#[test]
fn data_faults_are_identified() {
    let harness = corrupted(|_, frame| frame.theta[ELBOW] = f64::NAN);
    let missing = DataFault::Missing {
        joint: "elbow".into(),
        motor: true,
    };
    assert_eq!(data_fault(&harness, None), Some(missing));

    let harness = corrupted(|k, frame| {
        if k % 10 == 0 {
            frame.q[0] = f64::NAN;
        }
    });
    let Some(DataFault::NotFinite { share }) = data_fault(&harness, None) else {
        panic!("{:?}", data_fault(&harness, None));
    };
    assert!((share - 0.1).abs() < 0.01, "{share}");

    let harness = corrupted(|_, frame| frame.theta.swap(ELBOW, WRIST));
    let with = |joint: &str| Some(DataFault::Swapped { with: joint.into() });
    assert_eq!(data_fault(&harness, Some("elbow")), with("wrist"));
    assert_eq!(data_fault(&harness, Some("wrist")), with("elbow"));
    assert_eq!(data_fault(&harness, Some("shoulder_yaw")), None);

    let harness = corrupted(|_, frame| frame.theta[ELBOW] = frame.theta[ELBOW].to_degrees());
    assert!(matches!(
        data_fault(&harness, Some("elbow")),
        Some(DataFault::FarApart { .. })
    ));

    let harness = corrupted(|_, frame| frame.theta[ELBOW] = frame.q[ELBOW] + 0.01);
    assert_eq!(
        data_fault(&harness, Some("elbow")),
        Some(DataFault::OneSignal)
    );
    assert_eq!(data_fault(&harness, Some("wrist")), None);

    let harness = corrupted(|_, frame| frame.theta[ELBOW] = 0.7);
    assert_eq!(
        data_fault(&harness, Some("elbow")),
        Some(DataFault::Dead { motor: true })
    );
    let harness = corrupted(|_, frame| frame.q[ELBOW] = 0.7);
    assert_eq!(
        data_fault(&harness, Some("elbow")),
        Some(DataFault::Dead { motor: false })
    );
}

#[test]
fn dropped_frames_above_limit_raise_alarm() {
    let mut harness = Harness::new(tensioned());
    for second in seconds(60, 110).chunks(HZ) {
        harness.play(second);
        harness.now = harness.now.after_s(0.004);
        harness.monitor.dropped(25, harness.now);
    }
    let Some(DataFault::Lost { share }) = data_fault(&harness, None) else {
        panic!("{:?}", data_fault(&harness, None));
    };
    assert!((share - 25.0 / 275.0).abs() < 0.02, "{share}");
    harness.pass(130.0);
    let shown = harness.snapshot().frames_lost;
    let reported = harness.store.events(|event| match event {
        Event::Dropped { messages } => Some(*messages),
        _ => None,
    });
    assert!(
        reported.len() <= 3 && reported.iter().sum::<u64>() == 50 * 25,
        "{reported:?}"
    );
    assert_eq!(shown, 50 * 25);
    // A session ends with its last block; later dropped messages do not belong to it.
    assert_eq!(harness.last("elbow").frames_lost, 49 * 25);
}

#[test]
fn transport_fault_has_priority_and_clears() {
    let mut harness = corrupted(|_, frame| frame.theta[ELBOW] = f64::NAN);
    let qos = DataFault::Qos {
        topic: "/joint_states".into(),
        offered: "best effort".into(),
        requested: "reliable".into(),
    };
    harness
        .monitor
        .transport_faults(std::slice::from_ref(&qos), harness.now);
    harness.pass(3.0);
    // The alarm is active already, and shows its newest cause.
    assert_eq!(data_fault(&harness, None), Some(qos.clone()));
    let mut harness = Harness::new(tensioned());
    harness
        .monitor
        .transport_faults(std::slice::from_ref(&qos), harness.now);
    harness.pass(20.0);
    assert_eq!(data_fault(&harness, None), Some(qos));
    harness.monitor.transport_faults(&[], harness.now);
    harness.pass(70.0);
    assert_eq!(
        harness.alarm(None, Condition::Data),
        Some(AlarmState::Cleared)
    );
}

#[test]
fn unmodelled_segment_gives_no_or_wide_offset() {
    // The motor position is noise.
    let mut harness =
        corrupted(|k, frame| frame.theta[ELBOW] += 0.05 * (k as f64 * 0.7).sin().signum());
    harness.pass(70.0);
    let record = harness.last("elbow");
    let wide = record
        .offset()
        .is_none_or(|x| x.mean.abs() < x.half_width_95());
    assert!(wide, "{record:?}");
    let _other = longer(&[], 0, 0.0);
}

#[test]
fn disconnected_transport_raises_and_clears_alarm() {
    let mut harness = Harness::new(tensioned());
    let reason = ("dds:0", "interface 192.0.2.7 cannot be used");
    harness.monitor.transport(Some(reason), harness.now);
    harness.pass(4.0);
    assert_eq!(harness.alarm(None, Condition::Transport), None);
    harness.pass(60.0);
    let state = harness.alarm(None, Condition::Transport);
    assert_eq!(state, Some(AlarmState::Active));
    let robot = harness.snapshot();
    // The disconnected transport precedes missing data, because the robot may be running.
    assert_eq!(robot.alarms[0].key.condition, Condition::Transport);
    assert_eq!(robot.level, Level::Error);
    assert!(
        matches!(&robot.alarms[0].cause, AlarmCause::Transport { transport, reason } if transport == "dds:0" && reason.contains("192.0.2.7"))
    );
    harness.monitor.transport(None, harness.now);
    harness.pass(3.0);
    assert_eq!(harness.alarm(None, Condition::Transport), None);
}
