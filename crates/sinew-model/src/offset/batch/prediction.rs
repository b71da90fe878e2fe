//! The predictive distribution of blocks under a posterior: innovations of the link and motor equations.
//!
//! ```text
//! e_i = y_i − h_i(x̂),   var e_i = H_i P H_iᵀ + σ_i²
//! ```
//!
//! `x̂`, `P`: mean and covariance of the posterior, `h_i` the link equation of joint `i`, `H_i` its Jacobian, `σ_i` the noise,
//! which the caller adds; the same of the motor equation, where the motor's torque is recorded and used.

use super::map_estimator::MapEstimator;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::effects::Measured;
use crate::offset::equations::equation::{Equation, Equations, Side};
use crate::offset::equations::linearise::{Linearisation, linearise};
use crate::offset::equations::loaded::Content;
use crate::offset::estimate::MapEstimate;
use crate::routings::Routings;
use alloc::vec::Vec;

/// A posterior in the parameters that blocks can identify, from which blocks are predicted.
#[derive(Debug, Clone)]
pub struct Prediction {
    changes: Vec<ChangePoint>,
    state: Vec<f64>,
    covariance: Vec<f64>,
    temperature_c: f64,
}

/// Innovation of a joint's link equation in one block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Innovation {
    /// `e = y − h(x̂)`, rad.
    pub residual_rad: f64,
    /// Variance `H P Hᵀ` due to the posterior, without the noise, rad².
    pub parameter_variance_rad2: f64,
    /// Standard deviation of the stiction in a long rest phase, rad: it is constant until the arm moves.
    pub held_rad: f64,
    /// `∂h/∂δ_e`: 1 but where the spring stiffens.
    pub offset_gain: f64,
    /// The motor equation of the same joint; `None`: the motor's torque is not recorded or not used.
    pub motor: Option<MotorInnovation>,
}

/// Innovation of a joint's motor equation in one block, N·m.
///
/// An unmodelled torque on the link changes the innovations of both equations, that of the link equation by
/// `rad_per_nm` times that of the motor equation. A step of the offset changes only the innovation of the link
/// equation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorInnovation {
    /// Recorded less predicted torque, N·m.
    pub residual_nm: f64,
    /// Variance of the prediction by the posterior and stiction, (N·m)²; the noise is not included.
    pub variance_nm2: f64,
    /// Effect of a torque of 1 N·m at the motor in the link equation, rad/(N·m).
    pub rad_per_nm: f64,
}

impl MapEstimator {
    /// The posterior `at` as blocks are predicted from it.
    pub fn prediction(&self, at: &MapEstimate) -> Prediction {
        let reduced = &self.model().reduced;
        Prediction {
            changes: at.changes.clone(),
            state: reduced.reduced(&at.state),
            covariance: reduced.reduced_covariance(&at.covariance, at.state.len()),
            temperature_c: at.temperature_c,
        }
    }

    /// Innovations of blocks that follow each other, `n` a block; `None` for a rigid joint.
    pub fn innovations(&self, from: &Prediction, blocks: &[Block]) -> Vec<Option<Innovation>> {
        let model = self.model();
        let n = model.reduced.layout.joints;
        let mut equations = Equations::new(model.reduced.layout, &from.changes);
        let acts = from.changes.iter().any(|c| c.kind == ChangeKind::Force);
        let force = model.force.as_ref().filter(|_| acts);
        let forces = force.map_or_else(Vec::new, |force| {
            force.torques(blocks, model.gain_per_s, model.block_s)
        });
        let mut out = alloc::vec![None; n * blocks.len()];
        let mut row = alloc::vec![0.0; from.state.len()];
        let mut link_gain = 0.0;
        let pulling = model.reduced.routes.as_ref();
        for (b, block) in blocks.iter().enumerate() {
            let how = Linearisation {
                reference_c: from.temperature_c,
                changes: &from.changes,
                motor: model.motor_torque,
                force: force.zip(forces.get(b * n..(b + 1) * n)),
                content: Content::Rows,
            };
            let joints = (0..n).map(|i| Measured::of(&model.reduced, block, i));
            linearise(
                &model.reduced,
                block,
                joints,
                &how,
                &from.state,
                &mut equations,
            );
            for e in &equations.list {
                let unknown = variance(&equations, e, &from.covariance, &mut row);
                if let Some(routes) = pulling.filter(|routes| routes.pulled(e.joint).is_some()) {
                    if e.side == Side::Link {
                        let of_block = &mut out[b * n..(b + 1) * n];
                        of_tendons(routes, &equations, e, unknown, of_block);
                    }
                    continue;
                }
                let own = &mut out[b * n + e.joint];
                match (e.side, own) {
                    (Side::Link, own) => {
                        *own = Some(Innovation {
                            residual_rad: e.residual,
                            parameter_variance_rad2: unknown,
                            held_rad: e.added_std,
                            offset_gain: equations.entry(e, ChangeKind::Offset(e.joint), 0),
                            motor: None,
                        });
                        link_gain = e.torque_gain;
                    }
                    // It follows on the link equation of its joint.
                    (Side::Motor, Some(own)) if e.torque_gain != 0.0 => {
                        own.motor = Some(MotorInnovation {
                            residual_nm: e.residual,
                            variance_nm2: unknown + e.added_std * e.added_std,
                            rad_per_nm: link_gain / e.torque_gain,
                        });
                    }
                    (Side::Motor | Side::Tension, _) => {}
                }
            }
        }
        out
    }
}

