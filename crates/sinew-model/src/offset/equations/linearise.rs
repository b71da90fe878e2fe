//! A block's equations around a state: what is expected, and how it moves with the state.

use super::equation::{Equation, Equations, Side};
use super::measured::Measured;
use super::reduced_model::ReducedModel;
use crate::cholesky::dot;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::external_force::{AppliedForce, ForceModel, ForceTorque};
use crate::offset::parameter::{JointParameter as P, PER_JOINT};
use crate::offset::payload::HeldPayload;
use crate::offset::prior::{JointPrior, STUCK};

/// What is wanted of a block's equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// Residuals, and how they move with the state.
    Rows,
    /// Residuals alone: rows are zero.
    Residuals,
}

/// How blocks are linearised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Linearisation<'a> {
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub(crate) reference_c: f64,
    /// Changes whose entries stand after the model's in the state.
    pub(crate) changes: &'a [ChangePoint],
    /// Whether the motor's torque is used.
    pub(crate) motor: bool,
    /// A force from outside, and what it does to every joint.
    pub(crate) force: Option<(&'a ForceModel, &'a [ForceTorque])>,
    pub(crate) content: Content,
}

/// What the joints of a block have in common.
struct Common<'a> {
    /// State: `d` entries, then those of the changes.
    x: &'a [f64],
    payload: HeldPayload,
    /// Temperature over that the offsets refer to, K.
    warmer: f64,
    motor: bool,
    /// The force of the state, and what it does to every joint.
    force: Option<(AppliedForce, &'a [ForceTorque])>,
    content: Content,
}

/// Fills `out`, which has room for them, with the equations of `block` around the state `x` (`d`
/// entries, then those of the changes). `joints`: what the block says of each. Never allocates.
pub(crate) fn linearise(
    model: &ReducedModel,
    block: &Block,
    joints: impl Iterator<Item = Option<Measured>>,
    how: &Linearisation<'_>,
    x: &[f64],
    out: &mut Equations,
) {
    out.list.clear();
    out.activate(how.changes, block.time_s);
    let reference_c = how.reference_c;
    let common = Common {
        x,
        payload: HeldPayload::new(
            core::array::from_fn(|k| out.sum(x, ChangeKind::Payload, k)),
            model.payload_furthest_m,
        ),
        warmer: if block.temperature_c.is_finite() && reference_c.is_finite() {
            block.temperature_c - reference_c
        } else {
            0.0
        },
        motor: how.motor,
        force: how.force.and_then(|(model, torques)| {
            let entries = out.force(x)?;
            Some((model.applied(entries), torques))
        }),
        content: how.content,
    };
    for (i, (joint, measured)) in model.joints.iter().zip(joints).enumerate() {
        let (Some(joint), Some(measured)) = (joint, measured) else {
            continue;
        };
        let own = x.get(model.layout.own(i)).and_then(|x| x.first_chunk());
        let (Some(phi), Some(own)) = (model.phi(block, i), own) else {
            continue;
        };
        let carried = x.get(model.layout.carried()).unwrap_or_default();
        linearise_joint((i, joint), (&measured, phi), &common, (own, carried), out);
    }
}

