//! Where the values of a recording come from.

use crate::frame::Quantity;
use serde::{Deserialize, Serialize};

/// What a topic is taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TopicUse {
    /// The joint side: it sets the instants.
    JointSide,
    /// The motor side.
    MotorSide,
    /// The known external torque.
    ExternalTorque,
    /// The robot's URDF.
    RobotDescription,
}

/// A topic of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TopicInfo {
    /// Its name.
    pub name: String,
    /// Type of its messages, such as `sensor_msgs/msg/JointState`.
    pub kind: String,
    /// Messages read.
    pub messages: u64,
    /// Messages per second of the recorder's clock; `None` with fewer than two.
    pub rate_hz: Option<f64>,
    /// Interfaces its joints have (`control_msgs/msg/DynamicJointState`).
    pub interfaces: Vec<String>,
    /// What it is taken for; `None`: not used.
    pub taken_for: Option<TopicUse>,
}

impl TopicInfo {
    /// Adds what was met of the same topic later.
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

/// Where a quantity is read from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SignalSource {
    /// The quantity.
    pub quantity: Quantity,
    /// Topic it is in; `None` in a table.
    pub topic: Option<String>,
    /// Topic and field or interface, or the columns.
    pub source: String,
}
