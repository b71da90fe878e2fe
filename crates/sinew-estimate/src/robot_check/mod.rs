//! Interpretation of a robot's folder, with checks for implausible values.
//!
//! Reading order: `finding` (types), `keys` (ranges of robot.toml and mappings), `masses`, `limits`
//! (the URDF), `loads` (of the arm on its joints), `drives`, `ropes`, `routing`.

mod drives;
mod finding;
mod keys;
mod limits;
pub(crate) mod loads;
mod masses;
mod ropes;
mod routing;

pub use finding::{Finding, FindingKind, Location, RangeCheck, Severity, UnitHint};
pub use routing::{
    Combination, GroupCheck, GroupEquations, PathUnit, RoutingCheck, TendonForm, TendonRouting,
};

use crate::robot_dir::LoadedRobot;
use drives::Drive;
use keys::Keys;
use masses::Outline;
use serde::Serialize;
use sinew_files::{JsonDocument, Located};
use sinew_model::arm::{JointKind, urdf};
use sinew_model::robot::Robot;
use sinew_model::tendons::{Routing, TendonKind};
use sinew_model::transmission::Transmission;
use sinew_rope::Catalogue;

/// Robot as interpreted from its description, and the findings of the check.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RobotCheck {
    /// Name of the robot.
    pub name: String,
    /// Path of `robot.toml`.
    pub file: String,
    /// Source of the URDF: its path, or the recording's `/robot_description`.
    pub urdf: String,
    /// Mass moved by the first joint, kg.
    pub moving_mass_kg: f64,
    /// Joints in the order of Sinew.
    pub joints: Vec<JointCheck>,
    /// Drives of the tendons, if not every joint has its own tendon; then stiffness, motor and tendon are listed here
    /// and not per joint.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<DriveCheck>,
    /// Routing of the tendons, where `robot.toml` has `[[tendons]]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub routing: Option<RoutingCheck>,
    /// Warnings of the URDF parser about unusual content.
    pub warnings: Vec<String>,
    /// Implausible, missing and impossible values, most severe first.
    pub findings: Vec<Finding>,
}

/// Joint of the robot. For a prismatic joint, rad means m and N·m means N.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointCheck {
    /// Name of the joint.
    pub name: String,
    /// Kind of motion: revolute or prismatic.
    pub kind: JointMotion,
    /// Lower limit of the joint position, rad; none for a continuous joint.
    pub lower_rad: Option<f64>,
    /// Upper limit of the joint position, rad; none for a continuous joint.
    pub upper_rad: Option<f64>,
    /// Stiffness, N·m/rad; none for a rigid joint.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Inertia of the motor, reflected to the joint, kg·m².
    pub motor_inertia_kg_m2: Option<f64>,
    /// Whether friction is specified; none for a rigid joint.
    pub friction_specified: Option<bool>,
    /// Tendon of the joint, if described.
    pub tendon: Option<TendonCheck>,
    /// Names of the tendons that cross the joint, if not every joint has its own tendon.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub crossed_by: Vec<String>,
    /// Stiffness of the joint's passive spring, N·m/rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring_nm_per_rad: Option<f64>,
}

/// Drive of a tendon, in the coordinate of one of its joints.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DriveCheck {
    /// Name of the tendon.
    pub name: String,
    /// Joint in whose coordinate the offset is given.
    pub joint: String,
    /// Stiffness at that joint, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Inertia of the motor, reflected to that joint, kg·m².
    pub motor_inertia_kg_m2: Option<f64>,
    /// Rope of the tendon, if described.
    pub tendon: Option<TendonCheck>,
}

/// Kind of joint motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum JointMotion {
    /// Rotation about an axis.
    Revolute,
    /// Translation along an axis.
    Prismatic,
}

/// Tendon geometry and limits.
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
    /// Pretension of the rope, N.
    pub pretension_n: Option<f64>,
    /// Maximum torque at which both strands of a loop are taut, `2 r f0`, N·m; none without a pretension, for an
    /// antagonistic pair, or for a single strand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub taut_up_to_nm: Option<f64>,
    /// Elongation at which to re-tension, m.
    pub retension_at_m: Option<f64>,
    /// Strain at which to replace the rope, as a ratio.
    pub replace_at_strain_ratio: Option<f64>,
}

