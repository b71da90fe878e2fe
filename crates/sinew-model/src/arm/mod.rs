//! The arm: a tree of rigid bodies on revolute and prismatic joints.
//!
//! [`Arm`] is the model, which is immutable after construction. [`ArmWorkspace`] owns all intermediate values, is
//! allocated once, and is written by each step. The construction rotates each joint frame so that the joint axis is
//! its local z axis, which simplifies [`Arm::momentum`].
//!
//! Reading order: `build` (arm from bodies), `momentum` (the realtime pass),
//! `mass_matrix`, `dynamics`, `energy`, `point` (forces at a link, payloads), `regressor` and `base`
//! (torques as linear functions of the inertial parameters).

mod base;
mod build;
mod dynamics;
mod energy;
mod mass_matrix;
mod momentum;
mod point;
mod regressor;
#[cfg(feature = "urdf")]
pub mod urdf;

pub use base::BaseParameters;
pub use build::{ArmBuilder, ArmError, BodyInertia, BodySpec, Pose};
pub use momentum::Momentum;
pub use regressor::{MomentumRegressor, PARAMETERS_PER_BODY};

use crate::vec3::{Mat3, Vec3};
use alloc::string::String;
use alloc::vec::Vec;

/// Standard gravity as the reference values use it, m/s².
pub const GRAVITY_M_S2: f64 = 9.81;

/// Type of motion of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum JointKind {
    /// Turns about its axis; `q` in rad. URDF's continuous joints are revolute ones without limit.
    Revolute,
    /// Slides along its axis; `q` in m.
    Prismatic,
}

/// A joint and the body it carries, in re-based frames.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ArmJoint {
    pub(crate) kind: JointKind,
    /// Slot of the parent in a workspace: 0 is the base, `i + 1` is joint `i`.
    pub(crate) parent_slot: usize,
    /// `parent_from_joint` at `q = 0`.
    pub(crate) rotation: Mat3,
    /// Origin of the joint in the parent's frame, m.
    pub(crate) translation: Vec3,
    /// Mass of the body, kg.
    pub(crate) mass: f64,
    /// First mass moment of the body about the joint origin, kg·m.
    pub(crate) first_moment: Vec3,
    /// Inertia of the body about the joint origin, kg·m².
    pub(crate) inertia: Mat3,
    /// Mass of the body and its descendants, kg.
    pub(crate) subtree_mass: f64,
}

impl ArmJoint {
    /// `parent_from_body` at `q`: the fixed rotation and the joint's own in one matrix, so that the
    /// chain of joints waits for one product per joint, not two; and the origin.
    #[inline(always)]
    pub(crate) fn placed(&self, q: f64) -> (Mat3, Vec3) {
        match self.kind {
            JointKind::Revolute => self.placed_by(q, libm::sincos(q)),
            JointKind::Prismatic => self.placed_by(q, (0.0, 1.0)),
        }
    }

    /// Computes [`ArmJoint::placed`] with precomputed sine and cosine of `q`; a prismatic joint ignores them.
    #[inline(always)]
    pub(crate) fn placed_by(&self, q: f64, (s, c): (f64, f64)) -> (Mat3, Vec3) {
        let (e, r) = (&self.rotation, self.translation);
        match self.kind {
            JointKind::Revolute => {
                // E Rz(q)
                let turned =
                    |row: &Vec3| [c * row[0] + s * row[1], c * row[1] - s * row[0], row[2]];
                ([turned(&e[0]), turned(&e[1]), turned(&e[2])], r)
            }
            JointKind::Prismatic => (
                *e,
                [r[0] + q * e[0][2], r[1] + q * e[1][2], r[2] + q * e[2][2]],
            ),
        }
    }
}

/// Location of a link of the description: its joint, and its pose on it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct LinkFrame {
    pub(crate) name: String,
    /// `None`: fixed to the base.
    pub(crate) joint: Option<usize>,
    /// Pose of the link frame in the re-based joint frame (or in the base).
    pub(crate) pose: Pose,
}

/// A fixed-base arm of `n` joints. Immutable; see [`ArmBuilder`] and the module `urdf`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Arm {
    pub(crate) joints: Vec<ArmJoint>,
    pub(crate) names: Vec<String>,
    pub(crate) links: Vec<LinkFrame>,
    /// Gravitational acceleration in the base frame, m/s².
    pub(crate) gravity: Vec3,
}

/// Per-body intermediates of one pass.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BodyState {
    /// `parent_from_body` at the joint's `q`: rotation, and origin (with the travel of a prismatic
    /// joint), m.
    pub(crate) rotation: Mat3,
    pub(crate) origin: Vec3,
    /// Angular velocity, body frame.
    pub(crate) omega: Vec3,
    /// Velocity of the body's origin, body frame.
    pub(crate) v: Vec3,
    /// Gravity, body frame.
    pub(crate) gamma: Vec3,
    /// Angular acceleration, body frame.
    pub(crate) angular_acceleration: Vec3,
    /// Acceleration of the body's origin less gravity, body frame.
    pub(crate) acceleration: Vec3,
    /// Moment that acts on the subtree about the body's origin.
    pub(crate) moment: Vec3,
    /// Force that acts on the subtree.
    pub(crate) force: Vec3,
}

/// Composite inertia of a subtree at its joint origin.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Composite {
    pub(crate) mass: f64,
    pub(crate) first_moment: Vec3,
    pub(crate) inertia: Mat3,
}

