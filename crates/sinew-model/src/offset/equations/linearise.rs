//! Linearised equations of a block: predicted measurements and their derivatives with respect to the state.

use super::coupled;
use super::equation::Equations;
use super::loaded::{Common, Content, Loaded};
use super::reduced_model::ReducedModel;
use crate::cholesky::dot;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::effects::external_force::ForceTorque;
use crate::offset::effects::payload::HeldPayload;
use crate::offset::effects::{
    AllEffects, Effect, JointParameter as P, JointRow, Measured, PER_JOINT, Point, total,
};
use crate::offset::external_force::ForceModel;
use crate::offset::joint_prior::JointPrior;

/// How blocks are linearised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Linearisation<'a> {
    /// Temperature the offsets refer to, °C; NaN where unknown.
    pub(crate) reference_c: f64,
    /// Changes whose entries follow the model's in the state.
    pub(crate) changes: &'a [ChangePoint],
    /// Whether the motor's torque is used.
    pub(crate) motor: bool,
    /// External force and its torque on every joint.
    pub(crate) force: Option<(&'a ForceModel, &'a [ForceTorque])>,
    pub(crate) content: Content,
}

/// Fills the preallocated `out` with the equations of `block` around the state `x` (`d` entries, then those of the
/// changes). `joints`: measured values of the block per joint. Never allocates.
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
    if let Some(routes) = &model.routes {
        return coupled::linearise(model, routes, block, joints, &common, out);
    }
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
    let rows = common.is_rows();
    let mut own = *state;
    own[P::Offset as usize] = out.sum(common.x, ChangeKind::Offset(i), 0);
    own[P::Compliance as usize] = out.sum(common.x, ChangeKind::Compliance(i), 0);
    let point = Point {
        x: &own,
        joint,
        measured: is,
        temperature_difference_k: common.warmer,
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
        others_rad: 0.0,
    };
    let (link, _) = loaded.link_side(&point, &mut derivatives);
    let per_torque = link.torque_gain;
    out.push(link);
    if let (Some(drive), true) = (&is.drive, common.motor && per_torque > 0.0) {
        let (motor, _) = loaded.motor_side(&point, drive, &mut derivatives);
        out.push(motor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::config::FeatureConfig;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::fixtures::{random, slopes, turntable};
    use alloc::vec::Vec;

    /// Rows are compared with differences of the expected value, with friction, slack and memory at their prior means.
    #[test]
    fn rows_equal_differences_of_expected_value() {
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
        for none in [P::InitialFriction, P::Slack, P::Viscoelastic] {
            x[none as usize] = 0.0;
        }
        x[layout.payload_place()..].fill(0.0);
        let at = linearised(&x);
        assert_eq!(at.list.len(), 2);
        for place in 0..layout.payload_place() {
            for (e, [slope, row]) in at.list.iter().zip(slopes(&at, &x, place, linearised)) {
                assert!(
                    (slope - row).abs() < 1e-7 * (1.0 + row.abs()),
                    "{place} of {:?}: {slope} {row}",
                    e.side
                );
            }
        }
    }
}
