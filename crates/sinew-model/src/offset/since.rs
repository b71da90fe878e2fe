//! Stiffness that was lost between two recordings.

use super::changes::{Change, MOST_SOFTER, What};
use super::course::WARM;
use super::map::{MapError, MapEstimate, StiffnessSince};
use super::mixture::{self, Mixture, Odds};
use super::model::Model;
use super::prior::{Belief, JointParameter};
use super::solution::Solution;
use super::solve::Problem;
use crate::cholesky;
use alloc::vec::Vec;

/// Stiffness is opened by this for all that may have failed between two recordings, relative.
const STRANDS: f64 = 0.1;
/// That a joint's stiffness has changed between two recordings: a starting guess.
const ODDS: Odds = Odds {
    deviation: STRANDS,
    odds: 0.3,
};
/// What opening it must take off the cost for the search to start from it. Without such a
/// change it is below 3 in a minute of many poses, up to 6 in a quarter of a minute of six; with 8 %
/// less stiffness at two joints above 12.
const KEEP_SINCE: f64 = 8.0;

/// Joints whose stiffness is believed to better than what may have been lost: of others a loss
/// says nothing that the tolerance doesn't.
fn known_stiffness(model: &Model, belief: &Belief) -> Vec<usize> {
    let known = |i| belief.entry(model.layout.place(i, JointParameter::Compliance))[1] < STRANDS;
    let elastic = (0..model.layout.joints).filter(|&i| model.is_elastic(i));
    elastic.filter(|&i| known(i)).collect()
}

impl Problem<'_> {
    /// The estimate averaged over the joints whose stiffness has changed since the recording before.
    pub(super) fn averaged(
        &self,
        best: Solution,
        softer: Solution,
    ) -> Result<MapEstimate, MapError> {
        let found = best.estimate.changes.clone();
        let is_opened = found.iter().any(|c| self.is_since_before(c));
        let opened = if is_opened {
            best
        } else if found.is_empty() {
            softer
        } else {
            let known = &best.estimate;
            let changes = [&found[..], &softer.estimate.changes].concat();
            let mut state = known.state.clone();
            state.resize(self.total(&changes), 0.0);
            self.solve_from(&changes, &state, known, WARM)?
        };
        let mut out = self.complete(opened)?;
        let prior = self.estimator.prior();
        let (mut joints, mut columns) = (Vec::new(), Vec::new());
        let mut column = prior.dimension();
        for change in &out.changes {
            if let (What::Compliance(joint), true) = (change.what, self.is_since_before(change)) {
                joints.push(joint);
                columns.push(column);
            }
            column += change.what.columns();
        }
        let probability = mixture::average(&columns, ODDS, &mut out.state, &mut out.covariance)?;
        let total = out.state.len();
        for ((joint, column), probability) in joints.into_iter().zip(columns).zip(probability) {
            // Mean and square over both: without a change both are zero.
            let likely = probability.max(f64::MIN_POSITIVE);
            let (mean, variance) = (out.state[column], out.covariance[column * (total + 1)]);
            let softer = mean / likely;
            let square = (variance + mean * mean) / likely;
            out.stiffness_since[joint] = Some(StiffnessSince {
                probability,
                softer,
                deviation: libm::sqrt((square - softer * softer).max(0.0)),
            });
        }
        if !is_opened {
            out.fold(prior, |c| self.is_since_before(c));
        }
        Ok(out)
    }

    /// The estimate with every stiffness opened since the recording began: between two recordings
    /// strands may have failed at several joints, and opening one at a time leaves the others to
    /// look like slips and loads. `None` where no stiffness was known, or no strand does what it
    /// finds.
    pub(super) fn softer_since(&self) -> Result<Option<Solution>, MapError> {
        let Some(first) = self.blocks.first() else {
            return Ok(None);
        };
        let model = self.estimator.model();
        let changes: Vec<Change> = (known_stiffness(model, &self.start).into_iter())
            .map(|i| Change {
                what: What::Compliance(i),
                at_s: first.time_s - 0.5 * self.estimator.block_s(),
            })
            .collect();
        if changes.is_empty() {
            return Ok(None);
        }
        let trial = self.solve(&changes)?;
        let mut sizes = trial.estimate.state.iter().skip(model.layout.dimension());
        let possible = sizes.all(|size| size.abs() < MOST_SOFTER);
        Ok(possible.then_some(trial))
    }

    /// Whether stiffness is so surely lost that the search starts from there.
    pub(super) fn is_sure(&self, best: &Solution, softer: &Solution) -> bool {
        let before = self.cost_at(&best.estimate, &softer.estimate);
        before - softer.estimate.cost > KEEP_SINCE
    }

    /// What is believed of a change before: standard deviations of its entries.
    pub(super) fn deviations(&self, change: &Change) -> Vec<f64> {
        match change.what {
            What::Compliance(_) if self.is_since_before(change) => alloc::vec![STRANDS],
            what => self.estimator.change_deviations(what, self.payload),
        }
    }

    /// Whether a change was there from the first block on.
    pub(super) fn is_since_before(&self, change: &Change) -> bool {
        let first = self.blocks.first();
        first.is_some_and(|first| change.at_s <= first.time_s)
    }
}

