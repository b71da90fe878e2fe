//! Gauss–Newton on the posterior of one recording.

use super::block::Block;
use super::changes::Change;
use super::cost::{chi, variance};
use super::course::{COLD, NEARLY, OFF, ON, See, Step, THIN};
use super::equation::{Equation, Equations, Side};
use super::layout::Layout;
use super::linear::Look;
use super::map::{MapError, MapEstimate, MapEstimator};
use super::measured::Measured;
use super::normal::{Normal, Residuals, pose_runs};
use super::prior::{Belief, Payload};
use super::solution::{Solution, covariance};
use crate::cholesky;
use alloc::vec::Vec;
use core::ops::Range;

/// A recording, and what is believed before it.
pub(super) struct Problem<'a> {
    pub(super) estimator: &'a MapEstimator,
    /// What was believed before, of all bodies' parameters.
    before: &'a Belief,
    /// The same of the model's.
    pub(super) start: Belief,
    /// Inverse of the covariance of `start`.
    information: Vec<f64>,
    /// What was opened in `before`; it sets what a change of payload may be.
    pub(super) payload: Payload,
    pub(super) blocks: &'a [Block],
    /// What they say of every joint, `n` a block.
    measured: Vec<Option<Measured>>,
    /// Variance of a block's mean over that of independent noise, per block.
    pub(super) inflation: Vec<f64>,
}

