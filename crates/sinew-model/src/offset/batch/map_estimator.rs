//! Robust maximum-a-posteriori estimate of offsets and of what disguises itself as them.
//!
//! All joints are estimated together: a wrong mass shows at several joints, a stretched rope at
//! one. Every nuisance parameter has a prior from a data sheet's tolerance; a baseline recording,
//! taken right after tensioning, turns the prior into a posterior that later recordings start
//! from.
//!
//! ```text
//! LP[x + η x³] = τ (1 + δκ + c_K ΔT) / K,   x = theta_measured − q − delta_e − encoder(q) − α_T ΔT
//! τ = Φ (π₀ + δπ) + payload + F_c z + F_v dq + μ z |τ|
//! u = (1 + k)(τ + J ddtheta + F_m z_m + F_vm dtheta + μ_m z_m |τ|) + b + noise
//! ```
//!
//! Gauss–Newton on the whole posterior with a redescending weight on the joint normalised
//! residual of each block (all joints of a block share one weight: a contact shows at several),
//! annealed from a wide scale so that the start doesn't matter.

use super::gauss_newton;
use super::problem::Problem;
use super::search::ChangePointSearch;
use crate::arm::Arm;
use crate::offset::belief::{Belief, Payload};
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint, SearchScope};
use crate::offset::config::FeatureConfig;
use crate::offset::effects::Measured;
use crate::offset::equations::equation::{Equations, Side};
use crate::offset::equations::estimation_model::EstimationModel;
use crate::offset::equations::linearise::{Linearisation, linearise};
use crate::offset::equations::loaded::Content;
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use crate::offset::executor::{Executor, Sequential};
use crate::offset::external_force::{ExternalForce, ForceModel};
use crate::offset::prior::Prior;
use alloc::vec::Vec;

/// Solves for offsets and nuisance parameters together.
#[derive(Debug, Clone)]
pub struct MapEstimator {
    model: EstimationModel,
    executor: &'static dyn Executor,
}

impl MapEstimator {
    /// An estimator for the priors of a robot and blocks made with `features`.
    pub fn new(prior: Prior, features: &FeatureConfig) -> Self {
        Self {
            model: EstimationModel::new(prior, features),
            executor: &Sequential,
        }
    }

    /// Whether a recorded motor torque is used; it is unless this says otherwise.
    #[must_use]
    pub fn with_motor_torque(mut self, used: bool) -> Self {
        self.model.motor_torque = used;
        self
    }

    /// Who runs what can be done at once; sequential unless this says otherwise.
    #[must_use]
    pub fn with_executor(mut self, executor: &'static dyn Executor) -> Self {
        self.executor = executor;
        self
    }

    /// Whether a recorded motor torque is used.
    pub fn uses_motor_torque(&self) -> bool {
        self.model.motor_torque
    }

    /// The priors.
    pub fn prior(&self) -> &Prior {
        &self.model.prior
    }

    /// A constant force from outside that may act on `arm` where a payload is expected: searches look for it, or take it
    /// for true. None is sought unless this says so.
    #[must_use]
    pub fn with_external_force(mut self, arm: &Arm, force: Option<ExternalForce>) -> Self {
        let prior = &self.model.prior;
        let place = (prior.payload_body, prior.payload_at);
        self.model.force = force
            .filter(|_| arm.dof() == prior.joints())
            .map(|force| ForceModel::new(force, arm, place, prior.reach_m()));
        self
    }

    /// What its equations rest on.
    pub(super) fn model(&self) -> &EstimationModel {
        &self.model
    }

    /// Lag-one autocorrelation of the noise of consecutive blocks, 0 to 1, that of the low-pass and of friction's stroke: the
    /// noise of a block is taken as a first-order autoregression, whose mean over `m` blocks has `(1 + ρ)/(1 − ρ)` times the variance of
    /// independent noise.
    pub fn noise_autocorrelation(&self) -> f64 {
        (self.model.inflation - 1.0) / (self.model.inflation + 1.0)
    }

    /// How much of a block's information counts, 0 to 1: by how far the arm travels in it.
    pub fn information_share(&self, block: &Block) -> f64 {
        self.model.share(block)
    }

