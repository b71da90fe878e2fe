//! Discovery of topics, joints and robots on a network.

use super::TopicId;
use super::choose::{Wishes, choose_so_far};
use super::joints::joints_of;
use super::names::Names;
use super::seen::{Announced, topics_of};
use super::survey::{Survey, Topic, description, is_description_topic};
use crate::decode::MessageKind;
use crate::error::Ambiguity;
use crate::frame::Quantity;
use crate::mapping::Mapping;
use crate::options::OpenOptions;
use crate::sources::TopicInfo;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Topics of a network as they are discovered, before a robot is chosen.
#[derive(Debug, Default)]
pub struct TopicDiscovery {
    announced: Announced,
    /// Namespace and text.
    descriptions: BTreeMap<String, String>,
}

/// Candidate of a robot: a namespace with joint states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotFound {
    /// Namespace of its topics; empty: the root.
    pub namespace: String,
    /// Topic of the joint side; `None`: there is none, or several could be.
    pub joint_side: Option<String>,
    /// Topic of the motor side; `None`: there is none, or several could be.
    pub motor_side: Option<String>,
    /// Sides that several topics could be.
    pub ambiguous: Vec<Ambiguity>,
    /// Joints, with the received quantities of each.
    pub joints: Vec<JointInfo>,
    /// URDF of the robot.
    pub robot_description: Option<String>,
}

/// Recorded quantities of a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointInfo {
    /// Name of the joint.
    pub name: String,
    /// Quantities that are recorded.
    pub channels: Vec<Quantity>,
}

impl TopicDiscovery {
    /// Announces a topic of any type; `None`: the maximum number is reached.
    pub fn topic(&mut self, name: &str, schema: &str) -> Option<TopicId> {
        self.announced.topic(name, schema).map(|(id, _)| id)
    }

    /// Whether messages of this type contain further information: joints, interfaces, a robot description.
    pub fn reads(name: &str, schema: &str) -> bool {
        MessageKind::of_schema(schema).is_some() || is_description_topic(name, schema)
    }

    /// A message and when it was received, ns.
    pub fn push(&mut self, topic: TopicId, cdr: &[u8], received_ns: i64) {
        let seen = self.announced.message(topic, cdr, received_ns);
        if let Some(seen) = seen.filter(|seen| seen.is_description())
            && let Some(text) = description(cdr)
        {
            let namespace = namespace_of(&seen.topic).to_owned();
            self.descriptions.insert(namespace, text);
        }
    }

    /// Topics with their types, their rates, and their roles in their namespaces.
    pub fn topics(&self) -> Vec<TopicInfo> {
        let mut topics = topics_of(&self.announced.seen, &Names::default());
        for robot in self.robots() {
            for topic in &mut topics {
                let is = |side: &Option<String>| side.as_ref() == Some(&topic.name);
                if is(&robot.joint_side) {
                    topic.role = Some(crate::sources::TopicUse::JointSide);
                } else if is(&robot.motor_side) {
                    topic.role = Some(crate::sources::TopicUse::MotorSide);
                }
            }
        }
        topics
    }

    /// Namespaces that hold joint states.
    pub fn robots(&self) -> Vec<RobotFound> {
        let states = self.announced.survey.topics.values();
        let states = states.filter(|topic| MessageKind::of_schema(&topic.schema).is_some());
        let namespaces: BTreeSet<&str> = states.map(|topic| namespace_of(&topic.name)).collect();
        let all = namespaces.into_iter();
        all.map(|namespace| self.robot(namespace)).collect()
    }

    fn robot(&self, namespace: &str) -> RobotFound {
        let here = |topic: &&Topic| namespace_of(&topic.name) == namespace;
        let topics = self.announced.survey.topics.values().filter(here).cloned();
        let survey = Survey {
            topics: (0..).zip(topics).collect(),
            ..Survey::default()
        };
        let wishes = Wishes::of(&OpenOptions::default(), namespace);
        let (names, ambiguous) = choose_so_far(&survey, &wishes);
        // Without a mapping no joint is missing.
        let joints = joints_of(&survey, &names, &Mapping::default(), "");
        let found = joints.unwrap_or_default();
        let joints = found.joints.into_iter().zip(found.channels.joints);
        RobotFound {
            namespace: namespace.to_owned(),
            joint_side: names.joint_topic,
            motor_side: names.motor_topic,
            ambiguous,
            joints: joints
                .map(|(name, has)| JointInfo {
                    name,
                    channels: has.iter().collect(),
                })
                .collect(),
            robot_description: self.descriptions.get(namespace).cloned(),
        }
    }
}

/// Namespace of a topic: `/arm7` of `/arm7/joint_states`.
fn namespace_of(topic: &str) -> &str {
    topic
        .rsplit_once('/')
        .map_or("", |(namespace, _)| namespace)
}
