//! Description of joints, motors and tendons, as a file or a program states it.

use super::error::CouplingError;
use crate::moment_arm::{JointSpring, MomentArm, TendonKind};
use crate::transmission::Transmission;
use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;

/// Joints, motors and tendons of a robot, not yet validated; [`Coupling::new`](super::Coupling::new) does.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CouplingDescription {
    /// Joints in the order of `q`.
    pub joints: Vec<JointDescription>,
    /// Names of the motors in the order of `theta`.
    pub motors: Vec<String>,
    /// Tendons in the order of `delta`.
    pub tendons: Vec<TendonDescription>,
}

/// Joint that tendons cross.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointDescription {
    /// Name, unique among the joints.
    pub name: String,
    /// Whether a motor drives the joint without elasticity. A tendon may cross it, which only adds to `l(q)`.
    pub is_rigid: bool,
    /// Passive spring, if the joint has one.
    pub spring: Option<JointSpring>,
}

/// Unit of a tendon's extension, elongation, drums and moment arms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// Metres of rope. Drums and moment arms are in m/rad, stiffness in N/m, tension in N.
    Metres,
    /// Radians of the motor, as gear ratios and coupling matrices state it. Drums and moment arms are in rad/rad,
    /// stiffness in N·m/rad, tension in N·m.
    MotorRadians {
        /// Radius that converts radians to metres of rope, m, where it is specified.
        drum_m: Option<f64>,
    },
}

impl Coordinate {
    /// Metres of rope for one unit of the coordinate; `None` where no radius is specified.
    pub fn metres_per_unit(self) -> Option<f64> {
        match self {
            Self::Metres => Some(1.0),
            Self::MotorRadians { drum_m } => drum_m,
        }
    }

    /// Units of a drum or moment arm, a stiffness and a tension.
    pub(super) fn units(self) -> [&'static str; 3] {
        match self {
            Self::Metres => ["m/rad", "N/m", "N"],
            Self::MotorRadians { .. } => ["rad/rad", "N·m/rad", "N·m"],
        }
    }
}

/// Tendon between motors and joints.
#[derive(Debug, Clone, PartialEq)]
pub struct TendonDescription {
    /// Name, unique among the tendons.
    pub name: String,
    /// Way in which it pulls.
    pub kind: TendonKind,
    /// Unit of the following fields.
    pub coordinate: Coordinate,
    /// Rope that one rad of each motor takes in, `s_ik`, by the motor's name. Without a motor the tendon is tied to the base.
    pub drums: Vec<(String, f64)>,
    /// Moment arms by the joint's name; at least one.
    pub moment_arms: Vec<(String, MomentArm)>,
    /// Stiffness `k`, between 1e-9 and 1e12; of a loop that of both strands together.
    pub stiffness: f64,
    /// Tension `f0` at `theta = 0`, `q = 0`, `delta = 0`; of a loop that of each strand. `None`: not specified.
    pub pretension: Option<f64>,
}

impl CouplingDescription {
    /// Robot on which each elastic joint has one motor and one loop of its own name, `tau_el = K (theta − delta_e − q)`.
    ///
    /// The coordinate is the radian, drum and moment arm are 1, `k = K`; the elongation `delta` is the offset `delta_e`
    /// and times the pulley radius `r` the elongation in metres. Of a loop of two strands `r delta_e` is half of the
    /// elongation of one strand alone.
    ///
    /// * `joints`: joint names in the order of `q`. `transmissions`: one entry per joint, `None` for a rigid joint.
    ///
    /// # Errors
    /// Returns [`CouplingError::Transmissions`] where the two lengths differ.
    pub fn diagonal(
        joints: &[String],
        transmissions: &[Option<Transmission>],
    ) -> Result<Self, CouplingError> {
        if joints.len() != transmissions.len() {
            return Err(CouplingError::Transmissions {
                joints: joints.len(),
                transmissions: transmissions.len(),
            });
        }
        let mut description = Self::default();
        for (name, transmission) in joints.iter().zip(transmissions) {
            description.joints.push(JointDescription {
                name: name.to_owned(),
                is_rigid: transmission.is_none(),
                spring: None,
            });
            let Some(transmission) = transmission else {
                continue;
            };
            let rope = transmission.tendon.as_ref();
            let drum_m = rope.map(|rope| rope.joint_pulley_radius_m);
            let pretension_n = rope.and_then(|rope| rope.pretension_n);
            description.motors.push(name.to_owned());
            description.tendons.push(TendonDescription {
                name: name.to_owned(),
                kind: TendonKind::Loop,
                coordinate: Coordinate::MotorRadians { drum_m },
                drums: alloc::vec![(name.to_owned(), 1.0)],
                moment_arms: alloc::vec![(name.to_owned(), MomentArm::Constant(1.0))],
                stiffness: transmission.stiffness_nm_per_rad,
                pretension: pretension_n.zip(drum_m).map(|(f0, r)| f0 * r),
            });
        }
        Ok(description)
    }
}
