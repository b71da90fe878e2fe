//! Online assembly gives frames bitwise identical to those of a reader.

use crate::support::*;
use mcap::MessageStream;
use sinew_log::live::{Live, LiveOptions, TopicDiscovery};
use sinew_log::{Frame, Health, OpenOptions, OwnedAxis, Quantity, Recording};
use std::io::Cursor;
use std::path::Path;

/// Pushes every message of an MCAP file in order through the online assembly.
pub(crate) fn pushed(bytes: &[u8], options: &LiveOptions) -> (Vec<Frame>, Health) {
    let mut live = Live::new(options).unwrap();
    let messages: Vec<_> = MessageStream::new(bytes)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let mut frames = Vec::new();
    // As a network does, every topic is announced before its first message; all of them, so that
    // the choice is that of the whole recording.
    for message in &messages {
        let schema = message.channel.schema.as_ref().map_or("", |s| &s.name);
        live.topic(&message.channel.topic, schema);
    }
    for message in &messages {
        let schema = message.channel.schema.as_ref().map_or("", |s| &s.name);
        let Some(topic) = live.topic(&message.channel.topic, schema) else {
            continue;
        };
        let received_ns = i64::try_from(message.log_time).unwrap_or(i64::MAX);
        live.push(topic, &message.data, received_ns);
        while let Some(frame) = live.frame() {
            frames.push(frame.clone());
        }
    }
    live.silence();
    while let Some(frame) = live.frame() {
        frames.push(frame.clone());
    }
    (frames, live.health())
}

fn bits(frame: &Frame) -> (i64, u32, Vec<u64>) {
    let quantities = Quantity::PER_JOINT.into_iter();
    let all = quantities.chain([Quantity::Temperature]);
    let values = all.flat_map(|q| frame.get(q).iter().map(|v| v.to_bits()).collect::<Vec<_>>());
    (frame.time_ns, frame.segment, values.collect())
}

/// Compares both results: every bit of every frame, and the counts. The time is compared up to a step of the clock,
/// over which it continues in a recording only.
#[track_caller]
fn agree(bytes: &[u8], options: &OpenOptions) -> Vec<Frame> {
    let open = || {
        let reader = Box::new(Cursor::new(bytes.to_vec()));
        Recording::from_reader(reader, "a.mcap", options).unwrap()
    };
    let joints = open().joints().to_vec();
    let (read, health) = read_all(open());
    let watched = LiveOptions {
        open: options.clone(),
        ..LiveOptions::of_joints(&joints)
    };
    let (live, mut live_health) = pushed(bytes, &watched);
    assert_eq!(read.len(), live.len());
    for (read, live) in read.iter().zip(&live) {
        let (mut read, live) = (bits(read), bits(live));
        if health.clock_steps > 0 && live.1 > 0 {
            read.0 = live.0;
        }
        assert_eq!(read, live);
    }
    // Online, a joint that is not monitored is unknown; in a recording, one that appeared late.
    live_health
        .unknown_joints
        .clone_from(&health.unknown_joints);
    assert_eq!(health, live_health);
    live
}

fn example(path: &str) -> Vec<u8> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    std::fs::read(root.join(path)).unwrap()
}

#[test]
fn shipped_example_is_identical_online() {
    let bytes = example("examples/01-stretched-arm/stretched-arm.mcap");
    let frames = agree(&bytes, &OpenOptions::default());
    assert!(frames.len() > 1_000, "{} frames", frames.len());
}

#[test]
fn recordings_of_another_writer_are_the_same_live() {
    for name in ["rosbags.mcap", "rosbags_bare.mcap"] {
        let bytes = example(&format!("crates/sinew-log/tests/data/{name}"));
        agree(&bytes, &OpenOptions::default());
    }
}

/// Joint side at 1 kHz, motor side by `motor`; time stamps by `time` of the step.
fn run(
    steps: std::ops::Range<i64>,
    time: impl Fn(i64) -> i64,
    motor: impl Fn(i64, i64, &mut Bag),
) -> Vec<u8> {
    let mut bag = Bag::new();
    for step in steps {
        let at = time(step);
        let q = (0.001 * step as f64).sin();
        motor(step, at, &mut bag);
        bag.joint(at, &[("a", q), ("b", 2.0 * q)]);
    }
    bag.bytes()
}