/// Offsets averaged over the joints whose stiffness has changed, for an estimate that started with
/// every stiffness opened that was known.
///
/// A change `c ~ N(0, s²)` of some entries `E` of what was believed, `m₀, P₀`, makes `P₀ + s² E Eᵀ` of its covariance.
/// From `x, P` since then
///
/// ```text
/// c = A (x − m₀),   cov c = A P Aᵀ + s² − s⁴ Eᵀ (P₀ + s² E Eᵀ)⁻¹ E,   cov(x, c) = P Aᵀ
/// A = s² Eᵀ (P₀ + s² E Eᵀ)⁻¹
/// ```
///
/// and the mixture is that of [`mixture::average`].
#[derive(Debug, Clone)]
pub(super) struct Since {
    joints: Vec<usize>,
    /// Places of their offsets in the state.
    offsets: Vec<usize>,
    /// `A`, a row per joint.
    towards: Vec<f64>,
    /// What of `cov c` no data takes away.
    left: Vec<f64>,
    /// `P Aᵀ`, a row per joint.
    shared: Vec<f64>,
    values: Vec<f64>,
    covariance: Vec<f64>,
    mixture: Mixture,
}

impl Since {
    /// Opens every stiffness in `start`, of the model's parameters, that is known, and in `whole`, of
    /// all bodies' parameters; allocates here only.
    pub(super) fn open(
        model: &Model,
        start: &mut Belief,
        whole: &mut Belief,
    ) -> Result<Self, MapError> {
        let d = start.mean.len();
        let joints = known_stiffness(model, start);
        let place = |parameter| {
            joints
                .iter()
                .map(move |&i| model.layout.place(i, parameter))
        };
        let entries: Vec<usize> = place(JointParameter::Compliance).collect();
        let variance = STRANDS * STRANDS;
        for &k in &entries {
            start.covariance[k * d + k] += variance;
            whole.covariance[k * (whole.mean.len() + 1)] += variance;
        }
        let information = cholesky::inverse(&start.covariance, d).map_err(MapError::Prior)?;
        let (mut towards, mut left) = (Vec::new(), Vec::new());
        for &k in &entries {
            let row = &information[k * d..(k + 1) * d];
            towards.extend(row.iter().map(|q| variance * q));
            for &other in &entries {
                let own = if other == k { variance } else { 0.0 };
                left.push(own - variance * variance * row[other]);
            }
        }
        let n = joints.len();
        Ok(Self {
            offsets: place(JointParameter::Offset).collect(),
            towards,
            left,
            shared: alloc::vec![0.0; n * d],
            values: alloc::vec![0.0; 2 * n],
            covariance: alloc::vec![0.0; 4 * n * n],
            mixture: Mixture::new(n, n),
            joints,
        })
    }

