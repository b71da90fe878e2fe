//! Published messages have the topics and types of ROS.

use sinew_log::decode::{Field, MessageKind, parse};
use sinew_log::encode::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue, KeyValue, Level,
};
use sinew_transport::{Outgoing, Publishing};

#[test]
fn publish_uses_ros_topics_and_types() {
    let header = Header::at(1_700_000_000_000_000_000, "").unwrap();
    let status = [DiagnosticStatus {
        level: Level::Warn,
        name: "sinew: arm-7/elbow".to_owned(),
        message: "re-tension".to_owned(),
        hardware_id: "arm-7".to_owned(),
        values: vec![KeyValue {
            key: "offset_radians".to_owned(),
            value: "0.0127".to_owned(),
        }],
    }];
    let array = DiagnosticArray {
        header,
        status: &status,
    };
    let diagnostics = Outgoing::Diagnostics(array);
    assert_eq!(diagnostics.topic(), "/diagnostics");
    assert_eq!(
        diagnostics.schema().name,
        "diagnostic_msgs/msg/DiagnosticArray"
    );

    let names = ["elbow".to_owned()];
    let values = [InterfaceValue {
        interface_names: &["offset", "alarm_level"],
        values: &[0.0127, 1.0],
    }];
    let state = DynamicJointState {
        header,
        joint_names: &names,
        interface_values: &values,
    };
    for (namespace, topic) in [
        ("", "/sinew/tendons"),
        ("/arm7", "/arm7/sinew/tendons"),
        ("arm7/", "/arm7/sinew/tendons"),
    ] {
        assert_eq!(Outgoing::Tendons { namespace, state }.topic(), topic);
    }
    let namespace = "/arm7";
    let tendons = Outgoing::Tendons { namespace, state };
    let mut cdr = Vec::new();
    tendons.encode(&mut cdr).unwrap();
    let parsed = parse(MessageKind::DynamicJointState, &cdr).unwrap();
    assert_eq!(parsed.entries[1].field, Field::Interface(b"alarm_level"));

    assert!(Publishing::default().allows(&diagnostics));
    assert!(!Publishing::DISABLED.allows(&diagnostics));
    let only = Publishing {
        diagnostics: false,
        tendons: true,
    };
    assert!(only.allows(&tendons) && !only.allows(&diagnostics));
}