fn both(step: i64, at: i64, bag: &mut Bag) {
    let q = (0.001 * step as f64).sin();
    bag.motor(at, &[("b", 2.1 * q), ("a", 1.1 * q)]);
}

#[test]
fn split_topics_delays_gaps_and_clock_steps_match_reader() {
    let plain = |step: i64| START_NS + step * MS;
    // Each motor on its own, at other times.
    let split = run(0..2_000, plain, |step, at, bag| {
        bag.motor(at - MS / 3, &[("a", 0.1 * step as f64)]);
        bag.motor(at + MS / 4, &[("b", 0.2 * step as f64)]);
    });
    agree(&split, &OpenOptions::default());
    // The motor side comes 40 ms later than it is stamped, and a third as often.
    let late = run(0..2_000, plain, |step, at, bag| {
        if step % 3 == 0 && step >= 40 {
            both(step - 40, at - 40 * MS, bag);
        }
    });
    agree(&late, &OpenOptions::default());
    // Pauses, a stamp from the future, stamps that go back by an hour, stamps of zero.
    let gaps = run(0..3_000, |s| plain(s + s / 1_000 * 2_500), both);
    assert_eq!(agree(&gaps, &OpenOptions::default())[2_999].segment, 2);
    let future = run(
        0..2_000,
        |s| plain(s) + i64::from(s == 900) * 86_400_000 * MS,
        both,
    );
    agree(&future, &OpenOptions::default());
    let back = run(
        0..2_000,
        |s| plain(s) - i64::from(s >= 900) * 3_600_000 * MS,
        both,
    );
    assert_eq!(agree(&back, &OpenOptions::default())[1_999].segment, 1);
    let zero = run(0..500, |_| 0, both);
    agree(&zero, &OpenOptions::default());
    // Out of order within the window, repeated, and too late.
    let unordered = run(
        0..2_000,
        |s| plain(if s % 7 == 0 { s - 3 } else { s } - i64::from(s == 1_500) * 900),
        both,
    );
    agree(&unordered, &OpenOptions::default());
    // The clock goes back in the middle and the motor side ends.
    let vanishes = run(0..3_000, plain, |step, at, bag| {
        if step < 1_500 {
            both(step, at, bag);
        }
    });
    let frames = agree(&vanishes, &OpenOptions::default());
    assert!(frames[1_499].theta[0].is_finite() && frames[1_600].theta[0].is_nan());
}

#[test]
fn publisher_may_change_order_and_bytes() {
    let mut bag = Bag::new();
    for step in 0..2_000_i64 {
        let (at, q) = (START_NS + step * MS, 0.001 * step as f64);
        let order = match step / 300 % 3 {
            0 => vec![("a", q), ("b", -q)],
            1 => vec![("b", -q), ("a", q)],
            _ => vec![("gripper", 9.0), ("b", -q), ("a", q)],
        };
        let message = joint_state(at, &order);
        let bytes = match step % 2 {
            0 => little(&message),
            _ => big(&message),
        };
        bag.raw(JOINT, &bytes);
    }
    let bytes = bag.bytes();
    let options = OpenOptions::default();
    let joints = ["a".to_owned(), "b".to_owned()];
    let watched = LiveOptions {
        open: options,
        ..LiveOptions::of_joints(&joints)
    };
    let (frames, health) = pushed(&bytes, &watched);
    assert_eq!(frames.len(), 2_000);
    for (step, frame) in frames.iter().enumerate() {
        let q = 0.001 * step as f64;
        assert_eq!(frame.q, [q, -q]);
    }
    assert_eq!(health.unknown_joints, ["gripper"]);
    let _ = options;
}

/// Message of the joint side, `namespace/joint_states`.
fn state(live: &mut Live, topic: &str, step: i64, q: f64) {
    let Some(id) = live.topic(topic, "sensor_msgs/msg/JointState") else {
        panic!("{topic} is of no use");
    };
    let at = START_NS + step * MS;
    live.push(id, &little(&joint_state(at, &[("a", q)])), at);
}

fn drain(live: &mut Live) -> Vec<Frame> {
    let mut frames = Vec::new();
    while let Some(frame) = live.frame() {
        frames.push(frame.clone());
    }
    frames
}

fn options(namespace: &str) -> LiveOptions {
    LiveOptions {
        namespace: namespace.to_owned(),
        ..LiveOptions::of_joints(&["a".to_owned()])
    }
}

