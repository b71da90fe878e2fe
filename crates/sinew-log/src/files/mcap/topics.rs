//! Which topic is what, and which joints the recording holds.

use super::messages::{Fields, Topic};
use super::scan::Contents;
use crate::decode::{Field, MessageKind};
use crate::error::{Ambiguity, LogError};
use crate::frame::{Channels, Quantities, Quantity};
use crate::mapping::{JointEffort, JointMap, Mapping};
use crate::options::OpenOptions;
use crate::sources::{SignalSource, TopicUse};
use sinew_files::names::{hint, list};
use sinew_files::{Fault, Located};
use std::collections::BTreeSet;

/// Topic of the joint side unless told otherwise.
const JOINT_TOPIC: &str = "/joint_states";
/// Topic of the motor side unless told otherwise.
const MOTOR_TOPIC: &str = "/dynamic_joint_states";

/// What a topic is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Joint,
    Motor,
    External,
}

/// Topic and interface names after options and mapping were merged.
#[derive(Debug, Clone)]
pub(super) struct Names {
    pub(super) joint_topic: String,
    pub(super) motor_topic: Option<String>,
    /// Whether the motor side is a JointState, which has fields and no interfaces.
    motor_is_plain: bool,
    pub(super) external_topic: Option<String>,
    pub(super) motor_interface: String,
    pub(super) motor_effort_interface: String,
    pub(super) temperature_interface: String,
    pub(super) joint_effort: JointEffort,
}