    /// The estimate from `blocks` with changes at known times.
    ///
    /// `payload` is what was opened in `start`; it sets what a change of payload may be.
    ///
    /// # Errors
    /// [`MapError`].
    pub fn solve(
        &self,
        start: &Belief,
        changes: &[ChangePoint],
        payload: Payload,
        blocks: &[Block],
    ) -> Result<MapEstimate, MapError> {
        let problem = Problem::new(&self.model, self.executor, start, payload, blocks)?;
        problem.complete(gauss_newton::solve(&problem, changes)?)
    }

    /// The estimate from `blocks`, sudden changes found on the way.
    ///
    /// The score of every possible change at every time is computed from the estimate that knows of
    /// none: its gradient against what the rest of the state can't take up, in fits whose weights
    /// neither let a contact count by its size nor throw a true change away as a contact. The best
    /// times of every kind are put into the estimate, and the one that takes most off the robust cost
    /// stays, if that is enough; changes it made needless go; so on until nothing is left.
    ///
    /// # Errors
    /// [`MapError`].
    pub fn search(
        &self,
        start: &Belief,
        blocks: &[Block],
        payload: Payload,
        scope: SearchScope,
    ) -> Result<MapEstimate, MapError> {
        let problem = Problem::new(&self.model, self.executor, start, payload, blocks)?;
        ChangePointSearch {
            problem: &problem,
            scope,
        }
        .run()
    }

    /// What the link equations of blocks that follow each other leave, `n` a block, rad; 0 for a rigid joint.
    pub fn residuals(&self, at: &MapEstimate, blocks: &[Block]) -> Vec<f64> {
        let model = &self.model;
        let reduced = &model.reduced;
        let n = reduced.layout.joints;
        let mut equations = Equations::new(reduced.layout, &at.changes);
        let state = reduced.reduced(&at.state);
        let acts = at.changes.iter().any(|c| c.kind == ChangeKind::Force);
        let force = model.force.as_ref().filter(|_| acts);
        let forces = force.map_or_else(Vec::new, |force| {
            force.torques(blocks, model.gain_per_s, model.block_s)
        });
        let mut out = alloc::vec![0.0; n * blocks.len()];
        for (b, (block, out)) in blocks
            .iter()
            .zip(out.chunks_exact_mut(n.max(1)))
            .enumerate()
        {
            let forces = forces.get(b * n..(b + 1) * n);
            let how = Linearisation {
                reference_c: at.temperature_c,
                changes: &at.changes,
                motor: model.motor_torque,
                force: force.zip(forces),
                content: Content::Residuals,
            };
            let joints = (0..n).map(|i| Measured::of(reduced, block, i));
            linearise(reduced, block, joints, &how, &state, &mut equations);
            for e in equations.list.iter().filter(|e| e.side == Side::Link) {
                if let Some(slot) = out.get_mut(e.joint) {
                    *slot = e.residual;
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Gaussian;
    use crate::offset::belief::UNKNOWN_OFFSET_RAD;
    use crate::offset::fixtures::{pushable, pushed};

    /// What the force does is in no joint's residuals; without it that is all they are.
    #[test]
    fn residuals_know_of_the_force_of_their_estimate() {
        const ACTS_N: [f64; 3] = [2.0, -1.5, 0.0];
        const NOISE_RAD: f64 = 0.1e-3;
        let model = pushable(ExternalForce {
            force_n: ACTS_N.map(|mean| Gaussian::new(mean, 0.1)),
            is_stated: true,
        });
        let blocks = pushed(&model, ACTS_N, 5);
        let mut estimator = MapEstimator {
            model,
            executor: &Sequential,
        };
        let believed = estimator.prior().belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let acts = ChangePoint {
            kind: ChangeKind::Force,
            at_s: 0.0,
        };
        let map = estimator
            .solve(&believed, &[acts], Payload::Empty, &blocks)
            .unwrap();
        let worst = |estimator: &MapEstimator, joint: usize| {
            let all = estimator.residuals(&map, &blocks);
            assert_eq!(all.len(), 2 * blocks.len());
            let own = all.chunks_exact(2).map(|pair| pair[joint].abs());
            own.fold(0.0, f64::max)
        };
        let known = [0, 1].map(|joint| worst(&estimator, joint));
        estimator.model.force = None;
        let unknown = [0, 1].map(|joint| worst(&estimator, joint));
        // Up to 2.5 N on 0.4 m bend springs of 40 N·m/rad by 25 mrad.
        assert!(known.iter().all(|rad| *rad < 1.5 * NOISE_RAD), "{known:?}");
        assert!(unknown.iter().all(|rad| *rad > 20e-3), "{unknown:?}");
    }
}
