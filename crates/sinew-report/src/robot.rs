//! What was understood of a robot's folder, as text.

use crate::findings::sentences;
use crate::text::{Told, or_dash};
use sinew_estimate::robot_check::{
    Combination, Finding, FindingKind, GroupEquations, JointCheck, JointMotion, PathUnit,
    RobotCheck, RoutingCheck, TendonForm, TendonRouting,
};
use sinew_figure::{Columns, rounded};

/// Joints, tendons and what looks odd, at most 80 columns wide.
pub fn render(robot: &RobotCheck) -> String {
    let mut out = Told::default();
    let (name, joints, mass) = (
        &robot.name,
        robot.joints.len(),
        rounded(robot.moving_mass_kg, 3),
    );
    let (file, urdf) = (&robot.file, &robot.urdf);
    out.say(format!(
        "{name}: {joints} joints, {mass} kg moving with the first ({file}, {urdf})"
    ));
    let number = |value: Option<f64>, digits| or_dash(value, |v| rounded(v, digits));
    let stiffness = |j: &JointCheck| {
        let key = format!("joints.{}", j.name);
        let lacks = |f: &Finding| f.kind == FindingKind::Gap && f.at.key == key;
        match j.stiffness_nm_per_rad {
            Some(stiffness) => rounded(stiffness, 3),
            None if robot.findings.iter().any(lacks) => "missing".into(),
            None => "rigid".into(),
        }
    };
    out.table(
        Columns::of(&robot.joints)
            .words("joint", |j| match j.kind {
                JointMotion::Revolute => j.name.clone(),
                JointMotion::Prismatic => format!("{} (prismatic: N/m, m)", j.name),
            })
            .column("K\nN·m/rad", |j| stiffness(j))
            .column("motor\nkg·m²", |j| number(j.motor_inertia_kg_m2, 3))
            .column("tendon\nmm", |j| {
                number(j.tendon.as_ref().map(|t| 1e3 * t.length_m), 4)
            })
            .column("pulley\nmm", |j| {
                number(j.tendon.as_ref().map(|t| 1e3 * t.joint_pulley_radius_m), 3)
            })
            .column("mm per\nmrad", |j| {
                number(j.tendon.as_ref().map(|t| t.elongation_m_per_rad), 3)
            })
            .columns(["from\nrad", "to\nrad"], |j| {
                match (j.lower_rad, j.upper_rad) {
                    (Some(lower), Some(upper)) => [lower, upper].map(|rad| rounded(rad, 3)),
                    _ => ["endless".into(), String::new()],
                }
            })
            .table(),
    );
    if let Some(routing) = &robot.routing {
        out.add("\n");
        routing_tables(routing, &mut out);
    }
    let which = |is: &dyn Fn(&JointCheck) -> bool| -> String {
        let own = robot.joints.iter().filter(|j| is(j));
        own.map(|j| j.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let notes = [
        (
            "no tendon, so offsets only in mrad",
            which(&|j| j.stiffness_nm_per_rad.is_some() && j.tendon.is_none()),
        ),
        (
            "friction isn't stated and will be guessed by the stiffness",
            which(&|j| j.friction_stated == Some(false)),
        ),
    ];
    let taut = robot.joints.iter().filter_map(|j| {
        let limit_nm = j.tendon.as_ref()?.taut_up_to_nm?;
        Some(format!("{} {}", j.name, rounded(limit_nm, 3)))
    });
    let taut = Vec::from_iter(taut);
    if !taut.is_empty() {
        out.say(format!(
            "both strands of a loop stay taut up to 2 r f0, beyond which the stiffness is half, N·m: {}",
            taut.join(", ")
        ));
    }
    for (note, joints) in notes.iter().filter(|(_, joints)| !joints.is_empty()) {
        out.say(format!("{note}: {joints}"));
    }
    for warning in &robot.warnings {
        out.say(format!("warning: {warning}"));
    }
    match robot.findings.len() {
        0 => out.add("nothing looks odd\n"),
        n => out.add(format!("\n{n} to look at:\n")),
    }
    for sentence in sentences(&robot.findings) {
        out.say(sentence);
    }
    out.0
}

/// The routing as a table, as a picture, and what can be estimated of it.
fn routing_tables(routing: &RoutingCheck, out: &mut Told) {
    // Lengths in mm, ratios as they are.
    let scale = |t: &TendonRouting| match t.path {
        PathUnit::Metres => 1e3,
        PathUnit::MotorRadians => 1.0,
    };
    let motors = |t: &TendonRouting| {
        let own = routing.motors.iter().zip(&t.drums);
        let own = own.filter(|(_, drum)| **drum != 0.0);
        own.map(|(motor, drum)| format!("{motor} {}", rounded(scale(t) * drum, 3)))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut table = Columns::of(&routing.tendons)
        .words("tendon", |t| t.name.clone())
        .words("kind", |t| match t.kind {
            TendonForm::Loop => "loop",
            TendonForm::Strand => "strand",
        })
        .words("motor, drum\nmm or rad/rad", |t| motors(t));
    for (j, joint) in routing.joints.iter().enumerate() {
        table = table.column(format!("{joint}\nper rad"), move |t| {
            let arm = t.moment_arms.get(j).copied().filter(|arm| *arm != 0.0);
            or_dash(arm, |arm| rounded(scale(t) * arm, 3))
        });
    }
    let table = table.column("stiffness\nN/mm, N·m/rad", |t| match t.path {
        PathUnit::Metres => rounded(1e-3 * t.stiffness, 3),
        PathUnit::MotorRadians => rounded(t.stiffness, 3),
    });
    out.table(table.table());
    out.add(picture(routing));
    for group in &routing.groups {
        let (tendons, joints) = (group.tendons.join(", "), group.joints.join(", "));
        out.say(match (group.equations, group.condition) {
            (GroupEquations::Tendon, Some(condition)) if group.tendons.len() > 1 => format!(
                "{tendons}: one equation per tendon, condition number {}",
                rounded(condition, 2)
            ),
            (GroupEquations::Tendon, _) => format!("{tendons}: one equation per tendon"),
            (GroupEquations::Joint, _) => format!(
                "{tendons}, which move {joints}: these need one equation per joint, which the estimate does not have yet"
            ),
        });
    }
    for Combination { weights } in &routing.unobservable {
        let weights = weights.iter();
        let weights = weights.map(|(tendon, weight)| format!("{tendon} {}", rounded(*weight, 2)));
        out.say(format!(
            "not observable from the motion of the joints: {}; the torque of their motors or a tension sensor would show it",
            weights.collect::<Vec<_>>().join(", ")
        ));
    }
}

/// Every tendon as a line from its motor over the joints: `+` where tension drives a joint positively, `-` where negatively.
fn picture(routing: &RoutingCheck) -> String {
    let width = |names: &mut dyn Iterator<Item = &String>| {
        names.map(|name| name.chars().count()).max().unwrap_or(0)
    };
    let names = width(&mut routing.tendons.iter().map(|t| &t.name));
    let column = width(&mut routing.joints.iter()).max(3) + 2;
    let joints = routing.joints.iter();
    let heads: String = joints.map(|joint| format!("{joint:>column$}")).collect();
    let mut out = format!("\n{:names$}  motor{heads}\n", "");
    for tendon in &routing.tendons {
        let last = tendon.moment_arms.iter().rposition(|arm| *arm != 0.0);
        out += &format!("{:names$}  ==O==", tendon.name);
        for (j, arm) in tendon.moment_arms.iter().enumerate() {
            let (line, mark) = match (last, *arm) {
                (Some(last), _) if j > last => (" ", " "),
                (_, 0.0) => ("-", "-"),
                (_, arm) if arm > 0.0 => ("-", "(+)"),
                _ => ("-", "(-)"),
            };
            let before = column - mark.chars().count();
            out += &line.repeat(before);
            out += mark;
        }
        out.truncate(out.trim_end().len());
        out.push('\n');
    }
    out.push('\n');
    out
}
