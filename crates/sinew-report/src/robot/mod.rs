//! Check of a robot description as text.

pub(crate) mod messages;

use crate::session::{combination, remedy};
use crate::text::{TerminalText, or_dash};
use messages::diagnostics;
use sinew_estimate::robot_check::{
    DriveCheck, Finding, FindingKind, GroupEquations, JointCheck, JointMotion, PathUnit,
    RobotCheck, RoutingCheck, TendonCheck, TendonForm, TendonRouting,
};
use sinew_figure::{Columns, Table, rounded};

/// Renders joints, tendons, routing and implausible values as text of at most 80 columns.
pub fn render(robot: &RobotCheck) -> String {
    let mut out = TerminalText::default();
    let (name, joints, mass) = (
        &robot.name,
        robot.joints.len(),
        rounded(robot.moving_mass_kg, 3),
    );
    let (file, urdf) = (&robot.file, &robot.urdf);
    out.paragraph(format!(
        "{name}: {joints} joints, moving mass {mass} kg ({file}, {urdf})"
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
    let name = |j: &JointCheck| match j.kind {
        JointMotion::Revolute => j.name.clone(),
        JointMotion::Prismatic => format!("{} (prismatic: N/m, m)", j.name),
    };
    let range = |j: &JointCheck| match (j.lower_rad, j.upper_rad) {
        (Some(lower), Some(upper)) => [lower, upper].map(|rad| rounded(rad, 3)),
        _ => ["continuous".into(), String::new()],
    };
    let ends = ["from\n(rad)", "to\n(rad)"];
    if robot.drives.is_empty() {
        out.table(
            Columns::of(&robot.joints)
                .words("joint", |j| name(j))
                .column("K\n(N·m/rad)", |j| stiffness(j))
                .column("motor\n(kg·m²)", |j| number(j.motor_inertia_kg_m2, 3))
                .column("tendon\n(mm)", |j| {
                    number(j.tendon.as_ref().map(|t| 1e3 * t.length_m), 4)
                })
                .column("pulley\n(mm)", |j| {
                    number(j.tendon.as_ref().map(|t| 1e3 * t.joint_pulley_radius_m), 3)
                })
                .column("mm per\nmrad", |j| {
                    number(j.tendon.as_ref().map(|t| t.elongation_m_per_rad), 3)
                })
                .columns(ends, |j| range(j))
                .table(),
        );
    } else {
        let driven = |j: &JointCheck| match (j.crossed_by.is_empty(), j.spring_nm_per_rad) {
            (false, _) => j.crossed_by.join(", "),
            (true, Some(_)) => "spring".into(),
            (true, None) => stiffness(j),
        };
        let mut joints = Columns::of(&robot.joints)
            .words("joint", |j| name(j))
            .words("driven by", |j| driven(j));
        if robot.joints.iter().any(|j| j.spring_nm_per_rad.is_some()) {
            joints = joints.column("spring\n(N·m/rad)", |j| number(j.spring_nm_per_rad, 3));
        }
        out.table(joints.columns(ends, |j| range(j)).table());
        out.add("\n");
        out.table(drives(&robot.drives));
    }
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
            "no tendon in robot.toml, offsets in mrad only",
            match robot.drives.is_empty() {
                true => which(&|j| j.stiffness_nm_per_rad.is_some() && j.tendon.is_none()),
                false => {
                    let bare = robot.drives.iter().filter(|d| d.tendon.is_none());
                    bare.map(|d| d.name.as_str()).collect::<Vec<_>>().join(", ")
                }
            },
        ),
        (
            "friction not specified, default derived from the stiffness",
            which(&|j| j.friction_specified == Some(false)),
        ),
    ];
    let of_joints = robot.joints.iter().map(|j| (&j.name, &j.tendon));
    let of_drives = robot.drives.iter().map(|d| (&d.name, &d.tendon));
    let taut = of_joints.chain(of_drives).filter_map(|(name, tendon)| {
        let limit_nm = tendon.as_ref()?.taut_up_to_nm?;
        Some(format!("{name} {}", rounded(limit_nm, 3)))
    });
    let taut = Vec::from_iter(taut);
    if !taut.is_empty() {
        out.paragraph(format!(
            "torque up to which both strands of a loop stay taut (2 r f0; half the stiffness beyond), N·m: {}",
            taut.join(", ")
        ));
    }
    for (note, joints) in notes.iter().filter(|(_, joints)| !joints.is_empty()) {
        out.paragraph(format!("{note}: {joints}"));
    }
    for warning in &robot.warnings {
        out.paragraph(format!("warning: {warning}"));
    }
    match robot.findings.len() {
        0 => out.add("no implausible values\n"),
        n => out.add(format!("\nfindings: {n}\n")),
    }
    for finding in diagnostics(&robot.findings) {
        out.paragraph(finding);
    }
    out.0
}

