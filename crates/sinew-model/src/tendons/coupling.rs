//! Validated coupling of joints, motors and tendons.

use super::description::{Coordinate, CouplingDescription, JointDescription, TendonDescription};
use super::error::CouplingError;
use crate::moment_arm::{JointSpring, MomentArm, TendonKind};
use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;

/// Coupling of `n` joints and `m` motors by `T` tendons; never changes after construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    pub(super) joints: Vec<JointDescription>,
    motors: Vec<String>,
    pub(super) tendons: Vec<Tendon>,
    /// `S`, row-major `T × m`.
    pub(super) drums: Vec<f64>,
}

/// Tendon with the indices of its joints.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tendon {
    pub(super) name: String,
    pub(super) kind: TendonKind,
    pub(super) coordinate: Coordinate,
    pub(super) stiffness: f64,
    pub(super) pretension: Option<f64>,
    pub(super) arms: Vec<(usize, MomentArm)>,
}

impl Coupling {
    /// Validates a description.
    ///
    /// # Errors
    /// Returns a [`CouplingError`] with the element, the value, its unit and the remedy: names that are empty, occur twice or do not
    /// exist; a tendon that crosses no joint; values out of range; a strand without pretension that another one
    /// pulls against; a joint that nothing drives, or that strands pull only one way, at `q = 0`, without a spring.
    pub fn new(description: CouplingDescription) -> Result<Self, CouplingError> {
        let CouplingDescription {
            joints,
            motors,
            tendons,
        } = description;
        let joint_names: Vec<&str> = joints.iter().map(|j| j.name.as_str()).collect();
        let motor_names: Vec<&str> = motors.iter().map(String::as_str).collect();
        unique("joint", &joint_names)?;
        unique("motor", &motor_names)?;
        unique(
            "tendon",
            &tendons.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(),
        )?;
        for joint in &joints {
            if let Some(spring) = joint.spring {
                check_spring(&joint.name, spring)?;
            }
        }
        let mut drums = alloc::vec![0.0; tendons.len() * motors.len()];
        let mut resolved = Vec::with_capacity(tendons.len());
        for (i, tendon) in tendons.into_iter().enumerate() {
            check_tendon(&tendon)?;
            let found = indices(
                &tendon.name,
                "motor",
                tendon.drums.iter().map(|d| &d.0),
                &motor_names,
            )?;
            for (k, (_, drum)) in found.into_iter().zip(&tendon.drums) {
                drums[i * motors.len() + k] = *drum;
            }
            let arms = &tendon.moment_arms;
            let found = indices(
                &tendon.name,
                "joint",
                arms.iter().map(|a| &a.0),
                &joint_names,
            )?;
            let arms = tendon.moment_arms.into_iter().map(|(_, arm)| arm);
            resolved.push(Tendon {
                name: tendon.name,
                kind: tendon.kind,
                coordinate: tendon.coordinate,
                stiffness: tendon.stiffness,
                pretension: tendon.pretension,
                arms: found.into_iter().zip(arms).collect(),
            });
        }
        for (j, joint) in joints.iter().enumerate() {
            if !joint.is_rigid {
                check_joint(j, joint, &resolved)?;
            }
        }
        Ok(Self {
            joints,
            motors,
            tendons: resolved,
            drums,
        })
    }

    /// Joints in the order of `q`.
    pub fn joints(&self) -> &[JointDescription] {
        &self.joints
    }

    /// Names of the motors in the order of `theta`.
    pub fn motor_names(&self) -> &[String] {
        &self.motors
    }

    /// Names of the tendons in the order of `delta`.
    pub fn tendon_names(&self) -> impl ExactSizeIterator<Item = &str> {
        self.tendons.iter().map(|tendon| tendon.name.as_str())
    }

    /// Way in which a tendon pulls; `None` where no tendon has the index.
    pub fn kind(&self, tendon: usize) -> Option<TendonKind> {
        self.tendons.get(tendon).map(|tendon| tendon.kind)
    }

    /// Unit of a tendon's extension, drums and moment arms; `None` where no tendon has the index.
    pub fn coordinate(&self, tendon: usize) -> Option<Coordinate> {
        self.tendons.get(tendon).map(|tendon| tendon.coordinate)
    }

    /// Stiffness `k` of a tendon in its coordinate, N/m or N·m/rad; `None` where no tendon has the index.
    pub fn stiffness(&self, tendon: usize) -> Option<f64> {
        self.tendons.get(tendon).map(|tendon| tendon.stiffness)
    }

    /// Elongation of a tendon in metres from its elongation `delta` in its coordinate; `None` where no radius
    /// is specified or no tendon has the index.
    pub fn elongation_m(&self, tendon: usize, delta: f64) -> Option<f64> {
        Some(self.tendons.get(tendon)?.coordinate.metres_per_unit()? * delta)
    }

    /// Drum matrix `S`, row-major `T × m`.
    pub fn drums(&self) -> &[f64] {
        &self.drums
    }

    /// Tendons and joints whose table does not cover `q`, rad, length `n`, so that the moment arm is extrapolated.
    pub fn extrapolated<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = (usize, usize)> + 'a {
        self.tendons
            .iter()
            .enumerate()
            .flat_map(move |(i, tendon)| {
                let outside = move |(joint, arm): &(usize, MomentArm)| match (arm, q.get(*joint)) {
                    (MomentArm::Table(table), Some(q)) => {
                        (!table.covers(*q)).then_some((i, *joint))
                    }
                    _ => None,
                };
                tendon.arms.iter().filter_map(outside)
            })
    }
}

