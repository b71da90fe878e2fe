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
    bag.channel(JOINT, "sensor_msgs/msg/JointState", "ros1");
    bag.raw(JOINT, b"whatever");
    let error = error_of(&bag.bytes(), "a.mcap", &OpenOptions::default());
    assert!(error.contains("encoded as 'ros1'"), "{error}");
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
