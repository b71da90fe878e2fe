//! A block's equations around a state: what is expected, and how it moves with the state.

use super::block::Block;
use super::changes::{Change, What};
use super::equation::{Equation, Equations, Side};
use super::measured::Measured;
use super::model::Model;
use super::payload::Held;
use super::prior::{JointParameter as P, JointPrior, PER_JOINT};
use crate::cholesky::dot;

/// What is looked for in a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// Residuals, and how they move with the state.
    Rows,
    /// Residuals alone: rows are nothing.
    Residuals,
}

/// What a whole block has in common.
struct Around<'a> {
    /// State: `d` entries, then those of the changes.
    x: &'a [f64],
    held: Held,
    /// Temperature over that the offsets refer to, K.
    warmer: f64,
    motor: bool,
    look: Look,
}

impl Model {
    /// Fills `out`, which has room for them, with the equations of `block` around the state `x` (`d`
    /// entries, then those of `changes`). `motor`: whether the motor's torque is used. Never allocates.
    pub(super) fn linearise(
        &self,
        block: &Block,
        reference_c: f64,
        changes: &[Change],
        motor: bool,
        x: &[f64],
        out: &mut Equations,
    ) {
        let joints = (0..self.layout.joints).map(|i| self.measured(block, i));
        let with = (reference_c, changes, motor, Look::Rows);
        self.linearise_measured(block, joints, with, x, out);
    }

    /// [`Model::linearise`] with what the block says of every joint made ready.
    pub(super) fn linearise_measured(
        &self,
        block: &Block,
        joints: impl Iterator<Item = Option<Measured>>,
        (reference_c, changes, motor, look): (f64, &[Change], bool, Look),
        x: &[f64],
        out: &mut Equations,
    ) {
        out.list.clear();
        out.activate(changes, block.time_s);
        let around = Around {
            x,
            held: Held::new(core::array::from_fn(|k| out.sum(x, What::Payload, k))),
            warmer: if block.temperature_c.is_finite() && reference_c.is_finite() {
                block.temperature_c - reference_c
            } else {
                0.0
            },
            motor,
            look,
        };
        for (i, (joint, measured)) in self.joints.iter().zip(joints).enumerate() {
            let (Some(joint), Some(measured)) = (joint, measured) else {
                continue;
            };
            let own = x.get(self.layout.own(i)).and_then(|x| x.first_chunk());
            let (Some(phi), Some(own)) = (self.phi(block, i), own) else {
                continue;
            };
            self.linearise_joint(i, joint, (&measured, phi), &around, own, out);
        }
    }

