//! Payloads that are wrong in themselves.

use crate::support::*;
use sinew_log::OpenOptions;

#[test]
fn both_byte_orders_and_a_change_between_them() {
    let mut bag = Bag::new();
    for step in 0..10 {
        let message = joint_state(START_NS + 10 * step * MS, &[("a", 1.0), ("bb", 2.0)]);
        let payload = if step % 2 == 0 {
            big(&message)
        } else {
            little(&message)
        };
        bag.raw(JOINT, &payload);
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 10);
    assert!(frames.iter().all(|frame| frame.q == [1.0, 2.0]));
    assert_eq!(health.undecodable, 0);
}

#[test]
fn publisher_change_of_order_and_length_is_handled() {
    let mut bag = Bag::new();
    for step in 0..30 {
        let time = START_NS + 10 * step * MS;
        match step % 3 {
            0 => bag.joint(time, &[("a", 1.0), ("b", 2.0), ("c", 3.0)]),
            1 => bag.joint(time, &[("c", 3.0), ("b", 2.0), ("a", 1.0)]),
            _ => bag.joint(time, &[("b", 2.0)]),
        };
    }
    let (frames, _) = read_bytes(&bag.bytes(), "a.mcap");
    for (step, frame) in frames.iter().enumerate() {
        if step % 3 < 2 {
            assert_eq!(frame.q, [1.0, 2.0, 3.0]);
        } else {
            assert!(frame.q[0].is_nan() && frame.q[1] == 2.0 && frame.q[2].is_nan());
        }
    }
}

#[test]
fn fewer_positions_than_names() {
    let mut bag = Bag::new();
    let mut message = joint_state(START_NS, &[("a", 1.0), ("b", 2.0), ("c", 3.0)]);
    message.position.truncate(2);
    bag.raw(JOINT, &little(&message));
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames[0].q[..2], [1.0, 2.0]);
    assert_eq!(health.short_messages, 1);
}

#[test]
fn surplus_positions_and_duplicate_names_are_ignored() {
    let mut bag = Bag::new();
    let mut message = joint_state(START_NS, &[("a", 1.0), ("b", 2.0), ("a", 9.0)]);
    message.position.push(4.0);
    bag.raw(JOINT, &little(&message));
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames[0].q, [1.0, 2.0]);
    assert_eq!(health.undecodable, 0);
}

#[test]
fn lengths_inside_a_message_that_lie() {
    let sound = little(&joint_state(START_NS, &[("a", 1.0), ("b", 2.0)]));
    let mut bag = Bag::new();
    bag.raw(JOINT, &sound);
    let mut written = 1;
    for at in 12..sound.len() - 4 {
        for length in [u32::MAX, i32::MAX as u32, 1 << 28, 1 << 16] {
            let mut payload = sound.clone();
            payload[at..at + 4].copy_from_slice(&length.to_le_bytes());
            bag.raw(JOINT, &payload);
            written += 1;
        }
    }
    for length in 0..sound.len() {
        bag.raw(JOINT, &sound[..length]);
        written += 1;
    }
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert!(!frames.is_empty());
    assert_eq!(health.messages, written);
    assert!(health.undecodable > 50, "{}", health.undecodable);
    assert!(!health.is_damaged() && health.is_lossy());
    // Only the first few are described individually.
    assert!(health.events.len() < 40);
}

#[test]
fn malformed_motor_side_is_handled() {
    let sound = little(&motor_state(START_NS, &[("a", 1.0), ("b", 2.0)]));
    let mut bag = Bag::new();
    bag.joint(START_NS, &[("a", 0.0), ("b", 0.0)]);
    bag.raw(MOTOR, &sound);
    for at in 12..sound.len() - 4 {
        for length in [u32::MAX, 1 << 28, 3] {
            let mut payload = sound.clone();
            payload[at..at + 4].copy_from_slice(&length.to_le_bytes());
            bag.raw(MOTOR, &payload);
        }
    }
    // Names that were overwritten are names all the same: the joints meant are selected.
    let mut recording = open_bytes(&bag.bytes(), "a.mcap", &OpenOptions::default()).unwrap();
    recording.select(&["a", "b"]).unwrap();
    let (frames, health) = read_all(recording);
    assert_eq!(frames[0].theta, [1.0, 2.0]);
    assert!(health.undecodable > 50);
}

#[test]
fn unsupported_representation_skips_message() {
    let mut bag = Bag::new();
    let mut payload = little(&joint_state(START_NS, &[("a", 1.0)]));
    bag.raw(JOINT, &payload);
    payload[1] = 7; // XCDR2
    bag.raw(JOINT, &payload);
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 1);
    assert_eq!(health.undecodable, 1);
    assert!(
        health.events[0].text.contains("0x07"),
        "{:?}",
        health.events
    );
}