/// Checks that names are not empty and differ.
fn unique(of: &'static str, names: &[&str]) -> Result<(), CouplingError> {
    let invalid = |(i, name): &(usize, &&str)| name.is_empty() || names[..*i].contains(*name);
    match names.iter().enumerate().find(invalid) {
        None => Ok(()),
        Some((_, name)) => Err(CouplingError::Name {
            of,
            name: (*name).to_owned(),
        }),
    }
}

/// Indices of the names that a tendon lists.
fn indices<'a>(
    tendon: &str,
    of: &'static str,
    names: impl Iterator<Item = &'a String>,
    existing: &[&str],
) -> Result<Vec<usize>, CouplingError> {
    let mut found = Vec::new();
    for name in names {
        let Some(index) = existing.iter().position(|e| e == name) else {
            return Err(CouplingError::Unknown {
                tendon: tendon.to_owned(),
                of,
                name: name.clone(),
                existing: existing.join(", "),
            });
        };
        if found.contains(&index) {
            return Err(CouplingError::Twice {
                tendon: tendon.to_owned(),
                of,
                name: name.clone(),
            });
        }
        found.push(index);
    }
    Ok(found)
}

/// Rejects a value that is out of range.
fn check(
    of: &'static str,
    name: &str,
    quantity: &str,
    (value, unit): (f64, &'static str),
    (valid, expected): (bool, &'static str),
) -> Result<(), CouplingError> {
    if valid {
        return Ok(());
    }
    Err(CouplingError::Value {
        of,
        name: name.to_owned(),
        quantity: quantity.to_owned(),
        value,
        unit,
        expected,
    })
}

/// Whether a stiffness is beyond no rope in any unit, and far from where quotients and squares overflow.
fn stiffness(k: f64) -> (bool, &'static str) {
    ((1e-9..=1e12).contains(&k), "between 1e-9 and 1e12")
}

/// Whether the size of a drum, moment arm, pretension or position is, for the same reason.
fn size(value: f64) -> (bool, &'static str) {
    (value.abs() <= 1e6, "at most 1e6 in size")
}

fn check_spring(name: &str, spring: JointSpring) -> Result<(), CouplingError> {
    let (k, rest) = (spring.stiffness_nm_per_rad, spring.rest_rad);
    check(
        "joint",
        name,
        "spring stiffness",
        (k, "N·m/rad"),
        stiffness(k),
    )?;
    check(
        "joint",
        name,
        "rest position of the spring",
        (rest, "rad"),
        size(rest),
    )
}

fn check_tendon(tendon: &TendonDescription) -> Result<(), CouplingError> {
    let name = tendon.name.as_str();
    let [per_rad, stiffness_unit, tension_unit] = tendon.coordinate.units();
    let drums = tendon
        .drums
        .iter()
        .map(|(motor, drum)| ("drum of motor", motor, *drum));
    let arms = tendon
        .moment_arms
        .iter()
        .filter_map(|(joint, arm)| match arm {
            MomentArm::Constant(arm) => Some(("moment arm at joint", joint, *arm)),
            MomentArm::Table(_) => None,
        });
    for (quantity, of, value) in drums.chain(arms) {
        let valid = (
            size(value).0 && value != 0.0,
            "at most 1e6 in size and not 0",
        );
        let quantity = alloc::format!("{quantity} '{of}'");
        check("tendon", name, &quantity, (value, per_rad), valid)?;
    }
    if tendon.moment_arms.is_empty() {
        return Err(CouplingError::NoJoint {
            tendon: tendon.name.clone(),
        });
    }
    let k = tendon.stiffness;
    check(
        "tendon",
        name,
        "stiffness",
        (k, stiffness_unit),
        stiffness(k),
    )?;
    let f0 = tendon.pretension.unwrap_or(0.0);
    let valid = ((0.0..=1e6).contains(&f0), "between 0 and 1e6");
    check("tendon", name, "pretension", (f0, tension_unit), valid)?;
    let r = tendon.coordinate.metres_per_unit().unwrap_or(1.0);
    let valid = (r > 0.0 && size(r).0, "above 0 and at most 1e6");
    check("tendon", name, "drum radius", (r, "m"), valid)
}

/// Checks an elastic joint: held or driven both ways, and by pretensioned strands where they oppose.
fn check_joint(
    index: usize,
    joint: &JointDescription,
    tendons: &[Tendon],
) -> Result<(), CouplingError> {
    let JointDescription { name, spring, .. } = joint;
    let mut loops = 0;
    // The first strand that pulls each way; an arm of 0 may have either sign.
    let mut strands: Vec<(&Tendon, f64)> = Vec::new();
    for tendon in tendons {
        let Some((_, arm)) = tendon.arms.iter().find(|(j, _)| *j == index) else {
            continue;
        };
        match tendon.kind {
            TendonKind::Loop => loops += 1,
            TendonKind::Strand => strands.push((tendon, arm.evaluate(0.0)[1])),
        }
    }
    let is_free = loops == 0 && spring.is_none();
    if is_free && strands.is_empty() {
        return Err(CouplingError::NotDriven {
            joint: name.clone(),
        });
    }
    for (strand, arm) in &strands {
        let other = strands.iter().find(|(_, other)| arm * other < 0.0);
        if let (None, Some((other, _))) = (strand.pretension, other) {
            return Err(CouplingError::NoPretension {
                tendon: strand.name.clone(),
                other: other.name.clone(),
                joint: name.clone(),
            });
        }
    }
    let pulls = |sign: f64| strands.iter().any(|(_, arm)| sign * arm >= 0.0);
    if is_free && !(pulls(1.0) && pulls(-1.0)) {
        return Err(CouplingError::OneSided {
            joint: name.clone(),
        });
    }
    Ok(())
}
