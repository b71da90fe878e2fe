//! Messages in memory give the same frames as those of a file.

use crate::support::*;
use sinew_log::{Format, GivenMessages, OpenOptions, Recording};
use std::sync::Arc;

const KINDS: [(&str, &str); 2] = [
    (JOINT, "sensor_msgs/msg/JointState"),
    (MOTOR, "control_msgs/msg/DynamicJointState"),
];

/// Topic, recorder's clock, bytes; joint and motor side are 3 ms apart.
fn messages() -> Vec<(&'static str, u64, Vec<u8>)> {
    let mut all = Vec::new();
    for step in 0..600 {
        let time = START_NS + 10 * step * MS;
        let (q, theta) = (1e-3 * step as f64, 0.5 + 1e-3 * step as f64);
        let motor = little(&motor_state(time - 3 * MS, &[("a", theta)]));
        all.push((MOTOR, (time - 3 * MS) as u64, motor));
        all.push((JOINT, time as u64, little(&joint_state(time, &[("a", q)]))));
    }
    all
}

fn given() -> GivenMessages {
    let mut given = GivenMessages::default();
    let urdf = little(&"<robot name=\"arm\"/>".to_owned());
    let kind = "std_msgs/msg/String";
    given.push("/robot_description", kind, 1, &urdf).unwrap();
    for (topic, time, bytes) in messages() {
        let kind = KINDS.iter().find(|k| k.0 == topic).unwrap().1;
        given.push(topic, kind, time, &bytes).unwrap();
        let picture = [0; 64];
        given
            .push("/camera", "sensor_msgs/msg/Image", time, &picture)
            .unwrap();
    }
    given
}

#[test]
fn messages_give_the_frames_of_a_file_with_the_same_messages() {
    let mut bag = Bag::new();
    for (topic, time, bytes) in messages() {
        bag.log_at(time).raw(topic, &bytes);
    }
    let (of_file, file_health) = read_bytes(&bag.bytes(), "same.mcap");
    let given = Arc::new(given());
    // Pictures are not kept.
    assert_eq!(given.len(), 1201);
    let options = OpenOptions::default();
    let recording = Recording::from_messages(given, "messages", &options).unwrap();
    assert_eq!(recording.format(), Format::Messages);
    assert_eq!(recording.robot_description(), Some("<robot name=\"arm\"/>"));
    let names: Vec<_> = recording.topics().into_iter().map(|t| t.name).collect();
    assert_eq!(names, ["/camera", MOTOR, JOINT, "/robot_description"]);
    let (of_memory, health) = read_all(recording);
    assert_eq!(of_memory.len(), of_file.len());
    for (a, b) in of_memory.iter().zip(&of_file) {
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
    assert_eq!(health.streams, file_health.streams);
}

#[test]
fn topics_are_chosen_as_in_a_file() {
    let mut given = given();
    let bytes = little(&joint_state(START_NS, &[("a", 0.0)]));
    given
        .push("/more/joints", KINDS[0].1, START_NS as u64, &bytes)
        .unwrap();
    let options = OpenOptions {
        joint_state_topic: Some("/none".into()),
        ..OpenOptions::default()
    };
    let error = Recording::from_messages(Arc::new(given), "messages", &options).unwrap_err();
    assert!(error.to_string().contains("/none"), "{error}");
    let nothing = Arc::new(GivenMessages::default());
    let error = Recording::from_messages(nothing, "messages", &OpenOptions::default());
    let error = error.unwrap_err().to_string();
    assert!(error.starts_with("messages: not a recording"), "{error}");
}
