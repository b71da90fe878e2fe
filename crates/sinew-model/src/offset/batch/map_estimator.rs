//! Robust maximum-a-posteriori estimate of offsets and of similar effects.
//!
//! All joints are estimated jointly: a wrong mass affects several joints, an elongated rope one. Every nuisance
//! parameter has a prior from the tolerance of a data sheet. A baseline recording directly after tensioning turns the
//! prior into a posterior from which later recordings start.
//!
//! ```text
//! LP[x + η x³] = τ (1 + δκ + c_K ΔT) / K,   x = theta_measured − q − delta_e − encoder(q) − α_T ΔT
//! τ = Φ (π₀ + δπ) + payload + F_c z + F_v dq + μ z |τ|
//! u = (1 + k)(τ + J ddtheta + F_m z_m + F_vm dtheta + μ_m z_m |τ|) + b + noise
//! ```
//!
//! Gauss–Newton on the whole posterior with a redescending weight on the joint normalised residual of each block (all
//! joints of a block share one weight, because a contact affects several joints), annealed from a wide scale so that
//! the result does not depend on the initial value.

use super::gauss_newton;
use super::model_error::{self, ModelError};
use super::problem::Problem;
use super::search::ChangePointSearch;
use crate::arm::Arm;
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
use crate::offset::state_estimate::{Payload, StateEstimate};
use alloc::vec::Vec;

/// Solves for offsets and nuisance parameters together.
#[derive(Debug, Clone)]
pub struct MapEstimator {
    model: EstimationModel,
    executor: &'static dyn Executor,
    /// Model error of the baseline, with which the evidence about causes is compared.
    model_error: Option<ModelError>,
    has_independent_rounds: bool,
}

impl MapEstimator {
    /// An estimator for the priors of a robot and blocks made with `features`.
    pub fn new(prior: Prior, features: &FeatureConfig) -> Self {
        Self {
            model: EstimationModel::new(prior, features),
            executor: &Sequential,
            model_error: None,
            has_independent_rounds: false,
        }
    }

    /// Specifies whether a recorded motor torque is used; the default is true.
    #[must_use]
    pub fn with_motor_torque(mut self, used: bool) -> Self {
        self.model.motor_torque = used;
        self
    }

    /// Sets the executor of parallel tasks; the default is sequential.
    #[must_use]
    pub fn with_executor(mut self, executor: &'static dyn Executor) -> Self {
        self.executor = executor;
        self
    }

    /// Whether a recorded motor torque is used.
    pub fn uses_motor_torque(&self) -> bool {
        self.model.motor_torque
    }

    /// Prior of the estimator.
    pub fn prior(&self) -> &Prior {
        &self.model.prior
    }

    /// Adds a constant external force that may act on `arm` where a payload is expected: searches for it, or estimates
    /// it if it is specified. The default is no force.
    #[must_use]
    pub fn with_external_force(mut self, arm: &Arm, force: Option<ExternalForce>) -> Self {
        let prior = &self.model.prior;
        let place = (prior.payload_body, prior.payload_at);
        self.model.force = force
            .filter(|_| arm.dof() == prior.joints())
            .map(|force| ForceModel::new(force, arm, place, prior.reach_m()));
        self
    }

    /// Sets the model error of the baseline that a session is compared with; the default is none, and then the evidence
    /// about causes contains the model error of the session only.
    #[must_use]
    pub fn with_model_error(mut self, error: Option<ModelError>) -> Self {
        self.model_error = error;
        self
    }

    /// Sets whether rounds of a repeated motion are independent in the search for changes; the default is that they share their
    /// information. They always share it in the resulting estimate and in the evidence about causes.
    ///
    /// Set it for a recording that is compared with a baseline: changes within the recording are relative to its own rounds. The model
    /// error of the offset, and of the evidence about causes, repeats in every round.
    #[must_use]
    pub fn with_independent_rounds(mut self, is_set: bool) -> Self {
        self.has_independent_rounds = is_set;
        self
    }

    /// Returns the model error of a baseline from its recording, around the estimate `found` without changes, whose weights
    /// are those of `blocks`. `start`: prior of the recording.
    ///
    /// # Errors
    /// Returns a [`MapError`] if a linear system cannot be solved.
    pub fn model_error(
        &self,
        start: &StateEstimate,
        found: &MapEstimate,
        blocks: &[Block],
    ) -> Result<ModelError, MapError> {
        let problem = Problem::new(&self.model, self.executor, start, Payload::Empty, blocks)?;
        let own = found.state_estimate(&self.model.prior);
        let at = MapEstimate {
            changes: Vec::new(),
            state: self.model.reduced.reduced_estimate(&own).mean,
            ..found.clone()
        };
        model_error::learned(&problem, &at)
    }