    /// Averages what is believed now, from what was when it was opened.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n d²).
    pub(super) fn average(&mut self, start: &Belief, now: &Belief) {
        let (n, d) = (self.joints.len(), now.mean.len().max(1));
        let at = |x: &[f64], i: usize| x.get(i).copied().unwrap_or(f64::NAN);
        let rows = self.towards.chunks_exact(d);
        self.shared.fill(0.0);
        for (own, shared) in rows.clone().zip(self.shared.chunks_exact_mut(d)) {
            // Row by row, so that a processor adds side by side.
            for (a, line) in own.iter().zip(now.covariance.chunks_exact(d)) {
                for (to, p) in shared.iter_mut().zip(line) {
                    *to += a * p;
                }
            }
        }
        let changes = rows.clone().map(|own| {
            let from = now.mean.iter().zip(&start.mean).map(|(x, m)| x - m);
            own.iter().zip(from).map(|(a, x)| a * x).sum()
        });
        let offsets = self.offsets.iter().map(|&k| at(&now.mean, k));
        for (to, value) in self.values.iter_mut().zip(changes.chain(offsets)) {
            *to = value;
        }
        let lines = self.covariance.chunks_exact_mut((2 * n).max(1));
        for (i, line) in lines.enumerate() {
            for (k, to) in line.iter_mut().enumerate() {
                // The one with the change, if there is one.
                let (low, high) = (i.min(k), i.max(k));
                let shared = self.shared.get(low * d..(low + 1) * d).unwrap_or_default();
                *to = if high < n {
                    let own = self.towards.get(high * d..(high + 1) * d);
                    let pairs = own.unwrap_or_default().iter().zip(shared);
                    at(&self.left, high * n + low) + pairs.map(|(a, g)| a * g).sum::<f64>()
                } else if low < n {
                    at(shared, self.offsets.get(high - n).copied().unwrap_or(d))
                } else {
                    let places = (self.offsets.get(low - n), self.offsets.get(high - n));
                    match places {
                        (Some(a), Some(b)) => at(&now.covariance, a * d + b),
                        _ => f64::NAN,
                    }
                };
            }
        }
        self.mixture.weigh(&self.values, &self.covariance, ODDS);
    }

    /// What is believed now, averaged as the offsets are. `now` is what [`Since::average`] had last. Allocates.
    pub(super) fn averaged(&self, now: &Belief) -> Result<Belief, MapError> {
        let (n, d) = (self.joints.len(), now.mean.len());
        let mut averaged = now.clone();
        let change = &self.values[..n];
        let rows = self.covariance.chunks_exact((2 * n).max(1)).take(n);
        let own: Vec<f64> = rows.flat_map(|row| row.iter().take(n).copied()).collect();
        let shared: Vec<f64> = (0..d)
            .flat_map(|k| (0..n).map(move |i| self.shared[i * d + k]))
            .collect();
        let (mean, covariance) = (&mut averaged.mean, &mut averaged.covariance);
        mixture::take_over((change, &own), &shared, &self.mixture, mean, covariance)?;
        Ok(averaged)
    }

    /// Offset of a joint and its standard deviation, rad; `None` for one whose stiffness was not known.
    pub(super) fn offset(&self, joint: usize) -> Option<[f64; 2]> {
        let n = self.joints.len();
        let i = n + self.joints.iter().position(|own| *own == joint)?;
        let (mean, variance) = (
            self.mixture.mean.get(i)?,
            self.mixture.spread.get(i * 2 * n + i)?,
        );
        Some([*mean, libm::sqrt(*variance)])
    }

    /// Probability that the stiffness of a joint has changed.
    pub(super) fn probability(&self, joint: usize) -> Option<f64> {
        let i = self.joints.iter().position(|own| *own == joint)?;
        self.mixture.probability.get(i).copied()
    }
}
