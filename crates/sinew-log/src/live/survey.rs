//! Content of messages before any role is assigned: topics, joints, interfaces.

use crate::decode::{Cdr, Field, MessageKind, ROS1, parse, stamp_ns};
use crate::health::Health;
use std::collections::{BTreeMap, BTreeSet};

/// Number of messages per topic that are searched for joint names.
pub(crate) const NAMED_MESSAGES: u64 = 256;
/// Number of messages per topic of a recording of which those of a new length are searched for joint names: a driver
/// may start after the recorder.
pub(crate) const RECORDED_MESSAGES: u64 = 16_384;
/// Most lengths of the messages of a topic that are remembered.
const LENGTHS_LIMIT: usize = 64;
/// Most joints and interfaces a topic may have.
const NAME_LIMIT: usize = 4096;

/// Values of a joint in a topic.
#[derive(Debug, Clone, Default)]
pub(crate) struct Fields {
    /// Number of messages with the position of the joint.
    pub(crate) messages: u64,
    pub(crate) position: bool,
    pub(crate) velocity: bool,
    pub(crate) effort: bool,
    pub(crate) interfaces: Vec<String>,
}

/// Topic with the names in its first messages.
#[derive(Debug, Clone, Default)]
pub(crate) struct Topic {
    pub(crate) name: String,
    pub(crate) schema: String,
    pub(crate) encoding: String,
    pub(crate) messages: u64,
    /// Joints in the order met.
    pub(crate) joints: Vec<(String, Fields)>,
    /// Time stamp of the first message that has one, minus the time of its receipt, ns; `None`: no message
    /// has a time stamp.
    pub(crate) stamp_lag_ns: Option<i64>,
    /// Lengths of the messages that were searched for joint names, bytes.
    pub(crate) lengths: Vec<usize>,
}

impl Topic {
    /// A topic that was announced.
    pub(crate) fn live(name: &str, schema: &str) -> Self {
        Topic {
            name: name.to_owned(),
            schema: schema.to_owned(),
            encoding: "cdr".to_owned(),
            ..Topic::default()
        }
    }

    /// Whether the encoding of its messages is supported.
    pub(crate) fn is_decoded(&self) -> bool {
        matches!(self.encoding.as_str(), "cdr" | ROS1)
    }

    /// Interfaces that its joints have, sorted.
    pub(crate) fn interfaces(&self) -> Vec<String> {
        let all = self
            .joints
            .iter()
            .flat_map(|(_, fields)| &fields.interfaces);
        let all: BTreeSet<&String> = all.collect();
        all.into_iter().cloned().collect()
    }
}

/// Topics with the names in their first messages.
#[derive(Debug, Default)]
pub(crate) struct Survey {
    pub(crate) topics: BTreeMap<u16, Topic>,
    pub(crate) schemas: BTreeMap<u16, String>,
    pub(crate) robot_description: Option<String>,
    /// The recorder's clock at the first message, ns.
    pub(crate) starts_ns: Option<i64>,
    /// Damage found in the part that was scanned.
    pub(crate) health: Health,
}

impl Survey {
    pub(crate) fn message(&mut self, channel: u16, received_ns: i64, payload: &[u8]) {
        let Some(topic) = self.topics.get_mut(&channel) else {
            return;
        };
        topic.messages += 1;
        if is_description(topic) && self.robot_description.is_none() {
            self.robot_description = description(payload);
            return;
        }
        let is_early = topic.messages <= NAMED_MESSAGES;
        let is_new = !topic.lengths.contains(&payload.len());
        let is_searched = is_early || is_new && topic.messages <= RECORDED_MESSAGES;
        if !is_searched || !topic.is_decoded() {
            return;
        }
        if is_new && topic.lengths.len() < LENGTHS_LIMIT {
            topic.lengths.push(payload.len());
        }
        let Some(kind) = MessageKind::of_schema(&topic.schema) else {
            return;
        };
        if topic.stamp_lag_ns.is_none() {
            let stamp = stamp_ns(payload).filter(|stamp| *stamp != 0);
            topic.stamp_lag_ns = stamp.map(|stamp| stamp.saturating_sub(received_ns));
        }
        // What cannot be decoded is counted when the messages are read for good.
        let Ok(parsed) = parse(kind, payload) else {
            return;
        };
        for entry in &parsed.entries {
            let name = String::from_utf8_lossy(entry.joint);
            let index = match topic.joints.iter().position(|(known, _)| *known == name) {
                Some(index) => index,
                None if topic.joints.len() < NAME_LIMIT => {
                    topic.joints.push((name.into_owned(), Fields::default()));
                    topic.joints.len() - 1
                }
                None => continue,
            };
            let fields = &mut topic.joints[index].1;
            match entry.field {
                Field::Position => {
                    fields.position = true;
                    fields.messages += 1;
                }
                Field::Velocity => fields.velocity = true,
                Field::Effort => fields.effort = true,
                Field::Interface(name) => {
                    let name = String::from_utf8_lossy(name);
                    if !fields.interfaces.iter().any(|known| *known == name)
                        && fields.interfaces.len() < NAME_LIMIT
                    {
                        fields.interfaces.push(name.into_owned());
                    }
                }
            }
        }
    }
}

pub(crate) fn is_description(topic: &Topic) -> bool {
    is_description_topic(&topic.name, &topic.schema)
}

pub(crate) fn is_description_topic(name: &str, schema: &str) -> bool {
    name.rsplit('/').next() == Some("robot_description")
        && matches!(schema, "std_msgs/msg/String" | "std_msgs/String")
}

pub(crate) fn description(payload: &[u8]) -> Option<String> {
    let text = Cdr::new(payload).and_then(|mut cdr| cdr.string()).ok()?;
    let text = String::from_utf8_lossy(text);
    (!text.trim().is_empty()).then(|| text.into_owned())
}