    /// Returns a model error with the variance that the state gained between a recording (`before`) and the prior of the next
    /// one (`after`).
    #[must_use]
    pub fn aged_model_error(
        &self,
        error: &ModelError,
        before: &StateEstimate,
        after: &StateEstimate,
    ) -> ModelError {
        let reduced = &self.model.reduced;
        let [before, after] = [before, after].map(|state| reduced.reduced_estimate(state));
        let d = after.mean.len();
        let mut out = error.clone();
        out.gain((0..d).map(|k| after.covariance[k * (d + 1)] - before.covariance[k * (d + 1)]));
        out
    }

    /// Returns the model of the estimator.
    pub(super) fn model(&self) -> &EstimationModel {
        &self.model
    }

    /// Lag-one autocorrelation of the noise of consecutive blocks, 0 to 1, that of the low-pass and of friction's stroke: the
    /// noise of a block is taken as a first-order autoregression, whose mean over `m` blocks has `(1 + ρ)/(1 − ρ)` times the variance of
    /// independent noise.
    pub fn noise_autocorrelation(&self) -> f64 {
        (self.model.inflation - 1.0) / (self.model.inflation + 1.0)
    }

    /// Length of the blocks, s.
    pub fn block_s(&self) -> f64 {
        self.model.block_s
    }

    /// Returns the share of a block's information that is used, 0 to 1, by the distance that the arm travels in it.
    pub fn information_share(&self, block: &Block) -> f64 {
        self.model.share(block)
    }

    /// Computes the estimate from `blocks` with changes at specified times.
    ///
    /// `payload` is the payload prior in `start`; it determines the prior of a payload change.
    ///
    /// # Errors
    /// Returns a [`MapError`].
    pub fn solve(
        &self,
        start: &StateEstimate,
        changes: &[ChangePoint],
        payload: Payload,
        blocks: &[Block],
    ) -> Result<MapEstimate, MapError> {
        let problem = Problem::new(&self.model, self.executor, start, payload, blocks)?;
        problem.complete(gauss_newton::solve(&problem, changes)?)
    }

    /// Computes the estimate from `blocks`, with a search for sudden changes.
    ///
    /// The score of every possible change at every time is computed from the estimate without changes: its gradient
    /// projected on the complement of the rest of the state, in fits whose weights neither let a contact dominate by
    /// its size nor reject a true change as a contact. The best times of every kind are added to the estimate, and the
    /// one with the largest decrease of the robust cost is kept if the decrease is sufficient. Changes that become
    /// unnecessary are removed; the search repeats until no change qualifies.
    ///
    /// # Errors
    /// Returns a [`MapError`] if a linear system cannot be solved.
    pub fn search(
        &self,
        start: &StateEstimate,
        blocks: &[Block],
        payload: Payload,
        scope: SearchScope,
    ) -> Result<MapEstimate, MapError> {
        let problem = || Problem::new(&self.model, self.executor, start, payload, blocks);
        let last = problem()?;
        let independent = match self.has_independent_rounds && last.has_rounds() {
            true => Some(problem()?.with_independent_rounds()),
            false => None,
        };
        ChangePointSearch {
            problem: independent.as_ref().unwrap_or(&last),
            last: &last,
            scope,
            model_error: self.model_error.as_ref(),
        }
        .run()
    }

    /// Returns the residuals of the link equations of consecutive blocks, `n` per block, rad; 0 for a rigid joint.
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
    use crate::offset::fixtures::{pushable, pushed};
    use crate::offset::state_estimate::UNKNOWN_OFFSET_RAD;

    /// The force does not appear in any residual; without the force the residuals are the same.
    #[test]
    fn residuals_exclude_estimated_force() {
        const TRUE_FORCE_N: [f64; 3] = [2.0, -1.5, 0.0];
        const NOISE_RAD: f64 = 0.1e-3;
        let model = pushable(ExternalForce {
            force_n: TRUE_FORCE_N.map(|mean| Gaussian::new(mean, 0.1)),
            is_specified: true,
        });
        let blocks = pushed(&model, TRUE_FORCE_N, 5);
        let mut estimator = MapEstimator {
            model,
            executor: &Sequential,
            model_error: None,
            has_independent_rounds: false,
        };
        let believed = estimator
            .prior()
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
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