impl JsonDocument for RobotCheck {
    const SCHEMA: &'static str = "sinew/robot-check/2";
}

impl RobotCheck {
    /// Checks a robot that was loaded as far as its folder describes it ([`crate::robot_dir::draft`]), with
    /// the gaps that prevent its use. Ropes are looked up in `catalogue`.
    ///
    /// # Errors
    /// Returns the location of the fault if robot.toml or the URDF cannot be parsed.
    pub fn of(
        loaded: &LoadedRobot,
        gaps: &[Located],
        catalogue: &Catalogue,
    ) -> Result<Self, Located> {
        let mut findings: Vec<Finding> = gaps.iter().map(Finding::of_gap).collect();
        findings.extend(implausible(loaded, catalogue)?);
        let mut out = Self::understood(loaded);
        out.findings = findings;
        out.sort();
        Ok(out)
    }

    /// Adds the implausible values of a mapping file: gear ratios, scales, torque constants, counts.
    ///
    /// # Errors
    /// Returns the location of the fault if the TOML is invalid.
    pub fn add_mapping(&mut self, text: &str, file: &str) -> Result<(), Located> {
        self.findings.extend(Keys::parse(text, file)?.findings());
        self.sort();
        Ok(())
    }

    /// Returns the highest severity of all findings.
    pub fn worst(&self) -> Option<Severity> {
        self.findings.iter().map(|finding| finding.severity).max()
    }

    fn sort(&mut self) {
        self.findings
            .sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    }

    fn understood(loaded: &LoadedRobot) -> Self {
        let robot = &loaded.robot;
        let joint = |(i, name): (usize, &String)| {
            let transmission = robot.transmissions[i].as_ref().or(robot.cable(i));
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
                friction_specified: transmission.map(|t| t.joint_friction.is_specified()),
                tendon: transmission.and_then(tendon),
                crossed_by: Vec::new(),
                spring_nm_per_rad: None,
            }
        };
        let mut joints = Vec::from_iter(robot.joint_names().iter().enumerate().map(joint));
        let mut drives = Vec::new();
        if !robot.is_named_by_joints() {
            drives.extend((0..robot.axes()).filter_map(|axis| drive(robot, axis)));
            for (i, joint) in joints.iter_mut().enumerate() {
                by_tendons(robot, i, joint);
            }
        }
        Self {
            name: robot.name.clone(),
            file: loaded.file.display().to_string(),
            urdf: loaded.urdf.clone(),
            moving_mass_kg: robot.arm.subtree_mass(0).unwrap_or(0.0),
            joints,
            drives,
            routing: (robot.coupling.as_ref())
                .map(|coupling| RoutingCheck::of(coupling, &robot.limits)),
            warnings: robot.warnings.clone(),
            findings: Vec::new(),
        }
    }
}

