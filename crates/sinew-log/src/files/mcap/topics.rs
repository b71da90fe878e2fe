//! Which topic is what, and which joints the recording holds.

use super::scan::{Contents, Fields, Topic};
use crate::decode::{Field, MessageKind};
use crate::error::LogError;
use crate::frame::{Channels, Quantities, Quantity};
use crate::mapping::{JointEffort, JointMap, Mapping};
use crate::options::OpenOptions;
use sinew_files::names::{hint, list};
use sinew_files::{Fault, Located};

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
    pub(super) external_topic: Option<String>,
    pub(super) motor_interface: String,
    pub(super) motor_effort_interface: String,
    pub(super) temperature_interface: String,
    pub(super) joint_effort: JointEffort,
}

impl Names {
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

    let topics: Vec<&Topic> = contents.topics.values().collect();
    let of_kind = |kind: MessageKind| -> Vec<&Topic> {
        topics
            .iter()
            .copied()
            .filter(|topic| MessageKind::of_schema(&topic.schema) == Some(kind))
            .collect()
    };
    let all_names: Vec<&str> = topics.iter().map(|topic| topic.name.as_str()).collect();
    let request = |reason: String| LogError::request(file, reason);
    let missing = |wanted: &str| {
        let hint = hint(wanted, &all_names);
        request(format!(
            "no topic '{wanted}'{hint} topics are {}",
            list(&all_names)
        ))
    };

    let states = of_kind(MessageKind::JointState);
    let joint = match &joint_wish {
        Some(wanted) => match topics.iter().find(|topic| topic.name == *wanted) {
            None => return Err(missing(wanted)),
            Some(topic)
                if MessageKind::of_schema(&topic.schema) != Some(MessageKind::JointState) =>
            {
                return Err(request(format!(
                    "topic '{wanted}' holds '{}'; the joint side is sensor_msgs/msg/JointState",
                    topic.schema
                )));
            }
            Some(topic) => *topic,
        },
        None => {
            let candidates: Vec<&Topic> = states
                .iter()
                .copied()
                .filter(|topic| {
                    Some(&topic.name) != motor_wish.as_ref()
                        && topic.name != external
                        && (motor_wish.is_some() || !is_motor_name(&topic.name))
                })
                .collect();
            match candidates.iter().find(|topic| topic.name == JOINT_TOPIC) {
                Some(topic) => *topic,
                None => match candidates.as_slice() {
                    [only] => *only,
                    [] => {
                        let damage = contents
                            .health
                            .damage
                            .first()
                            .map(|damage| {
                                format!(" before byte {}: {}", damage.offset, damage.reason)
                            })
                            .unwrap_or_default();
                        return Err(LogError::refused(
                            file,
                            format!(
                                "no sensor_msgs/msg/JointState topic for the joint side{damage}; topics are {}",
                                list(&all_names)
                            ),
                        ));
                    }
                    several => {
                        let names: Vec<&str> = several.iter().map(|t| t.name.as_str()).collect();
                        return Err(request(format!(
                            "several topics could be the joint side: {}; choose one as joint_state_topic",
                            list(&names)
                        )));
                    }
                },
            }
        }
    };
    if joint.encoding != "cdr" {
        return Err(request(format!(
            "topic '{}' is encoded as '{}'; ROS 2 recordings use cdr",
            joint.name, joint.encoding
        )));
    }

    let motor = match &motor_wish {
        Some(wanted) => match topics.iter().find(|topic| topic.name == *wanted) {
            None => return Err(missing(wanted)),
            Some(topic) if MessageKind::of_schema(&topic.schema).is_none() => {
                return Err(request(format!(
                    "topic '{wanted}' holds '{}'; the motor side is control_msgs/msg/DynamicJointState or sensor_msgs/msg/JointState",
                    topic.schema
                )));
            }
            Some(topic) => Some(*topic),
        },
        None => {
            let dynamic = of_kind(MessageKind::DynamicJointState);
            dynamic
                .iter()
                .copied()
                .find(|topic| topic.name == MOTOR_TOPIC)
                .or(match dynamic.as_slice() {
                    [only] => Some(*only),
                    _ => None,
                })
                .or_else(|| {
                    states
                        .iter()
                        .copied()
                        .find(|topic| topic.name != joint.name && is_motor_name(&topic.name))
                })
        }
    };
    let external = topics
        .iter()
        .find(|topic| topic.name == external && topic.schema.ends_with("JointState"))
        .map(|topic| topic.name.clone());
    Ok(Names {
        joint_topic: joint.name.clone(),
        motor_topic: motor.map(|topic| topic.name.clone()),
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
    })
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
