//! Conversion of ROS 2 names and types to those on DDS, and back.
//!
//! A topic `/arm7/joint_states` is `rt/arm7/joint_states`; a type `sensor_msgs/msg/JointState` is
//! `sensor_msgs::msg::dds_::JointState_`.

/// Returns the ROS 2 topic of a DDS topic; `None`: not a ROS 2 topic (a service, or another application).
#[cfg(feature = "dds")]
pub(crate) fn topic_of(dds: &str) -> Option<String> {
    let name = dds.strip_prefix("rt/")?;
    (!name.is_empty()).then(|| format!("/{name}"))
}

/// Returns the ROS 2 type of a DDS type; `None`: not a ROS 2 message.
pub(crate) fn schema_of(dds: &str) -> Option<String> {
    let (package, name) = dds.split_once("::msg::dds_::")?;
    let name = name.strip_suffix('_')?;
    Some(format!("{package}/msg/{name}"))
}

/// Returns the DDS name of a topic.
#[cfg(feature = "dds")]
pub(crate) fn dds_topic(topic: &str) -> String {
    format!("rt{topic}")
}

/// Returns the DDS name of a type.
pub(crate) fn dds_type(schema: &str) -> String {
    match schema.split_once("/msg/") {
        Some((package, name)) => format!("{package}::msg::dds_::{name}_"),
        None => schema.to_owned(),
    }
}

#[cfg(all(test, feature = "dds"))]
mod tests {
    use super::*;

    #[test]
    fn ros_names_round_trip() {
        for (ros, dds) in [("/joint_states", "rt/joint_states"), ("/a/b/c", "rt/a/b/c")] {
            assert_eq!(dds_topic(ros), dds);
            assert_eq!(topic_of(dds).as_deref(), Some(ros));
        }
        let (ros, dds) = (
            "sensor_msgs/msg/JointState",
            "sensor_msgs::msg::dds_::JointState_",
        );
        assert_eq!(dds_type(ros), dds);
        assert_eq!(schema_of(dds).as_deref(), Some(ros));
        for foreign in [
            "rq/add_two_intsRequest",
            "rr/x",
            "Square",
            "rt/",
            "DCPSTopic",
        ] {
            assert_eq!(topic_of(foreign), None, "{foreign}");
        }
        for foreign in [
            "ShapeType",
            "example_interfaces::srv::dds_::AddTwoInts_Request_",
            "",
        ] {
            assert_eq!(schema_of(foreign), None, "{foreign}");
        }
    }
}
