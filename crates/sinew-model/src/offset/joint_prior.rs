//! What is known of a joint before any recording.

use crate::Gaussian;
use crate::transmission::Friction;

/// Nominal values of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointPrior {
    /// Nominal stiffness, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Reflected motor inertia, kg·m²; `None`: the motor's torque is no witness.
    pub motor_inertia_kg_m2: Option<f64>,
    /// Nominal Coulomb friction, N·m; where it and the viscous one are 0, nobody stated any.
    pub coulomb_nm: f64,
    /// Nominal viscous friction, N·m·s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Nominal Coulomb friction of the drive, N·m; as above.
    pub motor_coulomb_nm: f64,
    /// Nominal viscous friction of the drive, N·m·s/rad.
    pub motor_viscous_nm_s_per_rad: f64,
    /// Whether two ropes pull against each other: one that stretched is a dead zone then.
    pub antagonistic: bool,
    /// Drift of the zero with temperature by rope, frame and routing, rad/K; `None`: 0 ± the tolerance.
    pub drift_rad_per_k: Option<Gaussian>,
}

impl JointPrior {
    /// Friction of the joint as far as it is known before any recording, and by what part of itself it may
    /// be off: a guess by all of it.
    pub(crate) fn friction(&self, tolerance: f64) -> (Friction, f64) {
        let stated = Friction {
            coulomb_nm: self.coulomb_nm,
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
        };
        self.known(stated, Friction::GUESSED_OF_JOINT_RAD, tolerance)
    }

    /// The same of the drive.
    pub(crate) fn drive_friction(&self, tolerance: f64) -> (Friction, f64) {
        let stated = Friction {
            coulomb_nm: self.motor_coulomb_nm,
            viscous_nm_s_per_rad: self.motor_viscous_nm_s_per_rad,
        };
        self.known(stated, Friction::GUESSED_OF_DRIVE_RAD, tolerance)
    }

    fn known(&self, stated: Friction, guess_rad: f64, tolerance: f64) -> (Friction, f64) {
        let off = if stated.is_stated() { tolerance } else { 1.0 };
        (stated.or_guessed(self.stiffness_nm_per_rad, guess_rad), off)
    }

    /// Coulomb friction of the drive, N·m, as far as it is known before any recording.
    pub(crate) fn drive_coulomb_nm(&self) -> f64 {
        self.drive_friction(0.0).0.coulomb_nm
    }
}
