//! Bodies in, re-based arm out.

use super::{Arm, ArmJoint, GRAVITY_M_S2, JointKind, LinkFrame};
use crate::vec3::{
    IDENTITY, Mat3, Vec3, add, add_scaled, mul, norm, point_inertia, rotate, rotate_back,
    rotation_with_z, scale, sub, transpose,
};
use alloc::collections::BTreeSet;
use alloc::string::String;
use alloc::vec::Vec;

/// Position and orientation of a frame in another: `x_outer = R x_inner + r`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose {
    /// Rotation matrix `outer_from_inner`.
    pub rotation: Mat3,
    /// Origin of the inner frame in the outer one, m.
    pub translation: Vec3,
}

impl Pose {
    /// The frame itself.
    pub const IDENTITY: Self = Self {
        rotation: IDENTITY,
        translation: [0.0; 3],
    };

    /// URDF's `<origin xyz rpy>`; m and rad.
    pub fn from_xyz_rpy(xyz: Vec3, rpy: Vec3) -> Self {
        Self {
            rotation: crate::vec3::rotation_from_rpy(rpy),
            translation: xyz,
        }
    }

    /// `outer_from_middle * middle_from_inner`.
    pub fn then(&self, inner: &Self) -> Self {
        Self {
            rotation: mul(&self.rotation, &inner.rotation),
            translation: self.apply(inner.translation),
        }
    }

    /// A point of the inner frame, in the outer one.
    pub fn apply(&self, x: Vec3) -> Vec3 {
        add(rotate(&self.rotation, x), self.translation)
    }
}

/// Mass properties of a body in some frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyInertia {
    /// Mass of the body, kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub com: Vec3,
    /// Inertia about the centre of mass, axes of the frame, kg·m². Symmetric.
    pub inertia: Mat3,
}

impl BodyInertia {
    /// Bodies without any mass.
    pub const ZERO: Self = Self {
        mass: 0.0,
        com: [0.0; 3],
        inertia: [[0.0; 3]; 3],
    };

    /// A point mass at `com`.
    pub fn point(mass: f64, com: Vec3) -> Self {
        Self {
            mass,
            com,
            inertia: [[0.0; 3]; 3],
        }
    }

    /// The same body, seen from the frame in which `pose` places this one.
    pub fn seen_from(&self, pose: &Pose) -> Self {
        let r = &pose.rotation;
        Self {
            mass: self.mass,
            com: pose.apply(self.com),
            inertia: mul(&mul(r, &self.inertia), &transpose(r)),
        }
    }

    /// Both bodies as one, in the frame both are given in.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            // Massless bodies still add their implausible inertias.
            return Self {
                inertia: add_scaled(&self.inertia, &other.inertia, 1.0),
                ..*self
            };
        }
        let com = scale(
            add(scale(self.com, self.mass), scale(other.com, other.mass)),
            1.0 / mass,
        );
        let mut inertia = add_scaled(&self.inertia, &other.inertia, 1.0);
        for body in [self, other] {
            let arm = sub(body.com, com);
            inertia = add_scaled(&inertia, &point_inertia(body.mass, arm), 1.0);
        }
        Self { mass, com, inertia }
    }

    /// First moment and inertia about the frame's origin.
    pub(crate) fn at_origin(&self) -> (Vec3, Mat3) {
        (
            scale(self.com, self.mass),
            add_scaled(&self.inertia, &point_inertia(self.mass, self.com), 1.0),
        )
    }
}

/// A joint and the body it carries, as a user describes them.
#[derive(Debug, Clone, PartialEq)]
pub struct BodySpec {
    /// Name of the joint.
    pub name: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Joint that carries this one (an index into the bodies already added); `None` is the base.
    pub parent: Option<usize>,
    /// Joint frame at `q = 0` in the parent's joint frame (or in the base).
    pub placement: Pose,
    /// Axis in the joint frame; any length but zero.
    pub axis: Vec3,
    /// Mass properties in the joint frame.
    pub body: BodyInertia,
}