/// Storage for every intermediate of an arm's passes, sized at construction.
#[derive(Debug, Clone)]
pub struct ArmWorkspace {
    /// Slot 0 is the base, slot `i + 1` is joint `i`.
    pub(crate) state: Vec<BodyState>,
    /// Bodies of the momentum pass, which has a storage of its own for speed; slots as above.
    pub(crate) moving: Vec<momentum::Moving>,
    pub(crate) composite: Vec<Composite>,
    pub(crate) sin_q: Vec<f64>,
    pub(crate) cos_q: Vec<f64>,
    pub(crate) p: Vec<f64>,
    pub(crate) ct_dq: Vec<f64>,
    pub(crate) g: Vec<f64>,
    /// Bias torque and other generalised forces.
    pub(crate) tau: Vec<f64>,
    /// Mass matrix, row-major `n × n`.
    pub(crate) mass_matrix: Vec<f64>,
    /// Cholesky factor of the mass matrix, lower triangle, row-major `n × n`.
    pub(crate) factor: Vec<f64>,
}

impl ArmWorkspace {
    /// Storage for `arm`. This is where memory is allocated, once.
    pub fn new(arm: &Arm) -> Self {
        let n = arm.dof();
        let mut state = alloc::vec![BodyState::default(); n + 1];
        if let Some(base) = state.first_mut() {
            base.rotation = crate::vec3::IDENTITY;
            base.gamma = arm.gravity;
        }
        Self {
            state,
            moving: alloc::vec![momentum::Moving::default(); n + 1],
            composite: alloc::vec![Composite::default(); n + 1],
            sin_q: alloc::vec![0.0; n],
            cos_q: alloc::vec![0.0; n],
            p: alloc::vec![0.0; n],
            ct_dq: alloc::vec![0.0; n],
            g: alloc::vec![0.0; n],
            tau: alloc::vec![0.0; n],
            mass_matrix: alloc::vec![0.0; n * n],
            factor: alloc::vec![0.0; n * n],
        }
    }

    /// Whether this workspace was made for an arm with as many joints as `arm`.
    #[inline]
    pub(crate) fn fits(&self, arm: &Arm) -> bool {
        self.p.len() == arm.joints.len()
    }
}

impl Arm {
    /// Number of joints `n` (degrees of freedom).
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Joint names, in the order of `q`.
    pub fn joint_names(&self) -> &[String] {
        &self.names
    }

    /// Whether the arm satisfies the invariants of [`ArmBuilder`]: parents precede their children, each joint has one
    /// name, each link refers to an existing joint, and all values are finite.
    #[cfg(feature = "wire")]
    pub(crate) fn is_whole(&self) -> bool {
        let n = self.joints.len();
        let finite = |x: &[f64]| x.iter().all(|x| x.is_finite());
        let finite3 = |m: &Mat3| m.iter().all(|row| finite(row));
        let joint = |(i, j): (usize, &ArmJoint)| {
            j.parent_slot <= i
                && j.mass >= 0.0
                && finite(&[j.mass, j.subtree_mass])
                && finite(&j.translation)
                && finite(&j.first_moment)
                && finite3(&j.rotation)
                && finite3(&j.inertia)
        };
        let link = |l: &LinkFrame| {
            l.joint.is_none_or(|j| j < n)
                && finite(&l.pose.translation)
                && finite3(&l.pose.rotation)
        };
        n > 0
            && self.names.len() == n
            && self.joints.iter().enumerate().all(joint)
            && self.links.iter().all(link)
            && finite(&self.gravity)
    }

    /// Index of the joint called `name`.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// Kind of joint `i`, or `None` past the last.
    pub fn joint_kind(&self, i: usize) -> Option<JointKind> {
        self.joints.get(i).map(|j| j.kind)
    }

    /// Joint that carries joint `i`; `None` when that is the base (or `i` is past the last).
    pub fn parent(&self, i: usize) -> Option<usize> {
        self.joints.get(i)?.parent_slot.checked_sub(1)
    }

    /// Pose of joint `i` at `q = 0` in the frame of the joint that carries it, or of the base; its axis is z. `None` past
    /// the last.
    pub fn placement(&self, i: usize) -> Option<Pose> {
        let joint = self.joints.get(i)?;
        Some(Pose {
            rotation: joint.rotation,
            translation: joint.translation,
        })
    }

    /// Gravitational acceleration in the base frame, m/s².
    pub fn gravity(&self) -> Vec3 {
        self.gravity
    }

    /// Names of all links of the description, moving or fixed to the base.
    pub fn link_names(&self) -> impl Iterator<Item = &str> {
        self.links.iter().map(|l| l.name.as_str())
    }

    /// Links that joint `i` carries itself, in the order of the description, each with its pose in the
    /// joint's frame (axis along z).
    pub fn links_of(&self, i: usize) -> impl Iterator<Item = (&str, &Pose)> {
        let own = self.links.iter().filter(move |l| l.joint == Some(i));
        own.map(|l| (l.name.as_str(), &l.pose))
    }

    /// Total mass that joint `i` carries, kg.
    pub fn subtree_mass(&self, i: usize) -> Option<f64> {
        self.joints.get(i).map(|j| j.subtree_mass)
    }
}

#[cfg(all(test, feature = "wire"))]
mod tests {
    use super::*;

    #[test]
    fn arm_with_link_on_missing_joint_is_invalid() {
        let mut arm = crate::offset::fixtures::tables(2);
        assert!(arm.is_whole());
        let pose = Pose::from_xyz_rpy([0.0; 3], [0.0; 3]);
        for (joint, is_whole) in [(Some(1), true), (Some(2), false), (None, true)] {
            arm.links = alloc::vec![LinkFrame {
                name: "hand".into(),
                joint,
                pose,
            }];
            assert_eq!(arm.is_whole(), is_whole, "{joint:?}");
        }
    }
}
