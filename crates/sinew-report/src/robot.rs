//! What was understood of a robot's folder, as text.

use crate::findings::sentences;
use crate::text::{Told, or_dash};
use sinew_estimate::robot_check::{Finding, FindingKind, JointCheck, JointMotion, RobotCheck};
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
