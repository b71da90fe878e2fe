//! What was understood of a robot's folder, and what of it looks odd.
//!
//! Reading order: `finding` (types), `keys` (ranges of robot.toml and mappings), `masses`, `limits`
//! (the URDF), `loads` (what the arm asks of its joints), `drives`, `ropes`, `routing`.

mod drives;
mod finding;
mod keys;
mod limits;
pub(crate) mod loads;
mod masses;
mod ropes;
mod routing;

pub use finding::{At, Finding, FindingKind, Judged, Severity, UnitSlip};
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
use sinew_model::transmission::Tendon;
use sinew_rope::Catalogue;

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
    /// Routing of the tendons, where `robot.toml` has `[[tendons]]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub routing: Option<RoutingCheck>,
    /// What a reader of the URDF does with what is unusual in it.
    pub warnings: Vec<String>,
    /// What looks odd, is missing or can't be, the worst first.
    pub findings: Vec<Finding>,
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
    /// Torque up to which both strands of a loop stay taut, `2 r f0`, N·m; none without a pretension, or of an antagonistic pair.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub taut_up_to_nm: Option<f64>,
    /// Elongation at which to tension again, m.
    pub retension_at_m: Option<f64>,
    /// Strain at which to replace the rope.
    pub replace_at_strain_ratio: Option<f64>,
}

impl JsonDocument for RobotCheck {
    const SCHEMA: &'static str = "sinew/robot-check/1";
}

impl RobotCheck {
    /// Of a robot that was read as far as its folder describes it ([`crate::robot_dir::draft`]), with
    /// what keeps it from being used. The ropes are looked up in `catalogue`.
    ///
    /// # Errors
    /// A text that can't be read after all.
    pub fn of(
        loaded: &LoadedRobot,
        gaps: &[Located],
        catalogue: &Catalogue,
    ) -> Result<Self, Located> {
        let mut findings: Vec<Finding> = gaps.iter().map(Finding::of_gap).collect();
        findings.extend(odd(loaded, catalogue)?);
        let mut out = Self::understood(loaded);
        out.findings = findings;
        out.sort();
        Ok(out)
    }

    /// Adds what is odd in a mapping file's text: gear ratios, scales, torque constants, counts.
    ///
    /// # Errors
    /// Broken TOML.
    pub fn add_mapping(&mut self, text: &str, file: &str) -> Result<(), Located> {
        self.findings.extend(Keys::parse(text, file)?.findings());
        self.sort();
        Ok(())
    }

    /// The worst there is.
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
            routing: robot.coupling.as_ref().map(RoutingCheck::of),
            warnings: robot.warnings.clone(),
            findings: Vec::new(),
        }
    }
}

/// What is odd in robot.toml, then in the URDF, then in what one asks of the other.
fn odd(loaded: &LoadedRobot, catalogue: &Catalogue) -> Result<Vec<Finding>, Located> {
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
    // Where masses or gravity can't be right, what follows from them says nothing more.
    let unbelievable = |finding: &Finding| {
        use FindingKind::{ArmMass, Distance, HeavyLink};
        matches!(finding.kind, ArmMass | Distance | HeavyLink)
    };
    let believed = !of_masses.iter().any(unbelievable) && !is_ranged("gravity_m_s2");
    let loads = loads::loads(&robot.arm, &robot.limits);
    let loads = loads.iter().map(|load| Some(load).filter(|_| believed));
    let mut of_drives = Vec::new();
    let mut of_limits = Vec::new();
    for ((i, joint), load) in robot.joint_names().iter().enumerate().zip(loads) {
        let in_urdf = described.joints.iter().find(|j| j.name == *joint);
        of_limits.extend(in_urdf.map(|j| limits::findings(&outline, j, load)));
        if let (Some(transmission), Some(load)) = (robot.transmissions[i].as_ref(), load) {
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

fn tendon(t: &Tendon) -> TendonCheck {
    TendonCheck {
        rope: t.rope.clone(),
        length_m: t.length_m,
        joint_pulley_radius_m: t.joint_pulley_radius_m,
        elongation_m_per_rad: t.elongation_m(1.0),
        pretension_n: t.pretension_n,
        taut_up_to_nm: (t.pretension_n)
            .filter(|_| !t.antagonistic)
            .map(|f0| 2.0 * t.joint_pulley_radius_m * f0),
        retension_at_m: t.retension_at_m,
        replace_at_strain_ratio: t.replace_at_strain,
    }
}
