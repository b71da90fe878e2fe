//! Which topics are of use to a robot's monitor, before any is subscribed to.

use super::LiveOptions;
use super::choose::Wishes;
use super::survey::is_description_topic;
use crate::decode::MessageKind;

/// Tells topics of use from others, by name and type alone.
#[derive(Debug, Clone)]
pub struct TopicFilter {
    wishes: Wishes,
}

impl TopicFilter {
    /// As [`Live::topic`](super::Live::topic) with these options decides.
    pub fn new(options: &LiveOptions) -> Self {
        let namespace = options.namespace.trim_matches('/');
        let namespace = match namespace.is_empty() {
            true => String::new(),
            false => format!("/{namespace}"),
        };
        TopicFilter {
            wishes: Wishes::of(&options.open, &namespace),
        }
    }

    /// Whether messages of this topic may be of use.
    pub fn wants(&self, topic: &str, schema: &str) -> bool {
        match MessageKind::of_schema(schema) {
            Some(kind) => self.wishes.may_use(topic, kind),
            None => is_description_topic(topic, schema) && self.wishes.encloses(topic),
        }
    }

    /// Whether a topic carries joint states, of whatever robot.
    pub fn is_of_joints(schema: &str) -> bool {
        MessageKind::of_schema(schema).is_some()
    }

    /// Whether a topic has a name that is looked for, whatever its type.
    pub fn expects(&self, topic: &str) -> bool {
        self.wishes.is_named(topic)
    }

    /// Topics that are asked for by name; they may lie outside the namespace.
    pub fn named(&self) -> impl Iterator<Item = &str> {
        let sides = [self.wishes.joint.as_deref(), self.wishes.motor.as_deref()];
        sides.into_iter().flatten()
    }

    /// What the robot's topics lie in: empty, or a name that begins with `/`.
    pub fn namespace(&self) -> &str {
        &self.wishes.namespace
    }

    pub(super) fn wishes(&self) -> &Wishes {
        &self.wishes
    }
}
