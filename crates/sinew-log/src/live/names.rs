//! What a topic is for, and which quantity each of its values is.

use crate::decode::Field;
use crate::frame::{Channels, Quantity};
use crate::mapping::JointEffort;
use crate::sources::{SignalSource, TopicUse};
use sinew_files::names::list;

/// What a topic is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    Joint,
    Motor,
    External,
}

/// Topic and interface names after options and mapping were merged.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    pub(crate) joint_topic: Option<String>,
    pub(crate) motor_topic: Option<String>,
    /// Whether the motor side is a JointState, which has fields and no interfaces.
    pub(crate) motor_is_plain: bool,
    pub(crate) external_topic: Option<String>,
    pub(crate) motor_interface: String,
    pub(crate) motor_effort_interface: String,
    pub(crate) temperature_interface: String,
    pub(crate) joint_effort: JointEffort,
}

impl Names {
    /// What a topic is taken for.
    pub(crate) fn taken_for(&self, topic: &str) -> Option<TopicUse> {
        self.role(topic).map(|role| match role {
            Role::Joint => TopicUse::JointSide,
            Role::Motor => TopicUse::MotorSide,
            Role::External => TopicUse::ExternalTorque,
        })
    }

    /// What a topic is for.
    pub(crate) fn role(&self, topic: &str) -> Option<Role> {
        if Some(topic) == self.joint_topic.as_deref() {
            Some(Role::Joint)
        } else if Some(topic) == self.motor_topic.as_deref() {
            Some(Role::Motor)
        } else if Some(topic) == self.external_topic.as_deref() {
            Some(Role::External)
        } else {
            None
        }
    }

    /// The topics read, as words.
    pub(crate) fn layout(&self) -> String {
        let topics = [&self.joint_topic, &self.motor_topic, &self.external_topic];
        let topics = topics.into_iter().flatten();
        format!("topics {}", list(&Vec::from_iter(topics)))
    }

    /// Where each quantity of these channels is read from.
    pub(crate) fn sources(&self, channels: &Channels) -> Vec<SignalSource> {
        let (joint, motor) = (self.joint_topic.as_ref(), self.motor_topic.as_ref());
        let effort_of = |effort| self.joint_effort == effort;
        let all = Quantity::PER_JOINT
            .into_iter()
            .chain([Quantity::Temperature]);
        let found = all.filter(|quantity| channels.any_has(*quantity));
        found
            .filter_map(|quantity| {
                let (topic, field) = match quantity {
                    Quantity::Q => (joint, "position"),
                    Quantity::Dq => (joint, "velocity"),
                    Quantity::TauEl => (joint, "effort"),
                    Quantity::TauM if effort_of(JointEffort::TauM) => (joint, "effort"),
                    Quantity::Theta => (motor, self.motor_interface.as_str()),
                    Quantity::TauM => (motor, self.motor_effort_interface.as_str()),
                    Quantity::Temperature => (motor, self.temperature_interface.as_str()),
                    Quantity::TauExt => (self.external_topic.as_ref(), "effort"),
                };
                let plain = match quantity {
                    Quantity::Theta => "position",
                    _ => "effort",
                };
                let field = if topic == motor && self.motor_is_plain {
                    plain
                } else {
                    field
                };
                let topic = topic?.clone();
                let source = format!("{topic} {field}");
                Some(SignalSource {
                    quantity,
                    topic: Some(topic),
                    source,
                })
            })
            .collect()
    }

    pub(crate) fn quantity(&self, role: Role, field: Field<'_>) -> Option<Quantity> {
        match (role, field) {
            (Role::Joint, Field::Position) => Some(Quantity::Q),
            (Role::Joint, Field::Velocity) => Some(Quantity::Dq),
            (Role::Joint, Field::Effort) => match self.joint_effort {
                JointEffort::TauEl => Some(Quantity::TauEl),
                JointEffort::TauM => Some(Quantity::TauM),
                JointEffort::Ignore => None,
            },
            (Role::Motor, Field::Position) => Some(Quantity::Theta),
            (Role::Motor, Field::Effort) => Some(Quantity::TauM),
            (Role::Motor, Field::Interface(name)) => {
                if name == self.motor_interface.as_bytes() {
                    Some(Quantity::Theta)
                } else if name == self.motor_effort_interface.as_bytes() {
                    Some(Quantity::TauM)
                } else if name == self.temperature_interface.as_bytes() {
                    Some(Quantity::Temperature)
                } else {
                    None
                }
            }
            (Role::External, Field::Effort) => Some(Quantity::TauExt),
            _ => None,
        }
    }
}
