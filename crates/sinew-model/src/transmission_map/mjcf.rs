//! `<tendon>` and `<actuator>` of MuJoCo models.
//!
//! `length = Σ coef q` and a tension `f ≥ 0` is a negative force of MuJoCo, so the path shortens by `l = −Σ coef q`.
//! An actuator on a joint drives that joint alone. Its gear is a scale of torques as often as a ratio and is not read.

use super::{MappedMotor, MappedTendon, Relation, Source, children, most_read};
use crate::arm::urdf::xml::line;
use roxmltree::Node;
use sinew_files::{Fault, Located};
use std::collections::BTreeSet;

/// Millimetres per metre.
const MM_PER_M: f64 = 1000.0;

pub(super) fn read(root: Node<'_, '_>, source: &Source<'_>) -> Result<Vec<MappedTendon>, Located> {
    let mut tendons = Vec::new();
    let elements = |section| {
        let sections = children(root, section);
        sections.flat_map(|s| s.children().filter(Node::is_element))
    };
    for node in elements("tendon").take(most_read()) {
        if node.tag_name().name() != "fixed" {
            let problem = "unsupported: its moment arms depend on the joint positions";
            return Err(source.fault(node, Fault::NotAllowed, problem).cure(
                "remove it here; in robot.toml give moment_arms_mm of each joint in the middle of its motion",
            ));
        }
        tendons.push(fixed(node, source)?);
    }
    if tendons.is_empty() {
        return Err(source
            .fault(root, Fault::MissingKey, "has no <fixed> tendon")
            .cure("a model with <include> must be saved as one file first (mj_saveLastXML)"));
    }
    let mut driven = BTreeSet::new();
    for node in elements("actuator") {
        if tendons.len() >= most_read() {
            break;
        }
        if let Some(wanted) = node.attribute("tendon") {
            let motor = MappedMotor {
                name: node.attribute("name").unwrap_or(wanted).to_owned(),
                gear: match node
                    .attribute("gear")
                    .and_then(|g| g.split_whitespace().next())
                {
                    Some(gear) => Some(source.number(node, gear)?),
                    None => None,
                },
            };
            match tendons.iter_mut().find(|t| t.name == wanted) {
                Some(MappedTendon {
                    relation: Relation::MomentArms { motors, .. },
                    ..
                }) => {
                    motors.push(motor);
                }
                _ => {
                    let problem = format!("tendon '{wanted}' not found");
                    return Err(source.fault(node, Fault::UnknownName, problem));
                }
            }
        } else if let Some(joint) = node.attribute("joint").or(node.attribute("jointinparent")) {
            // Position and velocity servos of one joint are two actuators of one motor.
            if !driven.insert(joint) {
                continue;
            }
            tendons.push(MappedTendon {
                name: joint.to_owned(),
                line: u64::from(line(node)),
                relation: Relation::Ratios {
                    motor: node.attribute("name").unwrap_or(joint).to_owned(),
                    ratios: vec![(joint.to_owned(), 1.0)],
                    motor_at_zero_rad: 0.0,
                },
            });
        }
    }
    Ok(tendons)
}

fn fixed(node: Node<'_, '_>, source: &Source<'_>) -> Result<MappedTendon, Located> {
    let mut moment_arms_mm = Vec::new();
    for joint in children(node, "joint") {
        let name = source.attribute(joint, "joint")?.to_owned();
        let coef = source.number(joint, source.attribute(joint, "coef")?)?;
        if coef != 0.0 {
            moment_arms_mm.push((name, -MM_PER_M * coef));
        }
    }
    Ok(MappedTendon {
        name: source.attribute(node, "name")?.to_owned(),
        line: u64::from(line(node)),
        relation: Relation::MomentArms {
            motors: Vec::new(),
            moment_arms_mm,
        },
    })
}