/// Returns the implausible values of robot.toml, then of the URDF, then of their combination.
fn implausible(loaded: &LoadedRobot, catalogue: &Catalogue) -> Result<Vec<Finding>, Located> {
    let keys = Keys::parse(&loaded.file_text, &loaded.file.display().to_string())?;
    let described = urdf::outline(&loaded.urdf_text)
        .map_err(|error| error.located(&loaded.urdf, &loaded.urdf_text))?;
    let outline = Outline {
        robot: &described,
        text: &loaded.urdf_text,
        file: &loaded.urdf,
    };
    let mut out = keys.findings();
    let is_ranged = |key: &str| out.iter().any(|finding| finding.at.key == key);
    let of_masses = outline.findings();
    let robot = &loaded.robot;
    // With impossible masses or gravity, the loads derived from them are not checked.
    let invalidates_loads = |finding: &Finding| {
        use FindingKind::{ArmMass, Distance, HeavyLink};
        matches!(finding.kind, ArmMass | Distance | HeavyLink)
    };
    let has_valid_loads = !of_masses.iter().any(invalidates_loads) && !is_ranged("gravity_m_s2");
    let loads = loads::loads(&robot.arm, &robot.limits);
    let loads = loads
        .iter()
        .map(|load| Some(load).filter(|_| has_valid_loads));
    let mut of_drives = Vec::new();
    let mut of_limits = Vec::new();
    for ((i, joint), load) in robot.joint_names().iter().enumerate().zip(loads) {
        let in_urdf = described.joints.iter().find(|j| j.name == *joint);
        of_limits.extend(in_urdf.map(|j| limits::findings(&outline, j, load)));
        let transmission = robot.transmissions[i].as_ref().or(robot.cable(i));
        if let (Some(transmission), Some(load)) = (transmission, load) {
            let effort_nm = Some(robot.limits[i].effort).filter(|effort| *effort > 0.0);
            let drive = Drive {
                joint,
                keys: &keys,
                transmission,
                load,
            };
            of_drives.extend(drive.findings());
            of_drives.extend(drive.tendon(catalogue, effort_nm));
        }
    }
    // A key outside its own range explains the rest.
    of_drives.retain(|finding| !is_ranged(&finding.at.key));
    out.extend(of_masses);
    out.extend(of_limits.into_iter().flatten());
    out.extend(of_drives);
    Ok(out)
}

/// Returns the drive of the tendon on an axis.
fn drive(robot: &Robot, axis: usize) -> Option<DriveCheck> {
    let transmission = robot.transmissions[axis].as_ref()?;
    let routing = transmission.routing.as_ref();
    let joint = routing.map_or(axis, |routing| routing.joint);
    Some(DriveCheck {
        name: robot.tendon_name(axis).to_owned(),
        joint: robot.axis_name(joint).to_owned(),
        stiffness_nm_per_rad: transmission.stiffness_nm_per_rad,
        motor_inertia_kg_m2: transmission.motor_inertia_kg_m2,
        tendon: tendon(transmission),
    })
}

/// Describes a joint by the tendons that cross it.
fn by_tendons(robot: &Robot, i: usize, joint: &mut JointCheck) {
    let routings = robot.transmissions.iter().flatten();
    let routings = || routings.clone().filter_map(|t| t.routing.as_ref());
    let crosses = |routing: &&Routing| routing.moment_arms.get(i).is_some_and(|arm| *arm != 0.0);
    let pulled = routings()
        .filter_map(|r| r.pull.as_ref())
        .flat_map(|pull| &pull.joints);
    let pulled = pulled.clone().find(|pulled| pulled.joint == i);
    let crossed_by = routings().filter(crosses).map(|r| r.tendon.clone());
    joint.crossed_by = crossed_by.collect();
    (
        joint.stiffness_nm_per_rad,
        joint.motor_inertia_kg_m2,
        joint.tendon,
    ) = (None, None, None);
    joint.spring_nm_per_rad = pulled.and_then(|p| Some(p.spring?.stiffness_nm_per_rad));
    if let Some(pulled) = pulled {
        joint.friction_specified = Some(pulled.friction.is_specified());
    }
}

/// Returns the tendon of a transmission.
fn tendon(transmission: &Transmission) -> Option<TendonCheck> {
    let t = transmission.tendon.as_ref()?;
    let pull = transmission.routing.as_ref().and_then(|r| r.pull.as_ref());
    let is_strand = pull.is_some_and(|pull| pull.kind == TendonKind::Strand);
    Some(TendonCheck {
        rope: t.rope.clone(),
        length_m: t.length_m,
        joint_pulley_radius_m: t.joint_pulley_radius_m,
        elongation_m_per_rad: t.elongation_m(1.0),
        pretension_n: t.pretension_n,
        taut_up_to_nm: (t.pretension_n)
            .filter(|_| !t.antagonistic && !is_strand)
            .map(|f0| 2.0 * t.joint_pulley_radius_m * f0),
        retension_at_m: t.retension_at_m,
        replace_at_strain_ratio: t.replace_at_strain,
    })
}
