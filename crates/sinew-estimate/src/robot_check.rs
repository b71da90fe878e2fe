//! What was understood of a robot's folder.

use crate::robot_dir::LoadedRobot;
use serde::Serialize;
use sinew_files::JsonDocument;
use sinew_model::arm::JointKind;
use sinew_model::transmission::Tendon;

/// A robot as Sinew has understood its description.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotCheck {
    /// Its name.
    pub name: String,
    /// `robot.toml` as opened.
    pub file: String,
    /// Where the URDF came from, in words.
    pub urdf: String,
    /// Mass that moves with the first joint, kg.
    pub moving_mass_kg: f64,
    /// Joints in Sinew's order.
    pub joints: Vec<JointCheck>,
    /// What looks odd.
    pub warnings: Vec<String>,
}

/// One joint. Of a prismatic one, rad is m and N·m is N.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointCheck {
    /// Joint.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointMotion,
    /// Lower end of its range, rad; none where it turns without end.
    pub lower_rad: Option<f64>,
    /// Upper end of its range, rad; none where it turns without end.
    pub upper_rad: Option<f64>,
    /// Stiffness, N·m/rad; none where the joint is rigid.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Inertia of the motor, reflected to the joint, kg·m².
    pub motor_inertia_kg_m2: Option<f64>,
    /// Whether friction is stated; none where the joint is rigid.
    pub friction_stated: Option<bool>,
    /// Its tendon, where one is described.
    pub tendon: Option<TendonCheck>,
}

/// What a joint does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JointMotion {
    /// Turns.
    Revolute,
    /// Slides.
    Prismatic,
}

/// A tendon.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TendonCheck {
    /// Catalogue name of the rope.
    pub rope: Option<String>,
    /// Free length, m.
    pub length_m: f64,
    /// Radius of the pulley at the joint, m.
    pub joint_pulley_radius_m: f64,
    /// Elongation per offset, m/rad.
    pub elongation_m_per_rad: f64,
    /// Pretension, N.
    pub pretension_n: Option<f64>,
    /// Elongation at which to tension again, m.
    pub retension_at_m: Option<f64>,
    /// Strain at which to replace the rope.
    pub replace_at_strain_ratio: Option<f64>,
}

impl JsonDocument for RobotCheck {
    const SCHEMA: &'static str = "sinew/robot-check/1";
}

impl RobotCheck {
    /// Of a robot that was read.
    pub fn of(loaded: &LoadedRobot) -> Self {
        let robot = &loaded.robot;
        let joint = |(i, name): (usize, &String)| {
            let transmission = robot.transmissions[i].as_ref();
            let limits = &robot.limits[i];
            let ends = limits.lower.is_finite() && limits.upper.is_finite();
            JointCheck {
                name: name.clone(),
                kind: match robot.arm.joint_kind(i) {
                    Some(JointKind::Prismatic) => JointMotion::Prismatic,
                    _ => JointMotion::Revolute,
                },
                lower_rad: ends.then_some(limits.lower),
                upper_rad: ends.then_some(limits.upper),
                stiffness_nm_per_rad: transmission.map(|t| t.stiffness_nm_per_rad),
                motor_inertia_kg_m2: transmission.and_then(|t| t.motor_inertia_kg_m2),
                friction_stated: transmission.map(|t| t.joint_friction.is_stated()),
                tendon: transmission.and_then(|t| t.tendon.as_ref()).map(tendon),
            }
        };
        Self {
            name: robot.name.clone(),
            file: loaded.file.display().to_string(),
            urdf: loaded.urdf.clone(),
            moving_mass_kg: robot.arm.subtree_mass(0).unwrap_or(0.0),
            joints: robot.joint_names().iter().enumerate().map(joint).collect(),
            warnings: robot.warnings.clone(),
        }
    }
}

fn tendon(t: &Tendon) -> TendonCheck {
    TendonCheck {
        rope: t.rope.clone(),
        length_m: t.length_m,
        joint_pulley_radius_m: t.joint_pulley_radius_m,
        elongation_m_per_rad: t.elongation_m(1.0),
        pretension_n: t.pretension_n,
        retension_at_m: t.retension_at_m,
        replace_at_strain_ratio: t.replace_at_strain,
    }
}
