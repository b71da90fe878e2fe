//! The two equations of a spring whose torque is determined by a state: its deflection, and the torque of its
//! motor.

use super::equation::{Equation, Side};
use crate::offset::effects::external_force::{AppliedForce, ForceTorque};
use crate::offset::effects::payload::HeldPayload;
use crate::offset::effects::{
    AllEffects, Drive, Effect, Factors, JointRow, PER_JOINT, Point, total,
};

/// Parts of a block's equations to compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// Residuals, and how they move with the state.
    Rows,
    /// Residuals only; all rows are zero.
    Residuals,
}

/// State and signals that the joints of a block have in common.
pub(super) struct Common<'a> {
    /// State: `d` entries, then those of the changes.
    pub(super) x: &'a [f64],
    pub(super) payload: HeldPayload,
    /// Difference from the reference temperature of the offsets, K.
    pub(super) warmer: f64,
    pub(super) motor: bool,
    /// External force of the state, and its torques on all joints.
    pub(super) force: Option<(AppliedForce, &'a [ForceTorque])>,
    pub(super) content: Content,
}

impl Common<'_> {
    /// Whether rows are needed in addition to residuals.
    pub(super) fn is_rows(&self) -> bool {
        self.content == Content::Rows
    }
}

/// The torque that bends the spring of a joint, N·m.
pub(super) struct Loaded {
    pub(super) joint: usize,
    pub(super) rows: bool,
    pub(super) tau: f64,
    /// Standard deviation of the unknown part of the torque, in addition to the noise, N·m.
    pub(super) unknown_nm: f64,
    /// Errors of the encoders of other joints in `theta_measured − q`, rad.
    pub(super) others_rad: f64,
}

impl Loaded {
    /// `LP[x + η x³] = κ τ` with `x = theta_measured − q − inelastic`: linear in stiffness, stiffening and torque,
    /// however large the deflection.
    #[inline]
    pub(super) fn link_side(
        &self,
        point: &Point<'_>,
        derivatives: &mut JointRow,
    ) -> (Equation, Factors) {
        let kappa = 1.0 / point.joint.stiffness_nm_per_rad;
        let soft = total(1.0, derivatives, |sum| AllEffects::compliance(point, sum));
        let per_torque = kappa * soft;
        let linear = per_torque * self.tau;
        let inelastic = total(self.others_rad, derivatives, |sum| {
            AllEffects::deflection(point, linear, sum);
        });
        let cubic = total(0.0, derivatives, |sum| AllEffects::stiffening(point, sum));
        let (y, y2, y3) = (
            point.measured.y,
            point.measured.y_square,
            point.measured.y_cube,
        );
        let square = y2 - inelastic * (2.0 * y - inelastic);
        let cube = y3 - inelastic * (3.0 * y2 - inelastic * (3.0 * y - inelastic));
        let expected = inelastic + linear - cubic * cube;
        let factors = Factors {
            joint_torque: per_torque,
            compliance: kappa * self.tau,
            // What a rad of inelastic offset moves, where the spring is stiffer.
            deflection: 1.0 + 3.0 * cubic * square,
            stiffening: -cube,
            ..Factors::default()
        };
        let equation = Equation {
            joint: self.joint,
            side: Side::Link,
            own: self.row(&factors, derivatives),
            torque_gain: per_torque,
            residual: y - expected,
            added_std: per_torque.abs() * self.unknown_nm,
            stationary_share: if self.unknown_nm > 0.0 { 1.0 } else { 0.0 },
        };
        (equation, factors)
    }

    /// The recorded torque of the motor.
    #[inline]
    pub(super) fn motor_side(
        &self,
        point: &Point<'_>,
        drive: &Drive,
        derivatives: &mut JointRow,
    ) -> (Equation, Factors) {
        let torque = total(self.tau + drive.inertial, derivatives, |sum| {
            AllEffects::drive_torque(point, drive, sum);
        });
        let scale = total(1.0, derivatives, |sum| AllEffects::motor_scale(point, sum));
        let bias = total(0.0, derivatives, |sum| AllEffects::motor_bias(point, sum));
        let factors = Factors {
            joint_torque: scale,
            drive_torque: scale,
            motor_scale: torque,
            motor_bias: 1.0,
            ..Factors::default()
        };
        let unknown_nm = AllEffects::unknown_drive_torque(point, drive);
        let equation = Equation {
            joint: self.joint,
            side: Side::Motor,
            own: self.row(&factors, derivatives),
            torque_gain: scale,
            residual: drive.torque - scale * torque - bias,
            added_std: libm::hypot(unknown_nm, scale * self.unknown_nm),
            stationary_share: drive.stood,
        };
        (equation, factors)
    }

    #[inline]
    fn row(&self, factors: &Factors, derivatives: &JointRow) -> JointRow {
        if self.rows {
            factors.row(derivatives)
        } else {
            [0.0; PER_JOINT]
        }
    }
}