/// Reason why an arm could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArmError {
    /// No joint moves.
    #[error("the robot has no moving joint")]
    NoJoint,
    /// Two joints share a name.
    #[error("joint '{0}' is defined twice; joint names must be unique")]
    DuplicateJoint(String),
    /// Parent index at or past the body itself.
    #[error("joint '{joint}': parent {parent} is not among the joints added before it")]
    Parent {
        /// Joint at fault.
        joint: String,
        /// Index of the parent that was passed.
        parent: usize,
    },
    /// Axis of no length.
    #[error("joint '{0}': the axis has no direction (length 0); give e.g. xyz=\"0 0 1\"")]
    Axis(String),
    /// A number is NaN or infinite.
    #[error("{place}: {what} is {value}; it must be a finite number")]
    NotFinite {
        /// Joint or link.
        place: String,
        /// Name of the quantity.
        what: &'static str,
        /// Value of the quantity.
        value: f64,
    },
    /// Mass below zero.
    #[error("{place}: mass is {mass_kg} kg; a mass cannot be negative")]
    NegativeMass {
        /// Joint or link.
        place: String,
        /// Mass found, kg.
        mass_kg: f64,
    },
}

/// Builds an [`Arm`] body by body, parents first.
///
/// ```
/// use sinew_model::arm::{ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};
/// // A pendulum: 1 kg at 0.5 m below a horizontal axis.
/// let arm = ArmBuilder::new()
///     .body(BodySpec {
///         name: "swing".into(),
///         kind: JointKind::Revolute,
///         parent: None,
///         placement: Pose::IDENTITY,
///         axis: [0.0, 1.0, 0.0],
///         body: BodyInertia::point(1.0, [0.0, 0.0, -0.5]),
///     })
///     .build()?;
/// let mut ws = sinew_model::arm::ArmWorkspace::new(&arm);
/// let terms = arm.momentum(&mut ws, &[core::f64::consts::FRAC_PI_2], &[2.0])?;
/// assert!((terms.p[0] - 1.0 * 0.5 * 0.5 * 2.0).abs() < 1e-15); // p = m l² dq
/// assert!((terms.g[0] - 1.0 * 9.81 * 0.5).abs() < 1e-15); // g = m g l sin q
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ArmBuilder {
    specs: Vec<BodySpec>,
    links: Vec<(String, Option<usize>, Pose)>,
    gravity_world: Vec3,
    world_from_base: Mat3,
}

impl Default for ArmBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl ArmBuilder {
    /// An empty arm on an upright base, gravity `[0, 0, −9.81]` m/s².
    pub fn new() -> Self {
        Self {
            specs: Vec::new(),
            links: Vec::new(),
            gravity_world: [0.0, 0.0, -GRAVITY_M_S2],
            world_from_base: IDENTITY,
        }
    }

    /// Gravitational acceleration in the world frame, m/s².
    #[must_use]
    pub fn gravity(mut self, gravity_world_m_s2: Vec3) -> Self {
        self.gravity_world = gravity_world_m_s2;
        self
    }

    /// Sets the orientation of the base in the world (`world_from_base`), as URDF's roll, pitch,
    /// yaw, rad.
    #[must_use]
    pub fn base_orientation_rpy(mut self, rpy: Vec3) -> Self {
        self.world_from_base = crate::vec3::rotation_from_rpy(rpy);
        self
    }

    /// Adds a joint with its body. Its index is the number of bodies added before it.
    #[must_use]
    pub fn body(mut self, spec: BodySpec) -> Self {
        self.specs.push(spec);
        self
    }

    /// Names a frame fixed to joint `joint` (`None`: to the base), for payloads and contacts.
    /// `pose` is given in the joint frame of [`BodySpec`].
    #[must_use]
    pub fn link(mut self, name: String, joint: Option<usize>, pose: Pose) -> Self {
        self.links.push((name, joint, pose));
        self
    }

