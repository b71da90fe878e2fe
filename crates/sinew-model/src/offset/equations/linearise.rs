//! A block's equations around a state: what is expected, and how it moves with the state.

use super::equation::{Equation, Equations, Side};
use super::reduced_model::ReducedModel;
use crate::cholesky::dot;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::effects::external_force::{AppliedForce, ForceTorque};
use crate::offset::effects::payload::HeldPayload;
use crate::offset::effects::{
    AllEffects, Drive, Effect, Factors, JointParameter as P, JointRow, Measured, PER_JOINT, Point,
    total,
};
use crate::offset::external_force::ForceModel;
use crate::offset::joint_prior::JointPrior;

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
    out.activate(how.changes, block.time_s, model.appears);
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
    (state, carried): (&JointRow, &[f64]),
    out: &mut Equations,
) {
    let rows = common.content == Content::Rows;
    let mut own = *state;
    own[P::Offset as usize] = out.sum(common.x, ChangeKind::Offset(i), 0);
    own[P::Compliance as usize] = out.sum(common.x, ChangeKind::Compliance(i), 0);
    let point = Point {
        x: &own,
        joint,
        measured: is,
        warmer_k: common.warmer,
    };
    let mut derivatives = [0.0; PER_JOINT];

    // Torque that bends the spring.
    let bodies = carried.get(..phi.len()).unwrap_or_default();
    let (torque, load) = is.load.torque(&common.payload);
    let mut tau = is.tau + dot(phi, bodies) + torque;
    let of_force = (common.force.as_ref())
        .and_then(|(applied, torques)| Some(torques.get(i)?.torque(applied)));
    tau += of_force.map_or(0.0, |(torque, _)| torque);
    if rows {
        out.carry(i, phi, &load, of_force.as_ref().map(|(_, slope)| slope));
    }
    tau += total(0.0, &mut derivatives, |sum| {
        AllEffects::joint_torque(&point, sum);
    });
    let loaded = Loaded {
        joint: i,
        rows,
        tau,
        unknown_nm: AllEffects::unknown_torque(&point),
    };
    let link = loaded.link_side(&point, &mut derivatives);
    let per_torque = link.torque_gain;
    out.push(link);
    if let (Some(drive), true) = (&is.drive, common.motor && per_torque > 0.0) {
        out.push(loaded.motor_side(&point, drive, &mut derivatives));
    }
}

/// The torque that bends the spring of a joint, N·m.
struct Loaded {
    joint: usize,
    rows: bool,
    tau: f64,
    /// Standard deviation of what is unknown of it beside the noise, N·m.
    unknown_nm: f64,
}

impl Loaded {
    /// `LP[x + η x³] = κ τ` with `x = theta_measured − q − inelastic`: linear in stiffness, stiffening and torque,
    /// however large the deflection.
    #[inline]
    fn link_side(&self, point: &Point<'_>, derivatives: &mut JointRow) -> Equation {
        let kappa = 1.0 / point.joint.stiffness_nm_per_rad;
        let soft = total(1.0, derivatives, |sum| AllEffects::compliance(point, sum));
        let per_torque = kappa * soft;
        let linear = per_torque * self.tau;
        let inelastic = total(0.0, derivatives, |sum| {
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
        Equation {
            joint: self.joint,
            side: Side::Link,
            own: self.row(&factors, derivatives),
            torque_gain: per_torque,
            residual: y - expected,
            added_deviation: per_torque.abs() * self.unknown_nm,
            stationary_share: if self.unknown_nm > 0.0 { 1.0 } else { 0.0 },
        }
    }

    /// The recorded torque of the motor.
    #[inline]
    fn motor_side(&self, point: &Point<'_>, drive: &Drive, derivatives: &mut JointRow) -> Equation {
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
        Equation {
            joint: self.joint,
            side: Side::Motor,
            own: self.row(&factors, derivatives),
            torque_gain: scale,
            residual: drive.torque - scale * torque - bias,
            added_deviation: libm::hypot(unknown_nm, scale * self.unknown_nm),
            stationary_share: drive.stood,
        }
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