    #[inline]
    fn linearise_joint(
        &self,
        i: usize,
        joint: &JointPrior,
        (is, phi): (&Measured, &[f64]),
        around: &Around<'_>,
        state: &[f64; PER_JOINT],
        out: &mut Equations,
    ) {
        let Around { x, warmer, .. } = *around;
        let rows = around.look == Look::Rows;
        let kappa = 1.0 / joint.stiffness_nm_per_rad;
        let at = |p: P| state[p as usize];
        let bodies = x.get(self.layout.carried()).unwrap_or_default();
        let bodies = bodies.get(..phi.len()).unwrap_or_default();
        let (torque, load) = is.load.torque(&around.held);
        let mut tau = is.tau + dot(phi, bodies) + torque;
        if rows {
            out.carry(i, phi, &load);
        }
        // A joint that has not slid since the recording began may be held either way.
        let load_friction = at(P::LoadFriction) * joint.stiffness_nm_per_rad;
        let stuck = (at(P::Coulomb) + load_friction * is.y.abs()) * is.z_unknown;
        tau += at(P::Stuck) * stuck
            + at(P::Coulomb) * is.z
            + at(P::Viscous) * is.dq
            + at(P::LoadFriction) * is.z_load;

        // Link side.
        let compliance = out.sum(x, What::Compliance(i), 0);
        let soft = 1.0 + compliance + at(P::Thermal) * warmer;
        let linear = kappa * soft * tau;
        let cubic = at(P::Stiffening);
        let offset = out.sum(x, What::Offset(i), 0) + at(P::Zero);
        // The slow part of the deflection.
        let slow = is.y_slow - offset;
        // What `theta_measured − q` holds beside the spring's deflection.
        let mut beside =
            offset + at(P::Viscoelastic) * slow + at(P::Gear) * is.turned + at(P::Drift) * warmer;
        // A pair of slack ropes lets the joint through a dead zone, by the sign of the torque.
        const SMOOTH_RAD: f64 = 2e-3;
        let taut = if joint.antagonistic {
            libm::tanh(linear / SMOOTH_RAD)
        } else {
            0.0
        };
        beside += at(P::Slack) * taut;
        for (x, e) in state.iter().skip(P::Encoder as usize).zip(&is.encoder) {
            beside += x * e;
        }
        // LP[x + η x³] = κ τ with x = theta_measured − q − beside: linear in stiffness, stiffening
        // and torque, however large the deflection.
        let (y, y2, y3) = (is.y, is.y_square, is.y_cube);
        let square = y2 - beside * (2.0 * y - beside);
        let cube = y3 - beside * (3.0 * y2 - beside * (3.0 * y - beside));
        let expected = beside + linear - cubic * cube;
        let per_torque = kappa * soft;
        let rubs = [
            (P::Coulomb, is.z),
            (P::Viscous, is.dq),
            (P::LoadFriction, is.z_load),
            (P::Stuck, stuck),
        ];
        let mut own = [0.0; PER_JOINT];
        if rows {
            // What a rad beside is worth, where the spring is stiffer.
            let worth = 1.0 + 3.0 * cubic * square;
            own[P::Offset as usize] = worth;
            own[P::Zero as usize] = worth;
            own[P::Compliance as usize] = kappa * tau;
            own[P::Stiffening as usize] = -cube;
            own[P::Slack as usize] = worth * taut;
            own[P::Viscoelastic as usize] = worth * slow;
            own[P::Gear as usize] = worth * is.turned;
            own[P::Drift as usize] = worth * warmer;
            own[P::Thermal as usize] = kappa * tau * warmer;
            for (to, e) in own.iter_mut().skip(P::Encoder as usize).zip(&is.encoder) {
                *to = worth * e;
            }
            for (p, value) in rubs {
                own[p as usize] = per_torque * value;
            }
        }
        out.push(Equation {
            joint: i,
            side: Side::Link,
            own,
            worth: per_torque,
            residual: y - expected,
            unsure: 0.0,
            stood: 0.0,
        });

        // Motor side.
        let (Some(drive), true) = (&is.drive, around.motor && per_torque > 0.0) else {
            return;
        };
        let scale = 1.0 + at(P::MotorScale);
        let torque = tau
            + drive.inertial
            + at(P::MotorCoulomb) * drive.z
            + at(P::MotorViscous) * drive.velocity
            + at(P::MotorLoadFriction) * drive.z_load;
        let mut own = [0.0; PER_JOINT];
        if rows {
            own[P::MotorScale as usize] = torque;
            own[P::MotorBias as usize] = 1.0;
            own[P::MotorCoulomb as usize] = scale * drive.z;
            own[P::MotorViscous as usize] = scale * drive.velocity;
            own[P::MotorLoadFriction as usize] = scale * drive.z_load;
            for (p, value) in rubs {
                own[p as usize] = scale * value;
            }
        }
        let grip = at(P::MotorCoulomb).abs().max(joint.drive_coulomb_nm())
            + at(P::MotorLoadFriction).abs() * joint.stiffness_nm_per_rad * y.abs();
        out.push(Equation {
            joint: i,
            side: Side::Motor,
            own,
            worth: scale,
            residual: drive.torque - scale * torque - at(P::MotorBias),
            unsure: grip * drive.stood,
            stood: drive.stood,
        });
    }
}