    /// Checks the description and builds the arm with re-based frames.
    ///
    /// Each joint frame is rotated by a constant `B` with `B ẑ = axis`, once; bodies, children and
    /// links are expressed in the rotated frame. The generalised coordinates do not change.
    ///
    /// # Errors
    /// Returns an [`ArmError`] that names the joint, the value and its unit.
    pub fn build(self) -> Result<Arm, ArmError> {
        if self.specs.is_empty() {
            return Err(ArmError::NoJoint);
        }
        check_finite("base", "gravity (m/s²)", &self.gravity_world)?;
        for row in &self.world_from_base {
            check_finite("base", "orientation", row)?;
        }
        // joint_from_rebased, one per joint
        let mut rebase: Vec<Mat3> = Vec::with_capacity(self.specs.len());
        let mut joints: Vec<ArmJoint> = Vec::with_capacity(self.specs.len());
        let mut names: Vec<String> = Vec::with_capacity(self.specs.len());
        let mut used_names: BTreeSet<&str> = BTreeSet::new();
        for (i, spec) in self.specs.iter().enumerate() {
            check_spec(spec)?;
            if !used_names.insert(spec.name.as_str()) {
                return Err(ArmError::DuplicateJoint(spec.name.clone()));
            }
            let parent_rebase = match spec.parent {
                None => IDENTITY,
                Some(parent) => *rebase.get(parent).ok_or_else(|| ArmError::Parent {
                    joint: spec.name.clone(),
                    parent,
                })?,
            };
            let axis = scale(spec.axis, 1.0 / norm(spec.axis));
            let b = rotation_with_z(axis);
            let body = spec.body.seen_from(&Pose {
                rotation: transpose(&b),
                translation: [0.0; 3],
            });
            let (first_moment, inertia) = body.at_origin();
            joints.push(ArmJoint {
                kind: spec.kind,
                parent_slot: spec.parent.map_or(0, |p| p + 1),
                rotation: mul(
                    &transpose(&parent_rebase),
                    &mul(&spec.placement.rotation, &b),
                ),
                translation: rotate_back(&parent_rebase, spec.placement.translation),
                mass: body.mass,
                first_moment,
                inertia,
                subtree_mass: body.mass,
            });
            debug_assert_eq!(rebase.len(), i);
            rebase.push(b);
            names.push(spec.name.clone());
        }
        let links = self
            .links
            .into_iter()
            .map(|(name, joint, pose)| LinkFrame {
                name,
                joint,
                pose: match joint.and_then(|j| rebase.get(j)) {
                    None => pose,
                    Some(b) => Pose {
                        rotation: mul(&transpose(b), &pose.rotation),
                        translation: rotate_back(b, pose.translation),
                    },
                },
            })
            .collect();
        let mut arm = Arm {
            joints,
            names,
            links,
            gravity: rotate_back(&self.world_from_base, self.gravity_world),
        };
        arm.sum_subtree_masses();
        Ok(arm)
    }
}

impl Arm {
    /// Recomputes the mass that each joint carries after a change of a mass.
    pub(super) fn sum_subtree_masses(&mut self) {
        for joint in &mut self.joints {
            joint.subtree_mass = joint.mass;
        }
        for i in (0..self.joints.len()).rev() {
            let (slot, mass) = (self.joints[i].parent_slot, self.joints[i].subtree_mass);
            if slot > 0 {
                self.joints[slot - 1].subtree_mass += mass;
            }
        }
    }
}

fn check_spec(spec: &BodySpec) -> Result<(), ArmError> {
    check_finite(&spec.name, "axis", &spec.axis)?;
    check_finite(&spec.name, "origin (m)", &spec.placement.translation)?;
    for row in &spec.placement.rotation {
        check_finite(&spec.name, "origin rotation", row)?;
    }
    let length = norm(spec.axis);
    if !(length.is_finite() && length > 0.0) {
        return Err(ArmError::Axis(spec.name.clone()));
    }
    check_body(&spec.name, &spec.body)
}

/// Returns an error for NaN, infinities and negative mass; an inertia that is not positive definite
/// passes
/// here, because identified models have such (the description reader warns).
pub(super) fn check_body(place: &str, body: &BodyInertia) -> Result<(), ArmError> {
    check_finite(place, "mass (kg)", &[body.mass])?;
    check_finite(place, "centre of mass (m)", &body.com)?;
    for row in &body.inertia {
        check_finite(place, "inertia (kg·m²)", row)?;
    }
    if body.mass < 0.0 {
        return Err(ArmError::NegativeMass {
            place: place.into(),
            mass_kg: body.mass,
        });
    }
    Ok(())
}

fn check_finite(place: &str, what: &'static str, values: &[f64]) -> Result<(), ArmError> {
    match values.iter().find(|v| !v.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(ArmError::NotFinite {
            place: place.into(),
            what,
            value,
        }),
    }
}
