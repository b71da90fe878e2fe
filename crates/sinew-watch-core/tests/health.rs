//! Data that can't be what they should are named.

use crate::support::{HZ, Watched, longer, seconds, tensioned};
use sinew_log::Frame;
use sinew_watch_core::alarm::{AlarmCause, AlarmState, Condition, Level, Trouble};
use sinew_watch_core::journal::Event;

const ELBOW: usize = 2;
const WRIST: usize = 3;

/// What is said of the data, of the robot or a joint.
fn trouble(watched: &Watched, joint: Option<&str>) -> Option<Trouble> {
    let alarms = watched.snapshot().alarms;
    let data = alarms.into_iter().find(|alarm| {
        alarm.key.joint.as_deref() == joint && alarm.key.condition == Condition::Data
    })?;
    match data.cause {
        AlarmCause::Data { trouble } => Some(trouble),
        other => panic!("{other:?}"),
    }
}

/// Half a minute of work, changed frame by frame.
fn spoilt(spoil: impl Fn(usize, &mut Frame)) -> Watched {
    let mut watched = Watched::new(tensioned());
    let mut frames = seconds(60, 100).to_vec();
    for (k, frame) in frames.iter_mut().enumerate() {
        spoil(k, frame);
    }
    watched.play(&frames);
    watched
}

#[test]
fn good_data_are_no_trouble() {
    let watched = spoilt(|_, _| {});
    assert!(
        watched.snapshot().alarms.is_empty(),
        "{:?}",
        watched.snapshot().alarms
    );
    assert!((watched.snapshot().rate_hz - 250.0).abs() < 5.0);
    assert_eq!(watched.snapshot().tendons[0].level, Level::Ok);
}

#[test]
fn every_trouble_is_named() {
    let watched = spoilt(|_, frame| frame.theta[ELBOW] = f64::NAN);
    let missing = Trouble::Missing {
        joint: "elbow".into(),
        motor: true,
    };
    assert_eq!(trouble(&watched, None), Some(missing));

    let watched = spoilt(|k, frame| {
        if k % 10 == 0 {
            frame.q[0] = f64::NAN;
        }
    });
    let Some(Trouble::NotFinite { share }) = trouble(&watched, None) else {
        panic!("{:?}", trouble(&watched, None));
    };
    assert!((share - 0.1).abs() < 0.01, "{share}");

    let watched = spoilt(|_, frame| frame.theta.swap(ELBOW, WRIST));
    let with = |joint: &str| Some(Trouble::Swapped { with: joint.into() });
    assert_eq!(trouble(&watched, Some("elbow")), with("wrist"));
    assert_eq!(trouble(&watched, Some("wrist")), with("elbow"));
    assert_eq!(trouble(&watched, Some("shoulder_yaw")), None);

    let watched = spoilt(|_, frame| frame.theta[ELBOW] = frame.theta[ELBOW].to_degrees());
    assert!(matches!(
        trouble(&watched, Some("elbow")),
        Some(Trouble::FarApart { .. })
    ));

    let watched = spoilt(|_, frame| frame.theta[ELBOW] = frame.q[ELBOW] + 0.01);
    assert_eq!(trouble(&watched, Some("elbow")), Some(Trouble::OneSignal));
    assert_eq!(trouble(&watched, Some("wrist")), None);

    let watched = spoilt(|_, frame| frame.theta[ELBOW] = 0.7);
    assert_eq!(
        trouble(&watched, Some("elbow")),
        Some(Trouble::Dead { motor: true })
    );
    let watched = spoilt(|_, frame| frame.q[ELBOW] = 0.7);
    assert_eq!(
        trouble(&watched, Some("elbow")),
        Some(Trouble::Dead { motor: false })
    );
}

#[test]
fn what_is_dropped_is_counted_told_and_an_alarm_where_it_is_much() {
    let mut watched = Watched::new(tensioned());
    for second in seconds(60, 110).chunks(HZ) {
        watched.play(second);
        watched.now = watched.now.after_s(0.004);
        watched.monitor.dropped(25, watched.now);
    }
    let Some(Trouble::Lost { share }) = trouble(&watched, None) else {
        panic!("{:?}", trouble(&watched, None));
    };
    assert!((share - 25.0 / 275.0).abs() < 0.02, "{share}");
    watched.pass(130.0);
    let shown = watched.snapshot().frames_lost;
    let told = watched.store.events(|event| match event {
        Event::Dropped { messages } => Some(*messages),
        _ => None,
    });
    assert!(
        told.len() <= 3 && told.iter().sum::<u64>() == 50 * 25,
        "{told:?}"
    );
    assert_eq!(shown, 50 * 25);
    // A session ends with its last block: what was dropped after it is no part of it.
    assert_eq!(watched.last("elbow").frames_lost, 49 * 25);
}

#[test]
fn what_a_door_can_t_receive_comes_first_and_goes_with_it() {
    let mut watched = spoilt(|_, frame| frame.theta[ELBOW] = f64::NAN);
    let qos = Trouble::Qos {
        topic: "/joint_states".into(),
        offered: "best effort".into(),
        requested: "reliable".into(),
    };
    watched
        .monitor
        .troubles(std::slice::from_ref(&qos), watched.now);
    watched.pass(3.0);
    // The alarm is there already: its cause is what raised it.
    assert!(matches!(
        trouble(&watched, None),
        Some(Trouble::Missing { .. })
    ));
    let mut watched = Watched::new(tensioned());
    watched
        .monitor
        .troubles(std::slice::from_ref(&qos), watched.now);
    watched.pass(20.0);
    assert_eq!(trouble(&watched, None), Some(qos));
    watched.monitor.troubles(&[], watched.now);
    watched.pass(70.0);
    assert_eq!(
        watched.alarm(None, Condition::Data),
        Some(AlarmState::Cleared)
    );
}

#[test]
fn a_stretch_that_never_fits_is_a_record_without_an_offset_or_a_wide_one() {
    // A motor that follows nothing: its readings are noise.
    let mut watched =
        spoilt(|k, frame| frame.theta[ELBOW] += 0.05 * (k as f64 * 0.7).sin().signum());
    watched.pass(70.0);
    let record = watched.last("elbow");
    let wide = record
        .offset()
        .is_none_or(|x| x.mean.abs() < x.half_width_95());
    assert!(wide, "{record:?}");
    let _other = longer(&[], 0, 0.0);
}

#[test]
fn a_door_that_is_shut_is_a_fault_of_its_own_and_over_when_it_opens() {
    let mut watched = Watched::new(tensioned());
    let why = ("dds:0", "interface 192.0.2.7 can't be used");
    watched.monitor.door(Some(why), watched.now);
    watched.pass(4.0);
    assert_eq!(watched.alarm(None, Condition::Door), None);
    watched.pass(60.0);
    let state = watched.alarm(None, Condition::Door);
    assert_eq!(state, Some(AlarmState::Active));
    let robot = watched.snapshot();
    // The robot may well run: what is said first is that the monitor is deaf, not that the robot is silent.
    assert_eq!(robot.alarms[0].key.condition, Condition::Door);
    assert_eq!(robot.level, Level::Error);
    assert!(
        matches!(&robot.alarms[0].cause, AlarmCause::Door { door, why } if door == "dds:0" && why.contains("192.0.2.7"))
    );
    watched.monitor.door(None, watched.now);
    watched.pass(3.0);
    assert_eq!(watched.alarm(None, Condition::Door), None);
}
