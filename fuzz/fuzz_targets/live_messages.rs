//! Any messages on any topics as they come live: no panic, no hang, frames in order, finite or NaN, memory bounded.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_log::Quantity;
use sinew_log::live::{Live, LiveOptions, TopicDiscovery};

/// Topics with their types: relevant, of another type, irrelevant.
const TOPICS: [(&str, &str); 8] = [
    ("/joint_states", "sensor_msgs/msg/JointState"),
    (
        "/dynamic_joint_states",
        "control_msgs/msg/DynamicJointState",
    ),
    ("/motor_states", "sensor_msgs/msg/JointState"),
    ("/external_joint_torques", "sensor_msgs/msg/JointState"),
    ("/robot_description", "std_msgs/msg/String"),
    ("/arm/robot_description", "std_msgs/msg/String"),
    ("/joint_states", "control_msgs/msg/DynamicJointState"),
    ("/tf", "tf2_msgs/msg/TFMessage"),
];

fuzz_target!(|bytes: &[u8]| {
    let joints = ["a", "b"].map(str::to_owned);
    let mut live = Live::new(&LiveOptions::of_joints(&joints)).expect("options as they come");
    let mut census = TopicDiscovery::default();
    let mut rest = bytes;
    let mut last = None;
    let mut received_ns = 0_i64;
    // A message: topic and what is done besides, time since the last one, length, payload.
    while let Some(([what, time, low, high], after)) = rest.split_first_chunk::<4>() {
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(after.len());
        let (payload, next) = after.split_at(length);
        rest = next;
        received_ns = received_ns.saturating_add(i64::from(*time) << 20);
        let (name, schema) = TOPICS[usize::from(what & 7)];
        if let Some(topic) = live.topic(name, schema) {
            live.push(topic, payload, received_ns);
        }
        if let Some(topic) = census.topic(name, schema) {
            census.push(topic, payload, received_ns);
        }
        if what & 0x80 != 0 {
            live.silence();
        }
        if what & 0x40 != 0 {
            continue;
        }
        while let Some(frame) = live.frame() {
            let now = (frame.segment, frame.time_ns);
            assert!(last.is_none_or(|last| now > last));
            last = Some(now);
            for quantity in Quantity::PER_JOINT {
                assert_eq!(frame.get(quantity).len(), joints.len());
                assert!(frame.get(quantity).iter().all(|value| !value.is_infinite()));
            }
        }
    }
    let health = live.health();
    assert!(health.events.len() <= sinew_log::EVENT_LIMIT);
    census.robots();
});