/// The equations of joint `i`: link side, and motor side where its torque is recorded.
#[inline]
fn linearise_joint(
    (i, joint): (usize, &JointPrior),
    (is, phi): (&Measured, &[f64]),
    common: &Common<'_>,
    (state, carried): (&[f64; PER_JOINT], &[f64]),
    out: &mut Equations,
) {
    let Common { x, warmer, .. } = *common;
    let rows = common.content == Content::Rows;
    let kappa = 1.0 / joint.stiffness_nm_per_rad;
    let at = |p: P| state[p as usize];
    let bodies = carried.get(..phi.len()).unwrap_or_default();
    let (torque, load) = is.load.torque(&common.payload);
    let mut tau = is.tau + dot(phi, bodies) + torque;
    let of_force = (common.force.as_ref())
        .and_then(|(applied, torques)| Some(torques.get(i)?.torque(applied)));
    tau += of_force.map_or(0.0, |(torque, _)| torque);
    if rows {
        out.carry(i, phi, &load, of_force.as_ref().map(|(_, slope)| slope));
    }
    // A joint that has not slid since the recording began may be held either way.
    let load_friction = at(P::LoadFriction) * joint.stiffness_nm_per_rad;
    let stuck = (at(P::Coulomb) + load_friction * is.y.abs()) * is.z_unknown;
    tau += at(P::Stuck) * stuck
        + at(P::Coulomb) * is.z
        + at(P::Viscous) * is.dq
        + at(P::LoadFriction) * is.z_load;

    // Nor is it known how one is held that has stood for long since.
    let held = STUCK * is.held * (1.0 - is.z_unknown);
    let held_nm = held * (at(P::Coulomb).abs() + load_friction.abs() * is.y.abs());

    // Link side.
    let compliance = out.sum(x, ChangeKind::Compliance(i), 0);
    let soft = 1.0 + compliance + at(P::Thermal) * warmer;
    let linear = kappa * soft * tau;
    let cubic = at(P::Stiffening);
    let offset = out.sum(x, ChangeKind::Offset(i), 0) + at(P::Zero);
    // The slow part of the deflection.
    let slow = is.y_slow - offset;
    // What of `theta_measured − q` is no deflection of the spring.
    let mut inelastic =
        offset + at(P::Viscoelastic) * slow + at(P::Gear) * is.turned + at(P::Drift) * warmer;
    // A pair of slack ropes lets the joint through a dead zone, by the sign of the torque.
    const SMOOTH_RAD: f64 = 2e-3;
    let taut = if joint.antagonistic {
        libm::tanh(linear / SMOOTH_RAD)
    } else {
        0.0
    };
    inelastic += at(P::Slack) * taut;
    for (x, e) in state.iter().skip(P::Encoder as usize).zip(&is.encoder) {
        inelastic += x * e;
    }
    // LP[x + η x³] = κ τ with x = theta_measured − q − inelastic: linear in stiffness, stiffening
    // and torque, however large the deflection.
    let (y, y2, y3) = (is.y, is.y_square, is.y_cube);
    let square = y2 - inelastic * (2.0 * y - inelastic);
    let cube = y3 - inelastic * (3.0 * y2 - inelastic * (3.0 * y - inelastic));
    let expected = inelastic + linear - cubic * cube;
    let per_torque = kappa * soft;
    let friction_regressors = [
        (P::Coulomb, is.z),
        (P::Viscous, is.dq),
        (P::LoadFriction, is.z_load),
        (P::Stuck, stuck),
    ];
    let mut own = [0.0; PER_JOINT];
    if rows {
        // What a rad of inelastic offset moves, where the spring is stiffer.
        let gain = 1.0 + 3.0 * cubic * square;
        own[P::Offset as usize] = gain;
        own[P::Zero as usize] = gain;
        own[P::Compliance as usize] = kappa * tau;
        own[P::Stiffening as usize] = -cube;
        own[P::Slack as usize] = gain * taut;
        own[P::Viscoelastic as usize] = gain * slow;
        own[P::Gear as usize] = gain * is.turned;
        own[P::Drift as usize] = gain * warmer;
        own[P::Thermal as usize] = kappa * tau * warmer;
        for (to, e) in own.iter_mut().skip(P::Encoder as usize).zip(&is.encoder) {
            *to = gain * e;
        }
        for (p, value) in friction_regressors {
            own[p as usize] = per_torque * value;
        }
    }
    out.push(Equation {
        joint: i,
        side: Side::Link,
        own,
        torque_gain: per_torque,
        residual: y - expected,
        added_deviation: per_torque.abs() * held_nm,
        stationary_share: if held_nm > 0.0 { 1.0 } else { 0.0 },
    });

    // Motor side.
    let (Some(drive), true) = (&is.drive, common.motor && per_torque > 0.0) else {
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
        for (p, value) in friction_regressors {
            own[p as usize] = scale * value;
        }
    }
    let grip = at(P::MotorCoulomb).abs().max(joint.drive_coulomb_nm())
        + at(P::MotorLoadFriction).abs() * joint.stiffness_nm_per_rad * y.abs();
    out.push(Equation {
        joint: i,
        side: Side::Motor,
        own,
        torque_gain: scale,
        residual: drive.torque - scale * torque - at(P::MotorBias),
        added_deviation: libm::hypot(grip * drive.stood, scale * held_nm),
        stationary_share: drive.stood,
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::config::FeatureConfig;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::fixtures::{random, turntable};
    use alloc::vec::Vec;

    /// Rows against differences of what is expected, where friction, slack and memory are as they were believed to be.
    #[test]
    fn rows_are_how_what_is_expected_moves() {
        let mut prior = turntable().prior;
        for joint in prior.joints.iter_mut().flatten() {
            joint.motor_inertia_kg_m2 = Some(0.05);
            joint.antagonistic = true;
        }
        let model = EstimationModel::new(prior, &FeatureConfig::default());
        let (reduced, layout) = (&model.reduced, model.reduced.layout);
        let mut seed = 8;
        let mut block = Block::zero(1, layout.bodies);
        let all = block.sums().into_iter().flatten();
        all.for_each(|x| *x = random(&mut seed));
        block.temperature_c = 26.0;
        let how = Linearisation {
            reference_c: 20.0,
            changes: &[],
            motor: true,
            force: None,
            content: Content::Rows,
        };
        let linearised = |x: &[f64]| {
            let mut out = Equations::new(layout, &[]);
            let measured = [Measured::of(reduced, &block, 0)];
            linearise(reduced, &block, measured.into_iter(), &how, x, &mut out);
            out
        };
        let mut x: Vec<f64> = (0..layout.dimension())
            .map(|_| 0.2 * random(&mut seed))
            .collect();
        for none in [P::Stuck, P::Slack, P::Viscoelastic] {
            x[none as usize] = 0.0;
        }
        x[layout.payload_place()..].fill(0.0);
        let at = linearised(&x);
        assert_eq!(at.list.len(), 2);
        for place in 0..layout.payload_place() {
            const STEP: f64 = 1e-5;
            let moved = |by: f64| {
                let mut x = x.clone();
                x[place] += by;
                linearised(&x)
            };
            let (less, more) = (moved(-STEP), moved(STEP));
            let mut unit = alloc::vec![0.0; x.len()];
            unit[place] = 1.0;
            for (k, e) in at.list.iter().enumerate() {
                let slope = (less.list[k].residual - more.list[k].residual) / (2.0 * STEP);
                let row = at.dot(e, &unit);
                assert!(
                    (slope - row).abs() < 1e-7 * (1.0 + row.abs()),
                    "{place} of {:?}: {slope} {row}",
                    e.side
                );
            }
        }
    }
}
