//! The predictive distribution of blocks under a posterior: innovations of the link equations.
//!
//! ```text
//! e_i = y_i − h_i(x̂),   var e_i = H_i P H_iᵀ + σ_i²
//! ```
//!
//! `x̂`, `P`: mean and covariance of the posterior, `h_i` the link equation of joint `i`, `H_i` its Jacobian, `σ_i` the noise,
//! which the caller adds.

use super::map_estimator::MapEstimator;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::effects::Measured;
use crate::offset::equations::equation::{Equation, Equations, Side};
use crate::offset::equations::linearise::{Content, Linearisation, linearise};
use crate::offset::estimate::MapEstimate;
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
    /// `H P Hᵀ`, what the posterior leaves unknown of it, rad²; the noise is not in it.
    pub parameter_variance_rad2: f64,
    /// Deviation of what friction may hold in a long stand, rad: it stays for as long as the arm does.
    pub held_rad: f64,
    /// `∂h/∂δ_e`: 1 but where the spring stiffens.
    pub offset_gain: f64,
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
        for (b, block) in blocks.iter().enumerate() {
            let how = Linearisation {
                reference_c: from.temperature_c,
                changes: &from.changes,
                motor: false,
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
            for e in equations.list.iter().filter(|e| e.side == Side::Link) {
                out[b * n + e.joint] = Some(Innovation {
                    residual_rad: e.residual,
                    parameter_variance_rad2: variance(&equations, e, &from.covariance, &mut row),
                    held_rad: e.added_deviation,
                    offset_gain: equations.entry(e, ChangeKind::Offset(e.joint), 0),
                });
            }
        }
        out
    }
}

/// `H P Hᵀ` of an equation; `row` is room for `H`.
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
    use crate::offset::belief::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::offset::config::FeatureConfig;
    use crate::offset::fixtures::{random, slipping, turntable};
    use crate::offset::prior::Prior;

    /// A state is drawn from the posterior many times: residuals around the mean spread as the prediction says.
    #[test]
    fn innovations_spread_by_what_the_posterior_leaves_unknown() {
        const DRAWS: usize = 4000;
        let prior: Prior = turntable().prior;
        let estimator = MapEstimator::new(prior.clone(), &FeatureConfig::default());
        let blocks = slipping(&turntable(), 0.0, 4);
        let believed = prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
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
}
