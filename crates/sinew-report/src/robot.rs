//! What was understood of a robot's folder, as text.

use crate::findings::sentences;
use crate::text::{paragraph, plain, table};
use sinew_estimate::robot_check::{Finding, FindingKind, JointCheck, JointMotion, RobotCheck};
use sinew_figure::rounded;

const HEAD: [&str; 8] = [
    "joint",
    "K\nN·m/rad",
    "motor\nkg·m²",
    "tendon\nmm",
    "pulley\nmm",
    "mm per\nmrad",
    "from\nrad",
    "to\nrad",
];

/// Joints, tendons and what looks odd, at most 80 columns wide.
pub fn render(robot: &RobotCheck) -> String {
    let mut out = paragraph(
        &plain(&format!(
            "{}: {} joints, {} kg moving with the first ({}, {})",
            robot.name,
            robot.joints.len(),
            rounded(robot.moving_mass_kg, 3),
            robot.file,
            robot.urdf
        )),
        2,
    );
    let rows = robot.joints.iter().map(|joint| {
        let key = format!("joints.{}", joint.name);
        let lacks = |f: &Finding| f.kind == FindingKind::Gap && f.at.key == key;
        row(joint, robot.findings.iter().any(lacks))
    });
    let rows = rows.collect();
    out.push_str(&table(&HEAD, rows, 1));
    let which = |is: &dyn Fn(&JointCheck) -> bool| -> String {
        let own = robot.joints.iter().filter(|j| is(j));
        own.map(|j| plain(&j.name)).collect::<Vec<_>>().join(", ")
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
        out.push_str(&paragraph(&format!("{note}: {joints}"), 2));
    }
    for warning in &robot.warnings {
        out.push_str(&paragraph(&format!("warning: {}", plain(warning)), 2));
    }
    match robot.findings.len() {
        0 => out.push_str("nothing looks odd\n"),
        n => out.push_str(&format!("\n{n} to look at:\n")),
    }
    for sentence in sentences(&robot.findings) {
        out.push_str(&paragraph(&plain(&sentence), 2));
    }
    out
}

fn row(joint: &JointCheck, lacks: bool) -> Vec<String> {
    let number = |value: Option<f64>, digits| value.map_or("–".into(), |v| rounded(v, digits));
    let tendon = joint.tendon.as_ref();
    let (from, to) = match (joint.lower_rad, joint.upper_rad) {
        (Some(lower), Some(upper)) => (rounded(lower, 3), rounded(upper, 3)),
        _ => ("endless".into(), String::new()),
    };
    vec![
        match joint.kind {
            JointMotion::Revolute => plain(&joint.name),
            JointMotion::Prismatic => format!("{} (prismatic: N/m, m)", plain(&joint.name)),
        },
        joint
            .stiffness_nm_per_rad
            .map_or(if lacks { "missing" } else { "rigid" }.into(), |v| {
                rounded(v, 3)
            }),
        number(joint.motor_inertia_kg_m2, 3),
        number(tendon.map(|t| 1e3 * t.length_m), 4),
        number(tendon.map(|t| 1e3 * t.joint_pulley_radius_m), 3),
        number(tendon.map(|t| t.elongation_m_per_rad), 3),
        from,
        to,
    ]
}