#[test]
fn choice_does_not_depend_on_topic_order() {
    let state = "sensor_msgs/msg/JointState";
    let topics = [
        "/arm7/odd_states",
        "/arm7/joint_states",
        "/arm7/motor_states",
    ];
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let mut live = Live::new(&options("/arm7")).unwrap();
        for index in order {
            assert!(live.topic(topics[index], state).is_some());
        }
        let choice = live.choice();
        assert_eq!(choice.joint_side, Some("/arm7/joint_states"), "{order:?}");
        assert_eq!(choice.motor_side, Some("/arm7/motor_states"), "{order:?}");
        assert!(choice.ambiguous.is_empty());
    }
    let mut live = Live::new(&options("/arm7")).unwrap();
    for other in ["/arm70/joint_states", "/joint_states", "/arm8/joint_states"] {
        assert_eq!(live.topic(other, state), None);
    }
    assert!(live.topic("/arm7/one", state).is_some());
    assert_eq!(live.choice().joint_side, Some("/arm7/one"));
    assert!(live.topic("/arm7/two", state).is_some());
    assert_eq!(live.choice().joint_side, None);
    let candidates = &live.choice().ambiguous[0].candidates;
    assert_eq!(candidates, &["/arm7/one", "/arm7/two"]);
}

#[test]
fn appearing_motor_side_joins_and_is_waited_for() {
    let mut live = Live::new(&options("")).unwrap();
    let mut frames = Vec::new();
    for step in 0..2_000 {
        if step >= 1_000 {
            let motor = live.topic(MOTOR, "control_msgs/msg/DynamicJointState");
            let at = START_NS + step * MS;
            let bytes = little(&motor_state(at, &[("a", 0.5)]));
            live.push(motor.unwrap(), &bytes, at);
        }
        state(&mut live, JOINT, step, 0.25);
        frames.append(&mut drain(&mut live));
        if step == 999 {
            // Frames do not wait for a missing side.
            assert_eq!(frames.len(), 750);
        }
    }
    assert_eq!(frames.len(), 1_750);
    assert!(frames[..1_000].iter().all(|frame| frame.theta[0].is_nan()));
    assert!(frames[1_000..].iter().all(|frame| frame.theta == [0.5]));
    assert!(frames.iter().all(|frame| frame.segment == 0));
}

#[test]
fn silence_hands_out_what_is_held_and_begins_a_segment() {
    let mut live = Live::new(&options("")).unwrap();
    for step in 0..100 {
        state(&mut live, JOINT, step, 0.1);
    }
    assert!(live.frame().is_none());
    live.silence();
    assert_eq!(drain(&mut live).len(), 100);
    live.silence();
    // The next message waits again, and is of a new segment: less than a gap later.
    for step in 120..600 {
        state(&mut live, JOINT, step, 0.1);
    }
    let frames = drain(&mut live);
    assert_eq!(frames.len(), 230);
    assert!(frames.iter().all(|frame| frame.segment == 1));
    assert_eq!(live.health().gaps, 0);
}

#[test]
fn restarted_robot_begins_new_segment() {
    let mut live = Live::new(&options("")).unwrap();
    let mut frames = Vec::new();
    for step in (5_000..6_000).chain(0..1_000) {
        state(&mut live, JOINT, step, 0.1);
        frames.append(&mut drain(&mut live));
    }
    live.silence();
    frames.append(&mut drain(&mut live));
    assert_eq!(frames.len(), 2_000);
    assert_eq!((frames[999].segment, frames[1_000].segment), (0, 1));
    assert_eq!(live.health().clock_steps, 1);
    // Paused simulated time repeats its stamp: the first is kept.
    for _ in 0..500 {
        state(&mut live, JOINT, 999, 0.1);
    }
    live.silence();
    assert!(live.frame().is_none());
}