/// Tabulates the drives of tendons that are not joints, in the coordinate of one joint each.
fn drives(drives: &[DriveCheck]) -> Table {
    let number = |value: Option<f64>, digits| or_dash(value, |v| rounded(v, digits));
    let rope = |d: &DriveCheck, value: &dyn Fn(&TendonCheck) -> f64, digits| {
        number(d.tendon.as_ref().map(value), digits)
    };
    Columns::of(drives)
        .words("tendon", |d| &d.name)
        .words("at joint", |d| &d.joint)
        .column("K\n(N·m/rad)", |d| rounded(d.stiffness_nm_per_rad, 3))
        .column("motor\n(kg·m²)", |d| number(d.motor_inertia_kg_m2, 3))
        .column("tendon\n(mm)", |d| rope(d, &|t| 1e3 * t.length_m, 4))
        .column("pulley\n(mm)", |d| {
            rope(d, &|t| 1e3 * t.joint_pulley_radius_m, 3)
        })
        .column("mm per\nmrad", |d| rope(d, &|t| t.elongation_m_per_rad, 3))
        .table()
}

/// Renders the routing as table and picture, and its observability.
fn routing_tables(routing: &RoutingCheck, out: &mut TerminalText) {
    // Lengths in mm, ratios without unit.
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
        .words("motor, drum\n(mm or rad/rad)", |t| motors(t));
    for (j, joint) in routing.joints.iter().enumerate() {
        table = table.column(format!("{joint}\nper rad"), move |t| {
            let arm = t.moment_arms.get(j).copied().filter(|arm| *arm != 0.0);
            or_dash(arm, |arm| rounded(scale(t) * arm, 3))
        });
    }
    let table = table.column("stiffness\n(N/mm, N·m/rad)", |t| match t.path {
        PathUnit::Metres => rounded(1e-3 * t.stiffness, 3),
        PathUnit::MotorRadians => rounded(t.stiffness, 3),
    });
    out.table(table.table());
    out.add(picture(routing));
    for group in &routing.groups {
        let (tendons, joints) = (group.tendons.join(", "), group.joints.join(", "));
        out.paragraph(match (group.equations, group.condition) {
            (GroupEquations::Tendon, Some(condition)) if group.tendons.len() > 1 => format!(
                "{tendons}: one equation per tendon, condition number {}",
                rounded(condition, 2)
            ),
            (GroupEquations::Tendon, _) => format!("{tendons}: one equation per tendon"),
            (GroupEquations::Joint, _) => format!(
                "{tendons}: one equation per joint ({joints}); {}",
                match routing.hides_any(&group.tendons) {
                    true => "not every elongation is observable from motion",
                    false => "every elongation is observable from motion",
                }
            ),
        });
    }
    for unobservable in &routing.unobservable {
        let weights = unobservable.weights.iter();
        let combination = combination(weights.map(|(tendon, weight)| (tendon.as_str(), *weight)));
        let remedy = remedy(unobservable.shown_by_motor_torque, true);
        out.paragraph(format!(
            "not observable from joint motion: {combination}{remedy}"
        ));
    }
}

/// Draws every tendon as a line from its motor over the joints, with the sign of the joint torque under tension.
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
