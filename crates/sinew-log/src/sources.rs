//! Sources of the values of a recording.

use crate::frame::Quantity;
use serde::{Deserialize, Serialize};

/// Role of a topic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TopicUse {
    /// Joint side, which sets the time stamps.
    JointSide,
    /// Motor side of the robot.
    MotorSide,
    /// Specified external torque of the joints.
    ExternalTorque,
    /// Robot description in URDF.
    RobotDescription,
    /// Tensions of the tendons.
    Tension,
}

/// Topic of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TopicInfo {
    /// Name of the topic.
    pub name: String,
    /// Type of its messages, such as `sensor_msgs/msg/JointState`.
    pub kind: String,
    /// Number of messages read.
    pub messages: u64,
    /// Message rate by the recorder's clock, Hz; `None` with fewer than two messages.
    pub rate_hz: Option<f64>,
    /// Interfaces of its joints (`control_msgs/msg/DynamicJointState`).
    pub interfaces: Vec<String>,
    /// Role of the topic; `None`: not used.
    pub role: Option<TopicUse>,
}

impl TopicInfo {
    /// Adds the content of a later part of the same topic.
    pub(crate) fn add(&mut self, later: &TopicInfo) {
        let length_s = |t: &TopicInfo| t.rate_hz.map_or(0.0, |hz| (t.messages - 1) as f64 / hz);
        let (length, steps) = (length_s(self) + length_s(later), |n: u64| {
            n.saturating_sub(1)
        });
        let steps = (steps(self.messages) + steps(later.messages)) as f64;
        self.messages += later.messages;
        self.rate_hz = Some(steps / length).filter(|hz| hz.is_finite());
        for interface in &later.interfaces {
            if !self.interfaces.contains(interface) {
                self.interfaces.push(interface.clone());
            }
        }
    }
}

/// Source of a quantity.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalSource {
    /// Quantity that is read.
    pub quantity: Quantity,
    /// Topic of the quantity; `None` for a table.
    pub topic: Option<String>,
    /// Topic and field or interface, or the columns.
    pub source: String,
}
