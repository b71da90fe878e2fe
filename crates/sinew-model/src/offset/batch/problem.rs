//! Recording with its prior.

use super::normal::{NormalEquations, pose_runs};
use super::solution::{Solution, covariance};
use crate::cholesky;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint, SearchScope};
use crate::offset::effects::Measured;
use crate::offset::effects::external_force::ForceTorque;
use crate::offset::equations::equation::{Equation, Equations, Side};
use crate::offset::equations::estimation_model::EstimationModel;
use crate::offset::equations::linearise::{Linearisation, linearise};
use crate::offset::equations::loaded::Content;
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use crate::offset::executor::Executor;
use crate::offset::layout::Layout;
use crate::offset::mixture::{CREEP, LOST_STIFFNESS};
use crate::offset::state_estimate::{Payload, StateEstimate, UNKNOWN_OFFSET_RAD};
use alloc::vec::Vec;

/// Relative standard deviation of the stiffness change at a suspected event, as of a strand failure.
const STRAND: f64 = 0.05;
/// Minimum data before and after a change, s: contacts are shorter.
const EDGE_S: f64 = 5.0;
/// Minimum data after a step with an independent indication, s: six time constants of the low-pass, in which it
/// appears.
const ONSET_EDGE_S: f64 = 2.0;

/// Recording with its prior.
pub(super) struct Problem<'a> {
    pub(super) model: &'a EstimationModel,
    pub(super) executor: &'a dyn Executor,
    /// Prior of all bodies' parameters.
    before: &'a StateEstimate,
    /// Prior of the reduced model's.
    pub(super) start: StateEstimate,
    /// Inverse of the covariance of `start`.
    information: Vec<f64>,
    /// Payload prior that was freed in `before`; it determines the prior of a payload change.
    pub(super) payload: Payload,
    pub(super) blocks: &'a [Block],
    /// Measurements of every joint, `n` per block.
    measured: Vec<Option<Measured>>,
    /// Torques of an external force on every joint, `n` per block; empty if none is searched for.
    forces: Vec<ForceTorque>,
    /// Ratio of the variance of a block mean to that of independent noise, per block.
    pub(super) inflation: Vec<f64>,
    /// Whether rounds of a repeated motion are independent in `inflation`.
    has_independent_rounds: bool,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        model: &'a EstimationModel,
        executor: &'a dyn Executor,
        before: &'a StateEstimate,
        payload: Payload,
        blocks: &'a [Block],
    ) -> Result<Self, MapError> {
        before.check_dimension(model.prior.dimension())?;
        if blocks.is_empty() {
            return Err(MapError::NoData);
        }
        let reduced = &model.reduced;
        let start = reduced.reduced_estimate(before);
        let joints = reduced.layout.joints;
        Ok(Self {
            model,
            executor,
            before,
            information: covariance(&start.covariance, start.mean.len())?,
            start,
            payload,
            blocks,
            measured: (blocks.iter())
                .flat_map(|block| (0..joints).map(|i| Measured::of(reduced, block, i)))
                .collect(),
            forces: (model.force.as_ref()).map_or_else(Vec::new, |force| {
                force.torques(blocks, model.gain_per_s, model.block_s)
            }),
            inflation: (pose_runs(blocks).iter().zip(blocks))
                .map(|(run, block)| run.max(1.0 / model.share(block)) * same_again(block))
                .collect(),
            has_independent_rounds: false,
        })
    }

    /// Whether a motion repeats so often that its rounds share their information.
    pub(super) fn has_rounds(&self) -> bool {
        self.blocks.iter().any(|block| same_again(block) > 1.0)
    }

    /// The problem with rounds of a repeated motion as independent.
    pub(super) fn with_independent_rounds(mut self) -> Self {
        for (inflation, block) in self.inflation.iter_mut().zip(self.blocks) {
            *inflation /= same_again(block);
        }
        self.has_independent_rounds = true;
        self
    }

    /// The estimate in terms of all bodies' parameters, with its covariance.
    pub(super) fn complete(&self, solution: Solution) -> Result<MapEstimate, MapError> {
        let Solution {
            mut estimate,
            information,
            ..
        } = solution;
        let own = covariance(&information, estimate.state.len())?;
        let reduced = &self.model.reduced;
        (estimate.state, estimate.covariance) =
            reduced.completed(self.before, &estimate.state, &own)?;
        Ok(estimate)
    }

    /// Layout of the reduced model's state.
    pub(super) fn layout(&self) -> Layout {
        self.model.reduced.layout
    }

    /// Length of the state with these changes.
    pub(super) fn total(&self, changes: &[ChangePoint]) -> usize {
        let more: usize = changes.iter().map(|c| c.kind.columns()).sum();
        self.start.mean.len() + more
    }

    /// Mean before the recording; no change.
    pub(super) fn origin(&self, total: usize) -> Vec<f64> {
        let mut origin = self.start.mean.clone();
        origin.resize(total, 0.0);
        origin
    }

    /// When block `b` begins, s.
    pub(super) fn start_of(&self, b: usize) -> f64 {
        self.blocks[b].time_s - 0.5 * self.model.block_s
    }

    /// When the last block ends, s.
    pub(super) fn end_s(&self) -> f64 {
        let last = self.blocks.last();
        last.map_or(0.0, |b| b.time_s + 0.5 * self.model.block_s)
    }

    /// Equations of block `b` around an estimate.
    pub(super) fn equations(
        &self,
        at: &MapEstimate,
        b: usize,
        content: Content,
        out: &mut Equations,
    ) {
        let reduced = &self.model.reduced;
        let n = reduced.layout.joints;
        let joints = self.measured[b * n..(b + 1) * n].iter().copied();
        let how = Linearisation {
            reference_c: at.temperature_c,
            changes: &at.changes,
            motor: self.model.motor_torque,
            force: (self.model.force.as_ref()).zip(self.forces.get(b * n..(b + 1) * n)),
            content,
        };
        linearise(reduced, &self.blocks[b], joints, &how, &at.state, out);
    }

    /// Information of an equation of block `b` at full weight.
    pub(super) fn information_of(&self, e: &Equation, at: &MapEstimate, b: usize) -> f64 {
        1.0 / (variance(e, at) * self.inflation[b])
    }

    /// [`information_of`](Self::information_of) with rounds of a repeated motion that share their information.
    pub(super) fn shared_information_of(&self, e: &Equation, at: &MapEstimate, b: usize) -> f64 {
        let rounds = match self.has_independent_rounds {
            true => same_again(&self.blocks[b]),
            false => 1.0,
        };
        self.information_of(e, at, b) / rounds
    }

    /// Inverse of the prior covariance, extended by the prior of each change.
    pub(super) fn prior_information(&self, changes: &[ChangePoint], total: usize) -> Vec<f64> {
        let d = self.start.mean.len();
        let mut information = alloc::vec![0.0; total * total];
        for (row, own) in information
            .chunks_exact_mut(total)
            .zip(self.information.chunks_exact(d))
        {
            row[..d].copy_from_slice(own);
        }
        let mut k = d;
        for change in changes {
            for std in self.stds(change) {
                information[k * total + k] = 1.0 / (std * std);
                k += 1;
            }
        }
        information
    }

    /// Negative gradient of the prior's share of the cost.
    pub(super) fn prior_gradient(&self, at: &MapEstimate) -> Vec<f64> {
        let d = self.start.mean.len();
        let (state, changes) = at.state.split_at(d);
        let from: Vec<f64> = state
            .iter()
            .zip(&self.start.mean)
            .map(|(x, m)| m - x)
            .collect();
        let rows = self.information.chunks_exact(d);
        let mut gradient: Vec<f64> = rows.map(|row| cholesky::dot(row, &from)).collect();
        let stds = at.changes.iter().flat_map(|c| self.stds(c));
        gradient.extend(changes.iter().zip(stds).map(|(x, s)| -x / (s * s)));
        gradient
    }

    /// Normal equations around `at` that contain only the prior.
    pub(super) fn prior_equations(&self, at: &MapEstimate) -> NormalEquations {
        let total = at.state.len();
        let mut normal = NormalEquations::new(total, self.layout(), &at.changes);
        let prior = self.prior_information(&at.changes, total);
        normal.start(&prior, &self.prior_gradient(at));
        normal
    }

    /// Returns the prior standard deviations of the entries of a change.
    pub(super) fn stds(&self, change: &ChangePoint) -> Vec<f64> {
        match change.kind {
            ChangeKind::Compliance(_) if self.is_before_recording(change) => {
                alloc::vec![LOST_STIFFNESS.std]
            }
            kind => self.stds_within(kind),
        }
    }

    /// Returns the prior standard deviations of a change within the recording.
    pub(super) fn stds_within(&self, kind: ChangeKind) -> Vec<f64> {
        match kind {
            ChangeKind::Offset(_) => alloc::vec![UNKNOWN_OFFSET_RAD],
            ChangeKind::Compliance(_) => alloc::vec![STRAND],
            ChangeKind::Creep(_) => alloc::vec![CREEP.std],
            ChangeKind::Force => {
                let force = self.model.force.as_ref();
                force.map_or_else(Vec::new, |force| force.stds().to_vec())
            }
            ChangeKind::Payload => {
                let prior = &self.model.prior;
                let open = prior.payload_prior(Payload::Unknown);
                let stated = prior.payload_prior(self.payload);
                open.iter()
                    .zip(&stated)
                    .map(|(open, known)| libm::hypot(libm::hypot(open.mean, open.std), known.mean))
                    .collect()
            }
        }
    }

    /// Whether a change was there from the first block on.
    pub(super) fn is_before_recording(&self, change: &ChangePoint) -> bool {
        let first = self.blocks.first();
        first.is_some_and(|first| change.at_s <= first.time_s)
    }

    /// Whether a change at a time can be identified. A strand may have failed before the recording began, and a
    /// recording that continues a posterior may have a change at its first block; an offset or a payload that is
    /// free anyway may not.
    pub(super) fn is_possible(&self, kind: ChangeKind, at_s: f64, scope: SearchScope) -> bool {
        let early = scope.continues || matches!(kind, ChangeKind::Compliance(_));
        let from_s = if early { 0.0 } else { EDGE_S };
        let may_be = scope.onset.is_some_and(|onset| onset.may_be(kind, at_s));
        let to_s = if may_be { ONSET_EDGE_S } else { EDGE_S };
        let last = self.blocks.len() - 1;
        (self.start_of(0) + from_s..self.start_of(last) - to_s).contains(&at_s)
    }
}

