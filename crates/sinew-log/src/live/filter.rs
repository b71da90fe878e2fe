//! Selection of the topics that a robot's monitor needs, before it subscribes to any.

use super::LiveOptions;
use super::choose::Wishes;
use super::survey::is_description_topic;
use crate::decode::MessageKind;

/// Filter of relevant topics, by name and type only.
#[derive(Debug, Clone)]
pub struct TopicFilter {
    wishes: Wishes,
}

impl TopicFilter {
    /// Filters as [`Live::topic`](super::Live::topic) with these options.
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

    /// Whether a topic carries joint states of any robot.
    pub fn is_of_joints(schema: &str) -> bool {
        MessageKind::of_schema(schema).is_some()
    }

    /// Whether the name of a topic is expected, independent of its type.
    pub fn expects(&self, topic: &str) -> bool {
        self.wishes.is_named(topic)
    }

    /// Topics that are requested by name; they may be outside the namespace.
    pub fn named(&self) -> impl Iterator<Item = &str> {
        let wishes = &self.wishes;
        let sides = [&wishes.joint, &wishes.motor, &wishes.tension].map(Option::as_deref);
        sides.into_iter().flatten()
    }

    /// Namespace of the robot's topics: empty, or a name that begins with `/`.
    pub fn namespace(&self) -> &str {
        &self.wishes.namespace
    }

    pub(super) fn wishes(&self) -> &Wishes {
        &self.wishes
    }
}
