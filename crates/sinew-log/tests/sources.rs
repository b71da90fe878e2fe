//! Sources of the values of a recording: topics, interfaces and columns are reported, and ambiguous ones are
//! errors.

use crate::support::{
    Bag, DynamicJointState, InterfaceValue, JOINT, MOTOR, MS, START_NS, error_of, header,
    joint_state, little, motor_state, open_bytes, read_all,
};
use sinew_log::{
    FrameCounter, LogError, Mapping, OpenOptions, Quantity, RecordingInfo, TopicInfo, TopicUse,
};

fn info(bytes: &[u8], name: &str, options: &OpenOptions) -> RecordingInfo {
    let mut recording = open_bytes(bytes, name, options).unwrap();
    let mut counter = FrameCounter::default();
    while let Some(frame) = recording.next_frame().unwrap() {
        counter.frame(frame.time_ns, frame.segment);
    }
    counter.info(&recording, name)
}

fn both_sides(joint: &str, motor: &[&str]) -> Vec<u8> {
    let mut bag = Bag::new();
    bag.channel("/tf", "tf2_msgs/msg/TFMessage", "cdr");
    for topic in motor.iter().filter(|t| t.contains("dynamic")) {
        bag.channel(topic, "control_msgs/msg/DynamicJointState", "cdr");
    }
    for step in 0..50 {
        let time = START_NS + 10 * step * MS;
        bag.raw(joint, &little(&joint_state(time, &[("a", 1.0)])));
        for topic in motor {
            match topic.contains("dynamic") {
                true => bag.raw(topic, &little(&motor_state(time, &[("a", 1.1)]))),
                false => bag.raw(topic, &little(&joint_state(time, &[("a", 1.1)]))),
            };
        }
        bag.raw("/tf", b"anything");
    }
    bag.bytes()
}

#[test]
fn topics_are_listed_with_roles() {
    let bytes = both_sides(JOINT, &[MOTOR]);
    let info = info(&bytes, "a.mcap", &OpenOptions::default());
    let listed: Vec<_> = (info.topics.iter())
        .map(|t| (t.name.as_str(), t.kind.as_str(), t.messages, t.role))
        .collect();
    assert_eq!(
        listed,
        [
            (
                MOTOR,
                "control_msgs/msg/DynamicJointState",
                50,
                Some(TopicUse::MotorSide)
            ),
            (
                JOINT,
                "sensor_msgs/msg/JointState",
                50,
                Some(TopicUse::JointSide)
            ),
            ("/tf", "tf2_msgs/msg/TFMessage", 50, None),
        ]
    );
    // A message every 3 ns of the log's clock.
    let rate = info.topics[2].rate_hz.unwrap();
    assert!((rate * 3e-9 - 1.0).abs() < 1e-9, "{rate}");
    let sources: Vec<_> = (info.sources.iter())
        .map(|s| (s.quantity, s.source.as_str()))
        .collect();
    assert_eq!(
        sources,
        [
            (Quantity::Q, "/joint_states position"),
            (Quantity::Theta, "/dynamic_joint_states motor_position"),
        ]
    );
    assert!(info.unused_columns.is_empty());
}

#[test]
fn columns_are_named_and_those_left_over_too() {
    let table = "time_s,q.a_rad,theta.a_rad,q.b_rad,theta.b_rad,note,voltage\n0,1,1,2,2,,5\n0.01,1,1,2,2,,5\n";
    let info = info(table.as_bytes(), "a.csv", &OpenOptions::default());
    assert!(info.topics.is_empty());
    let sources: Vec<_> = (info.sources.iter())
        .map(|s| (s.quantity, s.source.as_str()))
        .collect();
    assert_eq!(
        sources,
        [
            (Quantity::Q, "q.a_rad, q.b_rad"),
            (Quantity::Theta, "theta.a_rad, theta.b_rad"),
        ]
    );
    assert_eq!(info.unused_columns, ["note", "voltage"]);
}

#[test]
fn ambiguous_motor_side_is_error() {
    for motors in [
        ["/left/motor_states", "/right/motor_states"],
        ["/a/dynamic", "/b/dynamic"],
    ] {
        let bytes = both_sides(JOINT, &motors);
        let error = error_of(&bytes, "a.mcap", &OpenOptions::default());
        for word in ["motor side", motors[0], motors[1], "--motor-topic"] {
            assert!(error.contains(word), "{error}");
        }
        let opened = open_bytes(&bytes, "a.mcap", &OpenOptions::default());
        let Err(LogError::Ambiguous(choice)) = opened else {
            panic!("{error}");
        };
        assert_eq!(choice.side, TopicUse::MotorSide);
        assert_eq!(choice.candidates, motors);
        let chosen = OpenOptions {
            motor_topic: Some(motors[1].to_owned()),
            ..OpenOptions::default()
        };
        let taken = info(&bytes, "a.mcap", &chosen);
        let taken = taken
            .topics
            .iter()
            .find(|t| t.role == Some(TopicUse::MotorSide));
        assert_eq!(taken.unwrap().name, motors[1]);
        // Looked into without a choice: counted, but nothing read by it is shown.
        let seen = info(&bytes, "a.mcap", &chosen).undecided(vec![choice]);
        let motor = |t: &&TopicInfo| motors.contains(&t.name.as_str());
        let open: Vec<_> = seen.topics.iter().filter(motor).collect();
        assert!(open.iter().all(|t| t.messages > 0 && t.role.is_none()));
        assert!(seen.joints.is_empty() && seen.sources.is_empty());
        assert!(
            seen.health.implausible_signals.is_empty(),
            "{:?}",
            seen.health
        );
    }
    let error = error_of(
        &both_sides("/a/states", &["/b/states"]),
        "a.mcap",
        &OpenOptions::default(),
    );
    assert!(
        error.contains("--joint-topic") && error.contains("'/b/states'"),
        "{error}"
    );
}

