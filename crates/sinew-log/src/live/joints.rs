//! Joints of a recording, and the recorded quantities of each.

use super::names::Names;
use super::survey::{Fields, Survey};
use crate::decode::Field;
use crate::error::LogError;
use crate::frame::{Channels, Quantities, Quantity};
use crate::mapping::{JointMap, Mapping};
use crate::sources::TopicUse;
use sinew_files::names::{hint, list};
use sinew_files::{Fault, Located};

/// Names in a recording.
#[derive(Debug, Default)]
pub(crate) struct Joints {
    pub(crate) joints: Vec<String>,
    /// Recorded quantities of each joint.
    pub(crate) channels: Channels,
    /// Tendons with a recorded tension.
    pub(crate) tendons: Vec<String>,
    /// Recorded names of the joints.
    pub(crate) recorded: Vec<Vec<u8>>,
}

/// Joints of the recording, recorded quantities of each, tendons, and their recorded names.
pub(crate) fn joints_of(
    survey: &Survey,
    names: &Names,
    mapping: &Mapping,
    file: &str,
) -> Result<Joints, LogError> {
    // Recorded name on its side, and what it has there.
    let mut found: Vec<(TopicUse, String, Quantities)> = Vec::new();
    let (mut recorded, mut pulled) = (Vec::new(), Vec::<&str>::new());
    for (role, topic_name) in names.sides() {
        let topics = survey
            .topics
            .values()
            .filter(|topic| Some(&topic.name) == topic_name);
        for (joint, fields) in topics.flat_map(|topic| &topic.joints) {
            recorded.push(joint.as_bytes().to_vec());
            let quantities = quantities_of(role, fields, names);
            if role == TopicUse::Tension {
                if quantities.tension && !pulled.contains(&joint.as_str()) {
                    pulled.push(joint);
                }
                continue;
            }
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
            let wanted = if *role == TopicUse::MotorSide {
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
    Ok(Joints {
        tendons: tendons_of(&pulled, names, mapping, file)?,
        joints,
        channels,
        recorded,
    })
}

/// The tendons under the names that Sinew uses, of those `recorded`.
fn tendons_of(
    recorded: &[&str],
    names: &Names,
    mapping: &Mapping,
    file: &str,
) -> Result<Vec<String>, LogError> {
    let Some(first) = mapping.tendons.first() else {
        return Ok(recorded.iter().map(|&name| name.to_owned()).collect());
    };
    let error = |line: u64, problem: String| {
        let located = Located::new(&mapping.file, Fault::Contradiction, problem);
        Err(located.line(line).into())
    };
    let Some(topic) = &names.tension_topic else {
        let problem = format!(
            "tendon '{}' has no topic: name the topic of the tensions of {file} as tension_topic in [mcap]",
            first.name
        );
        return error(first.line, problem);
    };
    for tendon in &mapping.tendons {
        let wanted = tendon.recorded_name();
        if !recorded.contains(&wanted) {
            let (hint, names) = (hint(wanted, recorded), list(recorded));
            let problem = format!(
                "no effort of tendon '{wanted}' in {topic} of {file}{hint} names are {names}"
            );
            return error(tendon.line, problem);
        }
    }
    let names = mapping.tendon_names();
    Ok(names.map(str::to_owned).collect())
}

fn quantities_of(role: TopicUse, fields: &Fields, names: &Names) -> Quantities {
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