impl Names {
    /// What a topic is for.
    pub(super) fn role(&self, topic: &str) -> Option<Role> {
        if topic == self.joint_topic {
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
    pub(super) fn layout(&self) -> String {
        let sides = [&self.motor_topic, &self.external_topic];
        let topics = [Some(&self.joint_topic)].into_iter();
        let topics = topics.chain(sides.map(Option::as_ref)).flatten();
        format!("topics {}", list(&Vec::from_iter(topics)))
    }

    /// Where each quantity of these channels is read from.
    pub(super) fn sources(&self, channels: &Channels) -> Vec<SignalSource> {
        let (joint, motor) = (Some(&self.joint_topic), self.motor_topic.as_ref());
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

    pub(super) fn quantity(&self, role: Role, field: Field<'_>) -> Option<Quantity> {
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

/// In an MCAP recording a term converts a field; it names no column.
pub(super) fn check_mapping(mapping: &Mapping) -> Result<(), Located> {
    for source in mapping
        .joints
        .iter()
        .flat_map(|joint| joint.sources.iter().flatten())
    {
        for term in &source.terms {
            if let Some(column) = &term.column {
                let problem = "an MCAP recording has topics, not columns";
                return Err(Located::new(&mapping.file, Fault::NotAllowed, problem)
                    .line(term.line)
                    .column(column)
                    .cure(
                        "leave column and sum out, the term then converts the topic's own value",
                    ));
            }
        }
    }
    Ok(())
}

/// Chooses the topics.
pub(super) fn choose(
    contents: &Contents,
    options: &OpenOptions,
    file: &str,
) -> Result<Names, LogError> {
    let defaults = OpenOptions::default();
    let mapped = options.mapping.as_ref().map(|mapping| &mapping.mcap);
    let name = |given: &String, default: &String, mapped: Option<&String>| {
        if given == default {
            mapped.unwrap_or(given).clone()
        } else {
            given.clone()
        }
    };
    let external = name(
        &options.external_torque_topic,
        &defaults.external_torque_topic,
        mapped.and_then(|m| m.external_torque_topic.as_ref()),
    );
    let motor_wish = options
        .motor_topic
        .clone()
        .or_else(|| mapped.and_then(|m| m.motor_topic.clone()));
    let joint_wish = options
        .joint_state_topic
        .clone()
        .or_else(|| mapped.and_then(|m| m.joint_state_topic.clone()));

    let topics = Topics::of(contents, file);
    let states = topics.of_kind(MessageKind::JointState);
    let joint = match &joint_wish {
        Some(wanted) => topics.named(wanted, "joint side", &[MessageKind::JointState])?,
        None => {
            let could_be = |topic: &&Topic| {
                Some(&topic.name) != motor_wish.as_ref()
                    && topic.name != external
                    && (motor_wish.is_some() || !is_motor_name(&topic.name))
            };
            let candidates: Vec<&Topic> = states.iter().copied().filter(could_be).collect();
            let found = topics.one_of(&candidates, JOINT_TOPIC, TopicUse::JointSide)?;
            found.ok_or_else(|| topics.no_joint_side(contents))?
        }
    };
    if joint.encoding != "cdr" {
        return Err(LogError::request(
            file,
            format!(
                "topic '{}' is encoded as '{}'; ROS 2 recordings use cdr",
                joint.name, joint.encoding
            ),
        ));
    }
    let motor = match &motor_wish {
        Some(wanted) => {
            let kinds = [MessageKind::DynamicJointState, MessageKind::JointState];
            Some(topics.named(wanted, "motor side", &kinds)?)
        }
        None => {
            let mut candidates = topics.of_kind(MessageKind::DynamicJointState);
            if candidates.is_empty() {
                let motors = states.into_iter();
                let motors = motors.filter(|t| t.name != joint.name && is_motor_name(&t.name));
                candidates = motors.collect();
            }
            topics.one_of(&candidates, MOTOR_TOPIC, TopicUse::MotorSide)?
        }
    };
    if motor.is_some_and(|motor| motor.name == joint.name) {
        return Err(LogError::request(
            file,
            format!(
                "joint side and motor side are the same topic, '{}'; name the motor's (--motor-topic), topics are {}",
                joint.name,
                list(&topics.labels())
            ),
        ));
    }
    let external = (contents.topics.values())
        .find(|topic| topic.name == external && topic.schema.ends_with("JointState"))
        .map(|topic| topic.name.clone());
    let names = Names {
        joint_topic: joint.name.clone(),
        motor_topic: motor.map(|topic| topic.name.clone()),
        motor_is_plain: motor.is_some_and(|motor| {
            MessageKind::of_schema(&motor.schema) == Some(MessageKind::JointState)
        }),
        external_topic: external,
        motor_interface: name(
            &options.motor_interface,
            &defaults.motor_interface,
            mapped.and_then(|m| m.motor_interface.as_ref()),
        ),
        motor_effort_interface: name(
            &options.motor_effort_interface,
            &defaults.motor_effort_interface,
            mapped.and_then(|m| m.motor_effort_interface.as_ref()),
        ),
        temperature_interface: name(
            &options.temperature_interface,
            &defaults.temperature_interface,
            mapped.and_then(|m| m.temperature_interface.as_ref()),
        ),
        joint_effort: match mapped.and_then(|m| m.joint_effort) {
            Some(effort) if options.joint_effort == JointEffort::default() => effort,
            _ => options.joint_effort,
        },
    };
    let interfaces = motor.map_or(Vec::new(), Topic::interfaces);
    let wanted = &names.motor_interface;
    let asked = *wanted != defaults.motor_interface;
    if asked && !interfaces.is_empty() && !interfaces.contains(wanted) {
        let hint = hint(wanted, &interfaces);
        let there = list(&interfaces);
        let reason =
            format!("no interface '{wanted}' on the motor side{hint} interfaces are {there}");
        return Err(LogError::request(file, reason));
    }
    Ok(names)
}

/// The topics of a recording, to choose from.
struct Topics<'a> {
    all: Vec<&'a Topic>,
    file: &'a str,
}

impl<'a> Topics<'a> {
    fn of(contents: &'a Contents, file: &'a str) -> Self {
        let mut all: Vec<&Topic> = contents.topics.values().collect();
        // A topic may have several channels.
        let mut seen = BTreeSet::new();
        all.retain(|topic| seen.insert(&topic.name));
        Topics { all, file }
    }

    fn of_kind(&self, kind: MessageKind) -> Vec<&'a Topic> {
        let all = self.all.iter().copied();
        all.filter(|topic| MessageKind::of_schema(&topic.schema) == Some(kind))
            .collect()
    }

    /// Names with their types.
    fn labels(&self) -> Vec<String> {
        let label = |topic: &&Topic| format!("{} ({})", topic.name, topic.schema);
        self.all.iter().map(label).collect()
    }

    /// The topic asked for.
    fn named(
        &self,
        wanted: &str,
        side: &str,
        kinds: &[MessageKind],
    ) -> Result<&'a Topic, LogError> {
        let Some(topic) = self.all.iter().find(|topic| topic.name == wanted) else {
            let names: Vec<&str> = self.all.iter().map(|topic| topic.name.as_str()).collect();
            let (hint, there) = (hint(wanted, &names), list(&names));
            let reason = format!("no topic '{wanted}'{hint} topics are {there}");
            return Err(LogError::request(self.file, reason));
        };
        match MessageKind::of_schema(&topic.schema) {
            Some(kind) if kinds.contains(&kind) => Ok(topic),
            _ => {
                let types: Vec<&str> = kinds.iter().map(|kind| kind.schema()).collect();
                let (holds, types) = (&topic.schema, types.join(" or "));
                let reason = format!("topic '{wanted}' holds '{holds}'; the {side} is {types}");
                Err(LogError::request(self.file, reason))
            }
        }
    }

    /// The one with the usual name, or the only one; refused where several are left.
    fn one_of(
        &self,
        candidates: &[&'a Topic],
        usual: &str,
        side: TopicUse,
    ) -> Result<Option<&'a Topic>, LogError> {
        let usual = candidates.iter().find(|topic| topic.name == usual);
        match (usual, candidates) {
            (Some(topic), _) | (None, [topic]) => Ok(Some(topic)),
            (None, []) => Ok(None),
            (None, several) => Err(LogError::Ambiguous(Ambiguity {
                file: self.file.to_owned(),
                side,
                candidates: several.iter().map(|t| t.name.clone()).collect(),
            })),
        }
    }

    fn no_joint_side(&self, contents: &Contents) -> LogError {
        let damage = contents.health.damage.first();
        let damage = damage.map_or(String::new(), |damage| {
            format!(" before byte {}: {}", damage.offset, damage.reason)
        });
        LogError::refused(
            self.file,
            format!(
                "no sensor_msgs/msg/JointState topic for the joint side{damage}; topics are {}",
                list(&self.labels())
            ),
        )
    }
}

fn is_motor_name(topic: &str) -> bool {
    topic.to_ascii_lowercase().contains("motor")
}

pub(super) type Joints = (Vec<String>, Channels, Vec<Vec<u8>>);

/// The joints of the recording, what is recorded of each, and their recorded names.
pub(super) fn joints_of(
    contents: &Contents,
    names: &Names,
    mapping: &Mapping,
    file: &str,
) -> Result<Joints, LogError> {
    let roles = [
        (Role::Joint, Some(&names.joint_topic)),
        (Role::Motor, names.motor_topic.as_ref()),
        (Role::External, names.external_topic.as_ref()),
    ];
    // Recorded name on its side, and what it has there.
    let mut found: Vec<(Role, String, Quantities)> = Vec::new();
    let mut known = Vec::new();
    for (role, topic_name) in roles {
        let topics = contents
            .topics
            .values()
            .filter(|topic| Some(&topic.name) == topic_name);
        for (joint, fields) in topics.flat_map(|topic| &topic.joints) {
            known.push(joint.as_bytes().to_vec());
            let quantities = quantities_of(role, fields, names);
            found.push((role, joint.clone(), quantities));
        }
    }
    let mut channels = Channels::default();
    let mut joints: Vec<String> = Vec::new();
    if mapping.joints.is_empty() {
        for (_, joint, quantities) in &found {
            let anything = Quantity::PER_JOINT.iter().any(|q| quantities.has(*q));
            if anything && !joints.contains(joint) {
                joints.push(joint.clone());
            }
        }
    } else {
        let recorded: Vec<&str> = found.iter().map(|(_, joint, _)| joint.as_str()).collect();
        for joint in &mapping.joints {
            let wanted = joint.recorded_name();
            if !recorded.contains(&wanted) {
                let hint = hint(wanted, &recorded);
                return Err(LogError::request(
                    file,
                    format!(
                        "the mapping {} names the joint '{wanted}', which is not recorded{hint} joints are {}",
                        mapping.file,
                        list(&recorded)
                    ),
                ));
            }
            joints.push(joint.name.clone());
        }
    }
    for joint in &joints {
        let mapped = mapping.joints.iter().find(|mapped| mapped.name == *joint);
        let recorded = mapped.map_or(joint.as_str(), JointMap::recorded_name);
        let motor = mapped.map_or(joint.as_str(), JointMap::motor_recorded_name);
        let mut all = Quantities::default();
        for (role, name, quantities) in &found {
            let wanted = if *role == Role::Motor {
                motor
            } else {
                recorded
            };
            if name == wanted {
                for quantity in quantities.iter() {
                    all.insert(quantity);
                }
            }
        }
        channels.temperature |= all.temperature;
        channels.joints.push(all);
    }
    Ok((joints, channels, known))
}

fn quantities_of(role: Role, fields: &Fields, names: &Names) -> Quantities {
    let mut quantities = Quantities::default();
    let plain = [
        (fields.position, Field::Position),
        (fields.velocity, Field::Velocity),
        (fields.effort, Field::Effort),
    ];
    let present = plain
        .into_iter()
        .filter(|(present, _)| *present)
        .map(|(_, field)| field)
        .chain(
            fields
                .interfaces
                .iter()
                .map(|name| Field::Interface(name.as_bytes())),
        );
    for field in present {
        if let Some(quantity) = names.quantity(role, field) {
            quantities.insert(quantity);
        }
    }
    quantities
}