#[test]
fn unsupported_message_encoding_is_error() {
    let mut bag = Bag::new();
    bag.channel(JOINT, "sensor_msgs/msg/JointState", "json");
    bag.raw(JOINT, b"whatever");
    let error = error_of(&bag.bytes(), "a.mcap", &OpenOptions::default());
    assert!(error.contains("encoded as 'json'"), "{error}");
    assert!(error.contains("rosbags-convert"), "{error}");
}

/// A joint state as ROS 1 writes it.
fn ros1_joint_state(time_ns: i64, joints: &[(&str, f64)]) -> Vec<u8> {
    let word = |value: usize| (value as u32).to_le_bytes();
    let text = |text: &str| [&word(text.len()), text.as_bytes()].concat();
    let mut bytes = Vec::new();
    bytes.extend(word(5));
    bytes.extend(word((time_ns / 1_000_000_000) as usize));
    bytes.extend(word((time_ns % 1_000_000_000) as usize));
    bytes.extend(text("base"));
    bytes.extend(word(joints.len()));
    bytes.extend(joints.iter().flat_map(|(name, _)| text(name)));
    bytes.extend(word(joints.len()));
    bytes.extend(
        joints
            .iter()
            .flat_map(|(_, position)| position.to_le_bytes()),
    );
    bytes.extend([word(0), word(0)].concat());
    bytes
}

#[test]
fn ros1_joint_states_are_converted() {
    const MOTORS: &str = "/motor_states";
    let mut bag = Bag::new();
    for topic in [JOINT, MOTORS] {
        bag.channel(topic, "sensor_msgs/JointState", "ros1");
    }
    for step in 0..50 {
        let time_ns = START_NS + 10 * MS * step;
        let q = 0.01 * step as f64;
        // Names whose lengths are no multiples of 4, so that CDR needs bytes of alignment that ROS 1 has not.
        bag.raw(JOINT, &ros1_joint_state(time_ns, &[("tilt", q), ("a", -q)]));
        bag.raw(
            MOTORS,
            &ros1_joint_state(time_ns, &[("tilt", q + 0.004), ("a", 0.0)]),
        );
    }
    bag.raw(JOINT, b"cut");
    let (frames, health) = read_bytes(&bag.bytes(), "a.mcap");
    assert_eq!(frames.len(), 50);
    let last = &frames[49];
    assert_eq!(last.time_ns, START_NS + 490 * MS);
    assert_eq!((last.q[0], last.q[1]), (0.49, -0.49));
    assert!((last.theta[0] - last.q[0] - 0.004).abs() < 1e-15);
    assert_eq!(health.undecodable, 1, "{health:?}");
}

#[test]
fn topics_that_could_all_be_the_joint_side() {
    let mut bag = Bag::new();
    for topic in ["/left/joint_states", "/right/joint_states"] {
        bag.raw(topic, &little(&joint_state(START_NS, &[("a", 1.0)])));
    }
    let bytes = bag.bytes();
    let error = error_of(&bytes, "a.mcap", &OpenOptions::default());
    assert!(
        error.contains("'/left/joint_states', '/right/joint_states'"),
        "{error}"
    );
    let options = OpenOptions {
        joint_state_topic: Some("/left/joint_states".to_owned()),
        ..OpenOptions::default()
    };
    assert_eq!(
        read_all(open_bytes(&bytes, "a.mcap", &options).unwrap())
            .0
            .len(),
        1
    );
}

#[test]
fn missing_joint_error_suggests_nearest() {
    let mut bag = Bag::new();
    bag.joint(START_NS, &[("shoulder", 1.0), ("elbow", 2.0)]);
    let mut recording = open_bytes(&bag.bytes(), "a.mcap", &OpenOptions::default()).unwrap();
    let error = recording.select(&["elbwo"]).unwrap_err().to_string();
    assert!(
        error.contains("did you mean 'elbow'?") && error.contains("'shoulder'"),
        "{error}"
    );
    let error = recording
        .select(&["elbow", "elbow"])
        .unwrap_err()
        .to_string();
    assert!(error.contains("twice"), "{error}");
    recording.next_frame().unwrap();
    assert!(recording.select(&["elbow"]).is_err());
}

#[test]
fn empty_joint_state_has_no_joint() {
    let mut bag = Bag::new();
    bag.joint(START_NS, &[]);
    let (frames, _) = read_bytes(&bag.bytes(), "a.mcap");
    assert!(frames.is_empty());
}