#[test]
fn descriptions_and_temperatures_are_taken() {
    let mut live = Live::new(&options("/arm7")).unwrap();
    let text = "std_msgs/msg/String";
    let id = live.topic("/arm7/robot_description", text).unwrap();
    assert_eq!(live.topic("/other/robot_description", text), None);
    assert_eq!(live.topic("/arm7/rosout", text), None);
    let urdf = |name: &str| {
        let text = format!("<robot name='{name}'/>");
        little(&(text,))
    };
    live.push(id, &urdf("one"), 1);
    live.push(id, &urdf("one"), 2);
    live.push(id, &[0, 1, 0, 0, 255, 255, 255, 255], 3);
    assert_eq!(live.descriptions(), 1);
    live.push(id, &urdf("two"), 4);
    assert_eq!(live.robot_description(), Some("<robot name='two'/>"));
    assert_eq!(live.descriptions(), 2);

    let motor = live.topic(
        "/arm7/dynamic_joint_states",
        "control_msgs/msg/DynamicJointState",
    );
    let message = DynamicJointState {
        header: header(START_NS),
        joint_names: vec!["a".to_owned()],
        interface_values: vec![InterfaceValue {
            interface_names: vec!["motor_position".to_owned(), "temperature".to_owned()],
            values: vec![0.5, 31.5],
        }],
    };
    live.push(motor.unwrap(), &little(&message), START_NS);
    state(&mut live, "/arm7/joint_states", 0, 0.25);
    live.silence();
    let frames = drain(&mut live);
    assert_eq!((frames[0].theta[0], frames[0].temperature_c), (0.5, 31.5));
    let came = live.channels();
    assert!(came.temperature && came.joints[0].theta && came.joints[0].q);
    let taken = |name: &str| {
        let topics = live.topics();
        let topic = topics.iter().find(|topic| topic.name == name).cloned();
        topic.unwrap()
    };
    let motor = taken("/arm7/dynamic_joint_states");
    assert_eq!(motor.interfaces, ["motor_position", "temperature"]);
    assert_eq!(live.sources().len(), 3);
}

#[test]
fn invalid_options_are_errors() {
    let error = |options: &LiveOptions| Live::new(options).unwrap_err().to_string();
    assert!(error(&LiveOptions::default()).contains("no joint"));
    let twice = LiveOptions::of_joints(&["a".to_owned(), "a".to_owned()]);
    assert!(error(&twice).contains("'a' is monitored twice"));
    let mut nameless = LiveOptions::of_joints(&["a".to_owned()]);
    nameless.axes.push(OwnedAxis::default());
    assert!(error(&nameless).contains("axis 1 has no name"));
    nameless.axes[0].joint = None;
    assert!(error(&nameless).contains("no joint"));
    let mut late = options("");
    late.open.reorder_s = f64::NAN;
    assert!(error(&late).contains("reorder_s"));
}

#[test]
fn topics_above_limit_are_rejected_and_counted() {
    let mut live = Live::new(&options("")).unwrap();
    for topic in 0..2_000 {
        live.topic(&format!("/t{topic}"), "sensor_msgs/msg/JointState");
    }
    assert_eq!(live.topics().len(), sinew_log::live::TOPICS_MOST);
    assert_eq!(live.topics_rejected(), 2_000 - 1_024);
}

#[test]
fn discovery_reports_robot_candidates() {
    let mut census = TopicDiscovery::default();
    let state = census.topic("/arm7/joint_states", "sensor_msgs/msg/JointState");
    let motor = census.topic(
        "/arm7/dynamic_joint_states",
        "control_msgs/msg/DynamicJointState",
    );
    let text = census.topic("/arm7/robot_description", "std_msgs/msg/String");
    census.topic("/tf", "tf2_msgs/msg/TFMessage");
    census.topic("/base/joint_states", "sensor_msgs/msg/JointState");
    for step in 0..11_i64 {
        let at = START_NS + step * 100 * MS;
        census.push(state.unwrap(), &little(&joint_state(at, &[("a", 1.0)])), at);
        census.push(motor.unwrap(), &little(&motor_state(at, &[("a", 1.0)])), at);
    }
    census.push(text.unwrap(), &little(&("<robot/>".to_owned(),)), START_NS);
    let robots = census.robots();
    assert_eq!(robots.len(), 2);
    let arm = &robots[0];
    assert_eq!(arm.namespace, "/arm7");
    assert_eq!(
        arm.motor_side.as_deref(),
        Some("/arm7/dynamic_joint_states")
    );
    assert_eq!(arm.joints[0].channels, [Quantity::Q, Quantity::Theta]);
    assert_eq!(arm.robot_description.as_deref(), Some("<robot/>"));
    assert_eq!(robots[1].motor_side, None);
    let topics = census.topics();
    assert_eq!(topics.len(), 5);
    let states = topics
        .iter()
        .find(|topic| topic.name == "/arm7/joint_states");
    assert!((states.unwrap().rate_hz.unwrap() - 10.0).abs() < 1e-9);
}
