//! Prior of a joint before any recording.

use crate::Gaussian;
use crate::routings::PulledAxis;
use crate::transmission::Friction;

/// Nominal values of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointPrior {
    /// Nominal stiffness, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Reflected motor inertia, kg·m²; `None`: the motor torque cannot be used as a measurement.
    pub motor_inertia_kg_m2: Option<f64>,
    /// Nominal Coulomb friction, N·m; unspecified if it and the viscous friction are 0.
    pub coulomb_nm: f64,
    /// Nominal viscous friction, N·m·s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Nominal Coulomb friction of the drive, N·m; as above.
    pub motor_coulomb_nm: f64,
    /// Nominal viscous friction of the drive, N·m·s/rad.
    pub motor_viscous_nm_s_per_rad: f64,
    /// Whether two ropes form an antagonistic pair: elongation then causes a dead zone.
    pub antagonistic: bool,
    /// Drift of the zero with temperature by rope, frame and routing, rad/K; `None`: 0 ± the tolerance.
    pub drift_rad_per_k: Option<Gaussian>,
    /// Whether the axis has a joint.
    pub has_joint: bool,
    /// Whether the axis has a tendon and its motor.
    pub has_tendon: bool,
    /// Pretension of a single-acting strand with all positions at zero, N·m; 0 for a loop.
    pub pretension_nm: f64,
}

impl JointPrior {
    /// A joint without a tendon on its axis, which others pull.
    pub(crate) fn of_joint(pulled: &PulledAxis) -> Self {
        Self {
            stiffness_nm_per_rad: pulled.stiffness_nm_per_rad,
            motor_inertia_kg_m2: None,
            coulomb_nm: pulled.friction.coulomb_nm,
            viscous_nm_s_per_rad: pulled.friction.viscous_nm_s_per_rad,
            motor_coulomb_nm: 0.0,
            motor_viscous_nm_s_per_rad: 0.0,
            antagonistic: false,
            drift_rad_per_k: None,
            has_joint: true,
            has_tendon: false,
            pretension_nm: 0.0,
        }
    }

    /// Torque that the tendon usually carries, N·m: its pretension, otherwise that of 20 mrad.
    pub(crate) fn usual_torque_nm(&self) -> f64 {
        self.pretension_nm.max(0.02 * self.stiffness_nm_per_rad)
    }

    /// Returns the prior friction of the joint before any recording, and its relative standard deviation,
    /// which is 1 for a default value.
    pub(crate) fn friction(&self, tolerance: f64) -> (Friction, f64) {
        let stated = Friction {
            coulomb_nm: self.coulomb_nm,
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
        };
        self.friction_or_default(stated, Friction::DEFAULT_JOINT_RAD, tolerance)
    }

    /// Returns the prior friction of the drive and its relative standard deviation, which is 1 for a default value.
    pub(crate) fn drive_friction(&self, tolerance: f64) -> (Friction, f64) {
        let stated = Friction {
            coulomb_nm: self.motor_coulomb_nm,
            viscous_nm_s_per_rad: self.motor_viscous_nm_s_per_rad,
        };
        self.friction_or_default(stated, Friction::DEFAULT_DRIVE_RAD, tolerance)
    }

    fn friction_or_default(
        &self,
        stated: Friction,
        default_rad: f64,
        tolerance: f64,
    ) -> (Friction, f64) {
        let off = if stated.is_specified() {
            tolerance
        } else {
            1.0
        };
        (
            stated.or_default(self.stiffness_nm_per_rad, default_rad),
            off,
        )
    }

    /// Coulomb friction of the drive, N·m, before any recording.
    pub(crate) fn drive_coulomb_nm(&self) -> f64 {
        self.drive_friction(0.0).0.coulomb_nm
    }
}
