//! Options for reading a recording.

use crate::error::LogError;
use crate::mapping::{JointEffort, Mapping};
use sinew_files::Budget;

/// Options for reading a recording; every field has a documented default.
///
/// A [`Mapping`] may set the topic and interface names as well; a name given
/// here wins over the mapping's.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenOptions {
    /// Names, units, signs and gear ratios of the recording.
    pub mapping: Option<Mapping>,
    /// Joint-side `sensor_msgs/msg/JointState` topic. Default: `/joint_states`,
    /// else the only `JointState` topic there is that is not the motor side.
    pub joint_state_topic: Option<String>,
    /// Motor-side topic, `control_msgs/msg/DynamicJointState` or a second
    /// `JointState`. Default: `/dynamic_joint_states`, else the only
    /// `DynamicJointState` topic, else a `JointState` topic with `motor` in its name.
    pub motor_topic: Option<String>,
    /// Interface of `DynamicJointState` with the motor position, reflected to the joint.
    pub motor_interface: String,
    /// Interface of `DynamicJointState` with the motor torque, reflected to the joint.
    pub motor_effort_interface: String,
    /// Interface of `DynamicJointState` with a temperature.
    pub temperature_interface: String,
    /// `JointState` topic whose `effort` is the known external torque.
    pub external_torque_topic: String,
    /// Quantity of the joint side's `effort`.
    pub joint_effort: JointEffort,
    /// Maximum gap between frames of one segment, s.
    pub gap_s: f64,
    /// Messages late by at most this much are sorted in, s; later ones are dropped and counted.
    pub reorder_s: f64,
    /// Motor samples farther than this from the joint stamp are not used for interpolation, s.
    pub interpolate_s: f64,
    /// Resources that the reading may take.
    pub budget: Budget,
}

impl Default for OpenOptions {
    fn default() -> Self {
        OpenOptions {
            mapping: None,
            joint_state_topic: None,
            motor_topic: None,
            motor_interface: "motor_position".to_owned(),
            motor_effort_interface: "motor_effort".to_owned(),
            temperature_interface: "temperature".to_owned(),
            external_torque_topic: "/external_joint_torques".to_owned(),
            joint_effort: JointEffort::default(),
            gap_s: 0.5,
            reorder_s: 0.25,
            interpolate_s: 0.05,
            budget: Budget::RECORDING,
        }
    }
}

/// Seconds to nanoseconds, saturating.
pub(crate) fn to_ns(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// Rejects invalid times; `name` is that of the recording.
pub(crate) fn check_options(options: &OpenOptions, name: &str) -> Result<(), LogError> {
    let request = |reason: String| Err(LogError::request(name, reason));
    for (what, value) in [
        ("gap_s", options.gap_s),
        ("reorder_s", options.reorder_s),
        ("interpolate_s", options.interpolate_s),
    ] {
        if value.is_nan() || value < 0.0 {
            return request(format!("option {what} is {value} s; must be at least 0"));
        }
    }
    if options.interpolate_s > options.reorder_s && options.interpolate_s > 0.0 {
        return request(format!(
            "option interpolate_s ({} s) exceeds reorder_s ({} s); reduce it or increase reorder_s",
            options.interpolate_s, options.reorder_s
        ));
    }
    Ok(())
}
