//! The `<transmission>` elements of ros_control and ros2_control.
//!
//! They differ in the location of the numbers. ros_control sorts two joints by their roles; ros2_control takes them
//! in the
//! file's order. The ratio of a simple transmission is the actuator's in ros_control and the joint's in ros2_control.

use super::{MappedTendon, Relation, Source, children, most_read};
use crate::arm::urdf::xml::line;
use roxmltree::Node;
use sinew_files::{Fault, Located};

/// Joint or actuator of a transmission.
struct Part<'a, 'i> {
    node: Node<'a, 'i>,
    name: &'a str,
    reduction: f64,
    offset_rad: f64,
}

/// Format of a transmission.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Ros1,
    Ros2,
}

impl Format {
    /// Name of the ratio's element, and its name in the other format.
    fn reduction(self) -> [&'static str; 2] {
        match self {
            Self::Ros1 => ["mechanicalReduction", "mechanical_reduction"],
            Self::Ros2 => ["mechanical_reduction", "mechanicalReduction"],
        }
    }
}

pub(super) fn read(root: Node<'_, '_>, source: &Source<'_>) -> Result<Vec<MappedTendon>, Located> {
    let mut tendons = Vec::new();
    if root.tag_name().name() == "robot" {
        for node in children(root, "transmission").take(most_read()) {
            tendons.extend(transmission(node, Format::Ros1, source)?);
        }
    }
    let components: Vec<_> = match root.tag_name().name() {
        "robot" => children(root, "ros2_control").collect(),
        _ => vec![root],
    };
    let transmissions = components
        .into_iter()
        .flat_map(|c| children(c, "transmission"));
    for node in transmissions.take(most_read()) {
        tendons.extend(transmission(node, Format::Ros2, source)?);
    }
    match tendons.is_empty() {
        false => Ok(tendons),
        true => Err(source
            .fault(root, Fault::MissingKey, "has no <transmission>")
            .cure("add one, or leave --transmissions out: each joint then has a motor of its own")),
    }
}

fn transmission(
    node: Node<'_, '_>,
    format: Format,
    source: &Source<'_>,
) -> Result<Vec<MappedTendon>, Located> {
    let tag = match format {
        Format::Ros1 => "type",
        Format::Ros2 => "plugin",
    };
    let text = children(node, tag).next().and_then(|n| n.text());
    let Some(plugin) = text.or_else(|| node.attribute("type")).map(str::trim) else {
        return Err(source.fault(node, Fault::MissingKey, format!("has no <{tag}>")));
    };
    let is_simple = plugin.ends_with("/SimpleTransmission") || plugin == "SimpleTransmission";
    let mut joints = parts(node, "joint", format, source)?;
    let mut motors = parts(node, "actuator", format, source)?;
    if !is_simple {
        for (parts, roles) in [
            (&mut joints, ["joint1", "joint2"]),
            (&mut motors, ["actuator1", "actuator2"]),
        ] {
            order(node, parts, roles, format, source)?;
        }
    }
    let row = |motor: &Part<'_, '_>, ratios: &[(&Part<'_, '_>, f64)]| MappedTendon {
        name: motor.name.to_owned(),
        line: u64::from(line(motor.node)),
        relation: Relation::Ratios {
            motor: motor.name.to_owned(),
            ratios: ratios
                .iter()
                .map(|(j, n)| (j.name.to_owned(), *n))
                .collect(),
            motor_at_zero_rad: -ratios.iter().map(|(j, n)| n * j.offset_rad).sum::<f64>(),
        },
    };
    match (plugin.rsplit('/').next(), &joints[..], &motors[..]) {
        (Some("SimpleTransmission"), [j], [a]) => {
            let (used, unused) = match format {
                Format::Ros1 => (a, j),
                Format::Ros2 => (j, a),
            };
            if unused.reduction != 1.0 {
                let problem = "the loader of a simple transmission ignores this ratio";
                let place = used.node.tag_name().name();
                return Err(source
                    .fault(unused.node, Fault::Contradiction, problem)
                    .value(unused.reduction)
                    .cure(format!("move it to the <{place}>")));
            }
            Ok(vec![row(a, &[(j, used.reduction)])])
        }
        // A component of one joint may leave its actuator out.
        (Some("SimpleTransmission"), [j], []) if format == Format::Ros2 => {
            Ok(vec![row(j, &[(j, j.reduction)])])
        }
        (Some("DifferentialTransmission"), [j1, j2], [a1, a2]) => {
            let [n1, n2] = [j1.reduction, j2.reduction];
            Ok(vec![
                row(a1, &[(j1, a1.reduction * n1), (j2, a1.reduction * n2)]),
                row(a2, &[(j1, a2.reduction * n1), (j2, -a2.reduction * n2)]),
            ])
        }
        (Some("FourBarLinkageTransmission"), [j1, j2], [a1, a2]) => Ok(vec![
            row(a1, &[(j1, j1.reduction * a1.reduction)]),
            row(a2, &[(j1, a2.reduction), (j2, a2.reduction * j2.reduction)]),
        ]),
        (
            Some("SimpleTransmission" | "DifferentialTransmission" | "FourBarLinkageTransmission"),
            ..,
        ) => {
            let n = if is_simple { 1 } else { 2 };
            let (joints, motors) = (joints.len(), motors.len());
            Err(source.fault(
                node,
                Fault::NotAllowed,
                format!(
                    "{plugin} needs {n} <joint> and {n} <actuator>, found {joints} and {motors}"
                ),
            ))
        }
        _ => Err(source
            .fault(node, Fault::NotAllowed, "unsupported transmission")
            .value(format!("'{}'", sinew_files::names::shorten(plugin, 80)))
            .cure(
                "supported are SimpleTransmission, DifferentialTransmission and \
                 FourBarLinkageTransmission; write others as a table of ratios (CSV)",
            )),
    }
}