#[test]
fn one_topic_is_not_both_sides() {
    let options = OpenOptions {
        joint_state_topic: Some(JOINT.to_owned()),
        motor_topic: Some(JOINT.to_owned()),
        ..OpenOptions::default()
    };
    let error = error_of(&both_sides(JOINT, &[MOTOR]), "a.mcap", &options);
    assert!(
        error.contains("joint side and motor side") && error.contains(JOINT),
        "{error}"
    );
    // Nor one column, and a column and itself scaled is a deliberate choice.
    let table = "time_s,pos\n0,1\n0.01,1\n";
    let mapped = |theta: &str| {
        OpenOptions {
        mapping: Some(
            Mapping::from_toml(
                &format!("[joints.a]\nq = {{ column = \"pos\" }}\ntheta = {{ column = \"pos\"{theta} }}\n"),
                "map.toml",
            )
            .unwrap(),
        ),
        ..OpenOptions::default()
    }
    };
    let error = error_of(table.as_bytes(), "a.csv", &mapped(""));
    assert!(
        error.contains("map.toml, line 3") && error.contains("'pos'"),
        "{error}"
    );
    read_all(open_bytes(table.as_bytes(), "a.csv", &mapped(", scale = 2.0")).unwrap());
}

#[test]
fn missing_interface_error_lists_interfaces() {
    let mut bag = Bag::new();
    bag.channel(MOTOR, "control_msgs/msg/DynamicJointState", "cdr");
    for step in 0..20 {
        let time = START_NS + 10 * step * MS;
        bag.joint(time, &[("a", 1.0)]);
        let motor = DynamicJointState {
            header: header(time),
            joint_names: vec!["a".to_owned()],
            interface_values: vec![InterfaceValue {
                interface_names: vec!["position".to_owned(), "rotor".to_owned()],
                values: vec![1.0, 50.0],
            }],
        };
        bag.raw(MOTOR, &little(&motor));
    }
    let bytes = bag.bytes();
    // A recording without a motor side can be looked at; what could be one is listed.
    let seen = info(&bytes, "a.mcap", &OpenOptions::default());
    let motor = seen.topics.iter().find(|t| t.name == MOTOR).unwrap();
    assert_eq!(motor.interfaces, ["position", "rotor"]);
    // A requested interface must exist.
    let options = OpenOptions {
        motor_interface: "rotr".to_owned(),
        ..OpenOptions::default()
    };
    let error = error_of(&bytes, "a.mcap", &options);
    assert!(
        error.contains("did you mean 'rotor'") && error.contains("'position'"),
        "{error}"
    );
}

#[test]
fn backward_clock_is_error() {
    for rows in [5, 500] {
        let mut table = String::from("time_s,q.a_rad,theta.a_rad\n");
        for row in 0..rows {
            table += &format!("{},{row},{row}\n", 10.0 - 0.01 * f64::from(row));
        }
        let error = error_of(table.as_bytes(), "a.csv", &OpenOptions::default());
        assert!(
            error.contains("backwards") && error.contains("sort"),
            "{error}"
        );
    }
}

#[test]
fn times_that_collide_now_and_then_are_warned_of() {
    let mut table = String::from("time_s,q.a_rad,theta.a_rad\n");
    for row in 0..1000 {
        // A float of 32 bits at 1e5 s has steps of 7.8 ms; the robot wrote every 5 ms.
        let rounded = (1e5 + 0.005 * f64::from(row)) as f32;
        table += &format!("{rounded},{row},{row}\n");
    }
    let seen = info(table.as_bytes(), "a.csv", &OpenOptions::default());
    let told = seen
        .health
        .implausible_signals
        .iter()
        .find(|s| s.contains("time_s"));
    let told = told.unwrap_or_else(|| panic!("{:?}", seen.health));
    assert!(
        told.contains("of 1000 rows") && told.contains("32-bit"),
        "{told}"
    );
}

#[test]
fn rounded_equal_times_are_error() {
    for rows in [6_i64, 500] {
        let mut table = String::from("time_s,q.a_rad,theta.a_rad\n");
        for row in 0..rows {
            // As a float of 32 bits keeps a time of today: in steps of 128 s.
            let rounded = (1.7e9 + 0.01 * row as f64) as f32;
            table += &format!("{rounded},{row},{row}\n");
        }
        let error = error_of(table.as_bytes(), "a.csv", &OpenOptions::default());
        assert!(
            error.contains("same time") && error.contains("32-bit"),
            "{error}"
        );
    }
}