/// Returns the factor by which repeated motion reduces the information of a block. Model errors repeat when the arm
/// repeats a motion, and provide no new information. A few repetitions are nearly independent: contacts and noise
/// differ.
pub(super) fn same_again(block: &Block) -> f64 {
    const INDEPENDENT_VISITS: f64 = 3.0;
    (block.visits / INDEPENDENT_VISITS).max(1.0)
}

/// Mean squared residual of a block, normalised by its expected variance.
pub(super) fn chi(equations: &Equations, at: &MapEstimate) -> f64 {
    let squares = equations
        .list
        .iter()
        .map(|e| e.residual * e.residual / variance(e, at));
    squares.sum::<f64>() / equations.list.len().max(1) as f64
}

/// Variance of an equation's residual.
fn variance(e: &Equation, at: &MapEstimate) -> f64 {
    let noise = noise_of(e.joint, e.side, at);
    noise * noise + e.added_std * e.added_std
}

/// Robust noise of a joint's equations.
pub(super) fn noise_of(joint: usize, side: Side, at: &MapEstimate) -> f64 {
    match side {
        Side::Link => at.noise_rad[joint],
        Side::Motor => at.motor_noise_nm[joint],
        Side::Tension => at.tension_noise_nm[joint],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::gauss_newton::solve;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{SLIPS_AT, random, slipping, turntable};

    /// Three blocks for each block of the fast arm, at a third of the speed.
    #[test]
    fn slower_motion_on_same_path_adds_no_information() {
        const FAST_RAD_PER_S: f64 = 0.3;
        let model = turntable();
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let std = |times: usize| {
            let passed = slipping(&model, 0.0, 4).into_iter();
            let blocks: Vec<Block> = passed
                .flat_map(|mut block| {
                    block.dq[0] *= FAST_RAD_PER_S / times as f64;
                    core::iter::repeat_n(block, times)
                })
                .collect();
            let problem =
                Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
            let map = problem.complete(solve(&problem, &[]).unwrap()).unwrap();
            map.offset(&model.prior, 0).std
        };
        let [fast, slow] = [1, 3].map(std);
        assert!((slow / fast - 1.0).abs() < 0.05, "{slow} {fast}");
    }

    /// From any state, changes included: without measurements the first step leads back to the prior.
    #[test]
    fn without_data_one_step_returns_to_prior() {
        let model = turntable();
        let blocks = slipping(&model, 1e-3, 4);
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem =
            Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let at_s = problem.start_of(SLIPS_AT);
        let changes = [
            ChangeKind::Offset(0),
            ChangeKind::Compliance(0),
            ChangeKind::Creep(0),
            ChangeKind::Payload,
        ]
        .map(|kind| ChangePoint { kind, at_s });
        let mut at = solve(&problem, &changes).unwrap().estimate;
        let mut seed = 6;
        for x in &mut at.state {
            *x += 0.01 * random(&mut seed);
        }
        let mut normal = problem.prior_equations(&at);
        normal.solve().unwrap();
        let origin = problem.origin(problem.total(&changes));
        for (k, ((x, step), origin)) in
            (at.state.iter().zip(&normal.gradient).zip(origin)).enumerate()
        {
            assert!(
                (x + step - origin).abs() < 1e-12,
                "{k}: {x} {step} {origin}"
            );
        }
    }
}