fn parts<'a, 'i>(
    transmission: Node<'a, 'i>,
    tag: &'static str,
    format: Format,
    source: &Source<'_>,
) -> Result<Vec<Part<'a, 'i>>, Located> {
    let [reduction, foreign] = format.reduction();
    let number = |node, tag, default| match children(node, tag).next() {
        Some(child) => source.number(child, child.text().unwrap_or_default()),
        None => Ok(default),
    };
    let part = |node| {
        if let Some(child) = children(node, foreign).next() {
            return Err(source
                .fault(child, Fault::UnknownKey, "is not read in this format")
                .cure(format!("write <{reduction}>")));
        }
        let ratio = number(node, reduction, 1.0)?;
        if ratio == 0.0 {
            let problem = format!("<{reduction}> must not be 0");
            return Err(source.fault(node, Fault::NotAllowed, problem).value(ratio));
        }
        Ok(Part {
            node,
            name: source.attribute(node, "name")?,
            reduction: ratio,
            offset_rad: number(node, "offset", 0.0)?,
        })
    };
    children(transmission, tag).map(part).collect()
}

/// Puts two parts in the order of their roles, as the loader of the format does.
fn order(
    transmission: Node<'_, '_>,
    parts: &mut [Part<'_, '_>],
    roles: [&str; 2],
    format: Format,
    source: &Source<'_>,
) -> Result<(), Located> {
    let role = |part: &Part<'_, '_>| {
        let text = children(part.node, "role").next().and_then(|n| n.text());
        let text = text.or_else(|| part.node.attribute("role"));
        text.map(|t| t.trim().to_owned())
    };
    let [first, second] = parts else {
        return Ok(()); // The number of parts is checked with the type.
    };
    let found = [role(first), role(second)];
    let found = found.each_ref().map(|role| role.as_deref());
    let [one, two] = roles;
    match (found, format) {
        ([Some(a), Some(b)], _) if a == one && b == two => Ok(()),
        ([Some(a), Some(b)], Format::Ros1) if a == two && b == one => {
            parts.swap(0, 1);
            Ok(())
        }
        ([Some(a), Some(b)], Format::Ros2) if a == two && b == one => {
            let problem = format!("'{two}' precedes '{one}', and ros2_control ignores roles");
            Err(source
                .fault(transmission, Fault::Contradiction, problem)
                .cure(format!("write '{one}' first")))
        }
        // Older models of ros2_control leave roles out.
        ([None, None], Format::Ros2) => Ok(()),
        _ => {
            let found = found.map(|role| role.unwrap_or("none"));
            let problem = format!(
                "expected the roles {one} and {two}, found {}",
                found.join(" and ")
            );
            Err(source.fault(transmission, Fault::NotAllowed, problem))
        }
    }
}
