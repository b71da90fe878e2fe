//! Roles of the topics, and quantities of their values.

use crate::decode::Field;
use crate::frame::{Channels, Quantity};
use crate::mapping::JointEffort;
use crate::sources::{SignalSource, TopicUse};
use sinew_files::names::list;

/// Topic and interface names after options and mapping were merged.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    pub(crate) joint_topic: Option<String>,
    pub(crate) motor_topic: Option<String>,
    /// Whether the motor side is a JointState, which has fields and no interfaces.
    pub(crate) motor_is_plain: bool,
    pub(crate) external_topic: Option<String>,
    pub(crate) tension_topic: Option<String>,
    pub(crate) motor_interface: String,
    pub(crate) motor_effort_interface: String,
    pub(crate) temperature_interface: String,
    pub(crate) joint_effort: JointEffort,
}

impl Names {
    /// Role of a topic.
    pub(crate) fn role(&self, topic: &str) -> Option<TopicUse> {
        let is = |(_, name): &(TopicUse, Option<&String>)| name.is_some_and(|name| name == topic);
        self.sides().into_iter().find(is).map(|(side, _)| side)
    }

    /// Sides of the robot, with the topic of each.
    pub(crate) fn sides(&self) -> [(TopicUse, Option<&String>); 4] {
        [
            (TopicUse::JointSide, self.joint_topic.as_ref()),
            (TopicUse::MotorSide, self.motor_topic.as_ref()),
            (TopicUse::ExternalTorque, self.external_topic.as_ref()),
            (TopicUse::Tension, self.tension_topic.as_ref()),
        ]
    }

    /// Layout of the topics, as text.
    pub(crate) fn layout(&self) -> String {
        let topics = self.sides().into_iter().filter_map(|(_, topic)| topic);
        format!("topics {}", list(&Vec::from_iter(topics)))
    }

    /// Source of each quantity of these channels, and of a tension.
    pub(crate) fn sources(&self, channels: &Channels) -> Vec<SignalSource> {
        let (joint, motor) = (self.joint_topic.as_ref(), self.motor_topic.as_ref());
        let effort_of = |effort| self.joint_effort == effort;
        let all = Quantity::ALL.into_iter();
        let found = all.filter(|q| *q == Quantity::Tension || channels.any_has(*q));
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
                    Quantity::Tension => (self.tension_topic.as_ref(), "effort"),
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

    pub(crate) fn quantity(&self, side: TopicUse, field: Field<'_>) -> Option<Quantity> {
        match (side, field) {
            (TopicUse::JointSide, Field::Position) => Some(Quantity::Q),
            (TopicUse::JointSide, Field::Velocity) => Some(Quantity::Dq),
            (TopicUse::JointSide, Field::Effort) => match self.joint_effort {
                JointEffort::TauEl => Some(Quantity::TauEl),
                JointEffort::TauM => Some(Quantity::TauM),
                JointEffort::Ignore => None,
            },
            (TopicUse::MotorSide, Field::Position) => Some(Quantity::Theta),
            (TopicUse::MotorSide, Field::Effort) => Some(Quantity::TauM),
            (TopicUse::MotorSide, Field::Interface(name)) => [
                (&self.motor_interface, Quantity::Theta),
                (&self.motor_effort_interface, Quantity::TauM),
                (&self.temperature_interface, Quantity::Temperature),
            ]
            .into_iter()
            .find_map(|(own, quantity)| (name == own.as_bytes()).then_some(quantity)),
            (TopicUse::ExternalTorque, Field::Effort) => Some(Quantity::TauExt),
            (TopicUse::Tension, Field::Effort) => Some(Quantity::Tension),
            _ => None,
        }
    }
}
