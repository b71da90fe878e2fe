//! `sinew robot`: what a robot's folder says.

use crate::terminal::{Failure, Finish, answer};
use crate::text::{paragraph, plain, table};
use clap::{Args, Subcommand};
use sinew_estimate::robot_dir;
use sinew_estimate::robot_dir::LoadedRobot;
use sinew_figure::rounded;
use sinew_model::arm::JointKind;
use sinew_model::transmission::Transmission;
use std::path::PathBuf;

/// Check a robot's description
#[derive(Debug, Subcommand)]
pub(crate) enum Robot {
    Check(Check),
}

impl Robot {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Check(check) => check.run(),
        }
    }
}

/// Read robot.toml and the URDF and show what Sinew understood
///
/// Joints in the order Sinew uses, their stiffness and tendons, and what looks odd. The column
/// "mm per mrad" turns an offset into an elongation.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew robot check robots/biorob-like")]
pub(crate) struct Check {
    /// Robot's folder, or robot.toml itself
    dir: PathBuf,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Check {
    fn run(&self) -> Result<Finish, Failure> {
        let loaded = robot_dir::load(&self.dir, None)?;
        if self.json {
            answer(&(serde_json::to_string_pretty(&json(&loaded))? + "\n"))?;
        } else {
            answer(&told(&loaded))?;
        }
        Ok(Finish::Complete)
    }
}

const MM: f64 = 1e3;

fn kind(loaded: &LoadedRobot, i: usize) -> &'static str {
    match loaded.robot.arm.joint_kind(i) {
        Some(JointKind::Prismatic) => "prismatic",
        _ => "revolute",
    }
}

fn told(loaded: &LoadedRobot) -> String {
    let robot = &loaded.robot;
    let mass = robot.arm.subtree_mass(0).unwrap_or(0.0);
    let mut out = paragraph(
        &plain(&format!(
            "{}: {} joints, {} kg moving with the first ({}, {})",
            robot.name,
            robot.arm.dof(),
            rounded(mass, 3),
            loaded.file.display(),
            loaded.urdf
        )),
        2,
    );
    let head = [
        "joint",
        "K\nN·m/rad",
        "motor\nkg·m²",
        "tendon\nmm",
        "pulley\nmm",
        "mm per\nmrad",
        "from\nrad",
        "to\nrad",
    ];
    let rows = robot
        .joint_names()
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let none = || "–".to_string();
            let transmission = robot.transmissions[i].as_ref();
            let tendon = transmission.and_then(|t| t.tendon.as_ref());
            let limits = &robot.limits[i];
            vec![
                match kind(loaded, i) {
                    "revolute" => plain(name),
                    kind => format!("{} ({kind}: N/m, m)", plain(name)),
                },
                transmission.map_or("rigid".into(), |t| rounded(t.stiffness_nm_per_rad, 3)),
                transmission
                    .and_then(|t| t.motor_inertia_kg_m2)
                    .map_or_else(none, |v| rounded(v, 3)),
                tendon.map_or_else(none, |t| rounded(MM * t.length_m, 4)),
                tendon.map_or_else(none, |t| rounded(MM * t.joint_pulley_radius_m, 3)),
                tendon.map_or_else(none, |t| rounded(MM * t.elongation_m(1e-3), 3)),
                if limits.lower.is_finite() && limits.upper.is_finite() {
                    rounded(limits.lower, 3)
                } else {
                    "endless".into()
                },
                if limits.lower.is_finite() && limits.upper.is_finite() {
                    rounded(limits.upper, 3)
                } else {
                    String::new()
                },
            ]
        })
        .collect();
    out.push_str(&table(&head, rows, 1));
    let which = |is: &dyn Fn(&Transmission) -> bool| -> String {
        let joints = robot.joint_names().iter().zip(&robot.transmissions);
        let own = joints.filter(|(_, t)| t.as_ref().is_some_and(is));
        own.map(|(name, _)| plain(name))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let notes = [
        (
            "no tendon, so offsets only in mrad",
            which(&|t| t.tendon.is_none()),
        ),
        (
            "friction isn't stated and will be guessed by the stiffness",
            which(&|t| !t.joint_friction.is_stated()),
        ),
    ];
    for (note, joints) in notes.iter().filter(|(_, joints)| !joints.is_empty()) {
        out.push_str(&paragraph(&format!("{note}: {joints}"), 2));
    }
    for warning in &robot.warnings {
        out.push_str(&paragraph(&format!("warning: {}", plain(warning)), 2));
    }
    out
}

fn json(loaded: &LoadedRobot) -> serde_json::Value {
    let robot = &loaded.robot;
    let joints: Vec<serde_json::Value> = robot
        .joint_names()
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let transmission = robot.transmissions[i].as_ref();
            let tendon = transmission.and_then(|t| t.tendon.as_ref());
            serde_json::json!({
                "name": name,
                "kind": kind(loaded, i),
                "lower_rad": robot.limits[i].lower,
                "upper_rad": robot.limits[i].upper,
                "stiffness_nm_per_rad": transmission.map(|t| t.stiffness_nm_per_rad),
                "motor_inertia_kg_m2": transmission.and_then(|t| t.motor_inertia_kg_m2),
                "friction_stated": transmission.map(|t| t.joint_friction.is_stated()),
                "tendon": tendon.map(|t| serde_json::json!({
                    "rope": t.rope,
                    "length_mm": MM * t.length_m,
                    "joint_pulley_radius_mm": MM * t.joint_pulley_radius_m,
                    "pretension_n": t.pretension_n,
                    "retension_at_mm": t.retension_at_m.map(|m| MM * m),
                    "replace_at_strain_percent": t.replace_at_strain.map(|s| 100.0 * s),
                })),
            })
        })
        .collect();
    serde_json::json!({
        "name": robot.name,
        "file": loaded.file.display().to_string(),
        "urdf": loaded.urdf,
        "joints": joints,
        "warnings": robot.warnings,
    })
}