/// What some blocks say.
struct Part {
    blocks: Range<usize>,
    normal: Normal,
    residuals: Residuals,
    equations: Equations,
    /// How much each of them counts.
    weights: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        estimator: &'a MapEstimator,
        before: &'a Belief,
        payload: Payload,
        blocks: &'a [Block],
    ) -> Result<Self, MapError> {
        let d = estimator.prior().dimension();
        if before.mean.len() != d || before.covariance.len() != d * d {
            return Err(MapError::Dimension {
                expected: d,
                found: before.mean.len(),
            });
        }
        if blocks.is_empty() {
            return Err(MapError::NoData);
        }
        let model = estimator.model();
        let start = model.believed(before);
        Ok(Self {
            estimator,
            before,
            information: covariance(&start.covariance, start.mean.len())?,
            start,
            payload,
            blocks,
            measured: (blocks.iter())
                .flat_map(|block| (0..model.layout.joints).map(|i| model.measured(block, i)))
                .collect(),
            inflation: pose_runs(blocks)
                .iter()
                .map(|r| r.max(estimator.inflation()))
                .collect(),
        })
    }

    /// The estimate in terms of all bodies' parameters, with its covariance.
    pub(super) fn complete(&self, solution: Solution) -> Result<MapEstimate, MapError> {
        let Solution {
            mut estimate,
            information,
            ..
        } = solution;
        let own = covariance(&information, estimate.state.len())?;
        let model = self.estimator.model();
        (estimate.state, estimate.covariance) =
            model.completed(self.before, &estimate.state, &own)?;
        Ok(estimate)
    }

    /// The estimate with changes at known moments.
    pub(super) fn solve(&self, changes: &[Change]) -> Result<Solution, MapError> {
        self.descend(changes, COLD, None)
    }

    /// [`Problem::solve`] from a state with its noise, by a course for how near that is.
    pub(super) fn solve_from(
        &self,
        changes: &[Change],
        state: &[f64],
        known: &MapEstimate,
        course: &[Step],
    ) -> Result<Solution, MapError> {
        self.descend(changes, course, Some((state, known)))
    }

    /// To the end from a [`LOOK`].
    pub(super) fn solve_on(&self, look: &Solution) -> Result<Solution, MapError> {
        let at = &look.estimate;
        self.solve_from(&at.changes, &at.state, at, ON)
    }

    /// The estimate without the changes of `with`: two steps from what that says of it, which is all
    /// of it where equations are linear.
    pub(super) fn solve_without(&self, with: &Solution) -> Result<Solution, MapError> {
        let state = with.state_without(self.total(&[]));
        self.solve_from(&[], &state, &with.estimate, NEARLY)
    }

    fn descend(
        &self,
        changes: &[Change],
        course: &[Step],
        warm: Option<(&[f64], &MapEstimate)>,
    ) -> Result<Solution, MapError> {
        let layout = self.layout();
        let n = layout.joints;
        let total = self.total(changes);
        let prior = self.prior_information(changes, total);
        let mut at = MapEstimate {
            changes: changes.to_vec(),
            state: self.origin(total),
            covariance: Vec::new(),
            temperature_c: self.start.temperature_c,
            noise_rad: alloc::vec![1e-3; n],
            motor_noise_nm: (0..n).map(|i| self.estimator.motor_floor(i)).collect(),
            weights: Vec::with_capacity(self.blocks.len()),
            cost: 0.0,
            stiffness_since: alloc::vec![None; n],
            certainties: Vec::new(),
        };
        if let Some((state, known)) = warm {
            at.state.copy_from_slice(state);
            at.noise_rad.copy_from_slice(&known.noise_rad);
            at.motor_noise_nm.copy_from_slice(&known.motor_noise_nm);
        }
        let mut parts = self.parts(changes, course);
        for (stage, step) in course.iter().enumerate() {
            let (first, others) = parts.split_at_mut(1);
            let first = &mut first[0];
            first.normal.start(&prior, &self.prior_pull(&at));
            match others {
                [] => self.sum(&at, step, first),
                [other, ..] => {
                    other.normal.clear();
                    self.estimator
                        .hands()
                        .both(&mut || self.sum(&at, step, first), &mut || {
                            self.sum(&at, step, other)
                        });
                    first.normal.take_over(&mut other.normal);
                }
            }
            first.normal.solve()?;
            for (x, step) in at.state.iter_mut().zip(&first.normal.gradient) {
                *x += step;
            }
            // Noise from the residuals, once they mean something.
            if stage >= 2 || warm.is_some() {
                let floor = self.estimator.noise_floor_rad();
                for i in 0..n {
                    let noise =
                        |side| Residuals::noise(parts.iter().map(|p| &p.residuals), i, side);
                    at.noise_rad[i] = noise(Side::Link).max(floor);
                    at.motor_noise_nm[i] = noise(Side::Motor).max(self.estimator.motor_floor(i));
                }
            }
        }
        let every = course
            .last()
            .map_or(1, |step| step.pull.every(self.blocks.len()));
        at.cost = self.cost_over(&at, &at, every);
        for part in &mut parts {
            at.weights.append(&mut part.weights);
        }
        let Normal {
            information,
            factor,
            ..
        } = parts.swap_remove(0).normal;
        Ok(Solution {
            estimate: at,
            information,
            factor,
        })
    }

    /// All blocks, by halves where a course goes to the end: what is only looked at is small, and
    /// looked at beside others.
    fn parts(&self, changes: &[Change], course: &[Step]) -> Vec<Part> {
        let count = self.blocks.len();
        let all_near = course.iter().all(|step| matches!(step.pull, See::Some));
        // Blocks that are looked at are multiples of `THIN`.
        let middle = count / 2 / THIN * THIN;
        let ranges = if all_near || middle == 0 {
            alloc::vec![0..count]
        } else {
            alloc::vec![0..middle, middle..count]
        };
        let layout = self.layout();
        let part = |blocks: Range<usize>| Part {
            normal: Normal::new(self.total(changes), layout),
            residuals: Residuals::new(layout.joints, blocks.clone()),
            equations: Equations::new(layout, changes),
            weights: alloc::vec![1.0; blocks.len()],
            blocks,
        };
        ranges.into_iter().map(part).collect()
    }

    /// Adds up what the blocks of a part say for a step from `at`.
    fn sum(&self, at: &MapEstimate, step: &Step, part: &mut Part) {
        let [every, informing] = [step.pull, step.inform].map(|see| see.every(self.blocks.len()));
        for b in part.blocks.clone().step_by(every) {
            self.equations(at, b, Look::Rows, &mut part.equations);
            let w = step.scale * step.scale;
            let w = w / (w + chi(&part.equations, at));
            part.weights[b - part.blocks.start] = w * w;
            let counts = step.is_wide() || w * w > OFF;
            part.residuals.keep(b, &part.equations, counts);
            let information = |e: &_| w * w * self.information_of(e, at, b);
            part.normal
                .add_gradient(&part.equations, |e| every as f64 * information(e));
            if b % informing == 0 {
                part.normal
                    .add_information(&part.equations, |e| informing as f64 * information(e));
            }
        }
    }

    /// Equations of block `b` around an estimate.
    pub(super) fn equations(&self, at: &MapEstimate, b: usize, look: Look, out: &mut Equations) {
        let model = self.estimator.model();
        let n = model.layout.joints;
        let joints = self.measured[b * n..(b + 1) * n].iter().copied();
        let motor = self.estimator.uses_motor_torque();
        let with = (at.temperature_c, at.changes.as_slice(), motor, look);
        model.linearise_measured(&self.blocks[b], joints, with, &at.state, out);
    }

    /// Of the model's state.
    pub(super) fn layout(&self) -> Layout {
        self.estimator.model().layout
    }

    /// Length of the state with so many changes.
    pub(super) fn total(&self, changes: &[Change]) -> usize {
        let more: usize = changes.iter().map(|c| c.what.columns()).sum();
        self.start.mean.len() + more
    }

    /// Mean before the recording; no change.
    pub(super) fn origin(&self, total: usize) -> Vec<f64> {
        let mut origin = self.start.mean.clone();
        origin.resize(total, 0.0);
        origin
    }

    /// Information of an equation of block `b` at full weight.
    pub(super) fn information_of(&self, e: &Equation, at: &MapEstimate, b: usize) -> f64 {
        1.0 / (variance(e, at) * self.inflation[b])
    }

    fn prior_information(&self, changes: &[Change], total: usize) -> Vec<f64> {
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
            for deviation in self.deviations(change) {
                information[k * total + k] = 1.0 / (deviation * deviation);
                k += 1;
            }
        }
        information
    }

    /// What the prior pulls at the state with: the gradient of its share of the cost, downwards.
    pub(super) fn prior_pull(&self, at: &MapEstimate) -> Vec<f64> {
        let d = self.start.mean.len();
        let (state, changes) = at.state.split_at(d);
        let from: Vec<f64> = state
            .iter()
            .zip(&self.start.mean)
            .map(|(x, m)| m - x)
            .collect();
        let rows = self.information.chunks_exact(d);
        let mut pull: Vec<f64> = rows.map(|row| cholesky::dot(row, &from)).collect();
        let deviations = at.changes.iter().flat_map(|c| self.deviations(c));
        pull.extend(changes.iter().zip(deviations).map(|(x, s)| -x / (s * s)));
        pull
    }

    /// Normal equations around `at`, with nothing but the prior in them yet.
    pub(super) fn prior_equations(&self, at: &MapEstimate) -> Normal {
        let total = at.state.len();
        let mut normal = Normal::new(total, self.layout());
        let prior = self.prior_information(&at.changes, total);
        normal.start(&prior, &self.prior_pull(at));
        normal
    }
}