/// Innovation of a joint that several tendons pull, for each tendon whose offset it shows most, in rad of that.
fn of_tendons(
    routes: &Routings,
    equations: &Equations,
    e: &Equation,
    unknown_rad2: f64,
    out: &mut [Option<Innovation>],
) {
    for (i, own) in out.iter_mut().enumerate() {
        let (joint, share) = routes.shown_at(i);
        if routes.pull(i).is_none() || joint != e.joint || share == 0.0 {
            continue;
        }
        *own = Some(Innovation {
            residual_rad: e.residual / share,
            parameter_variance_rad2: unknown_rad2 / (share * share),
            held_rad: e.added_std / share.abs(),
            // A slack strand contains no step.
            offset_gain: equations.entry(e, ChangeKind::Offset(i), 0) / share,
            motor: None,
        })
        .filter(|own| own.offset_gain != 0.0);
    }
}

/// Returns `H P Hᵀ` of an equation; `row` is a buffer for `H`.
fn variance(equations: &Equations, e: &Equation, covariance: &[f64], row: &mut [f64]) -> f64 {
    row.fill(0.0);
    equations.add_to(e, 1.0, row);
    let entries = || row.iter().enumerate().filter(|(_, h)| **h != 0.0);
    let total = row.len();
    entries()
        .map(|(i, a)| {
            let line = &covariance[i * total..(i + 1) * total];
            a * entries().map(|(k, b)| b * line[k]).sum::<f64>()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::config::FeatureConfig;
    use crate::offset::fixtures::{random, slipping, turntable};
    use crate::offset::prior::Prior;
    use crate::offset::state_estimate::{Payload, UNKNOWN_OFFSET_RAD};

    /// The state is drawn from the posterior many times: residuals around the mean spread as predicted.
    #[test]
    fn innovations_spread_by_posterior_variance() {
        const DRAWS: usize = 4000;
        let prior: Prior = turntable().prior;
        let estimator = MapEstimator::new(prior.clone(), &FeatureConfig::default());
        let blocks = slipping(&turntable(), 0.0, 4);
        let believed = prior.state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let map = estimator
            .solve(&believed, &[], Payload::Empty, &blocks)
            .unwrap();
        let prediction = estimator.prediction(&map);
        let block = &blocks[3..4];
        let expected = estimator.innovations(&prediction, block)[0].unwrap();
        let residual = estimator.residuals(&map, block)[0];
        assert!((expected.residual_rad - residual).abs() < 1e-12);
        let total = prediction.state.len();
        let mut factor = alloc::vec![0.0; total * total];
        let mut covariance = prediction.covariance.clone();
        (0..total).for_each(|k| covariance[k * (total + 1)] += 1e-18);
        crate::cholesky::factorise(&covariance, &mut factor, total).unwrap();
        let mut seed = 9;
        let mut sum = 0.0;
        for _ in 0..DRAWS {
            let normal: Vec<f64> = (0..total)
                .map(|_| (0..12).map(|_| 0.5 * random(&mut seed)).sum::<f64>())
                .collect();
            let mut drawn = prediction.clone();
            // A thousandth of a deviation: the equation is not quite linear.
            for (i, x) in drawn.state.iter_mut().enumerate() {
                let line = &factor[i * total..=i * total + i];
                *x += 1e-3 * crate::cholesky::dot(line, &normal[..=i]);
            }
            let off = estimator.innovations(&drawn, block)[0]
                .unwrap()
                .residual_rad;
            sum += (1e3 * (off - expected.residual_rad)).powi(2);
        }
        let found = sum / DRAWS as f64;
        let ratio = found / expected.parameter_variance_rad2;
        // Four standard deviations of a variance from so many draws.
        let tolerance = 4.0 * libm::sqrt(2.0 / DRAWS as f64);
        assert!((ratio - 1.0).abs() < tolerance, "{ratio}");
    }

    /// An unmodelled torque on the link appears in both innovations, scaled by the returned factor.
    #[test]
    fn link_torque_changes_both_innovations() {
        const TORQUE_NM: f64 = 0.3;
        let mut prior: Prior = turntable().prior;
        for joint in prior.joints.iter_mut().flatten() {
            joint.motor_inertia_kg_m2 = Some(0.0);
        }
        let stiffness = prior.joints[0].unwrap().stiffness_nm_per_rad;
        let estimator = MapEstimator::new(prior.clone(), &FeatureConfig::default());
        let mut blocks = slipping(&turntable(), 0.0, 4);
        blocks.iter_mut().for_each(|b| b.motor_torque[0] = 0.0);
        let believed = prior.state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let map = estimator
            .solve(&believed, &[], Payload::Empty, &blocks)
            .unwrap();
        let prediction = estimator.prediction(&map);
        let of = |block: &Block| {
            estimator.innovations(&prediction, core::slice::from_ref(block))[0].unwrap()
        };
        let before = of(&blocks[3]);
        let pushed = &mut blocks[3];
        let y = pushed.y[0] + TORQUE_NM / stiffness;
        (pushed.y[0], pushed.y_square[0], pushed.y_cube[0]) = (y, y * y, y * y * y);
        pushed.motor_torque[0] += TORQUE_NM;
        let after = of(pushed);
        let (motor, motor_before) = (after.motor.unwrap(), before.motor.unwrap());
        let moved_nm = motor.residual_nm - motor_before.residual_nm;
        assert!((moved_nm - TORQUE_NM).abs() < 1e-12, "{moved_nm}");
        // Except for the posterior corrections of stiffness, scale and stiffening.
        let drift_rad = after.residual_rad - before.residual_rad;
        let ratio = drift_rad / (motor.rad_per_nm * moved_nm);
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
        assert!(motor.variance_nm2 > 0.0);
    }
}
