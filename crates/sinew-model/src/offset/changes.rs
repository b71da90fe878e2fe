//! Sudden changes within a recording: a slip, a failed strand, a load picked up or put down.

use super::equation::{Equations, Side};
use super::features::Block;
use super::map::{MapError, MapEstimate, MapEstimator};
use super::prior::{Belief, JointParameter, Payload, UNKNOWN_OFFSET_RAD};
use crate::cholesky;
use alloc::vec::Vec;

/// What changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum What {
    /// Offset of a joint: a slip of rope or encoder, a re-tensioning.
    Offset(usize),
    /// Compliance of a joint: a failed strand, with the offset of that joint.
    Compliance(usize),
    /// What the gripper holds.
    Payload,
}

/// A change from one moment to the end of the recording; changes of the same thing add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// What changes.
    pub what: What,
    /// When, s.
    pub at_s: f64,
}

/// What may be looked for in a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seek {
    /// Slips and failed strands.
    pub offsets: bool,
    /// Loads picked up or put down.
    pub payload: bool,
    /// Whether the data goes on from where the belief ends: a change may come with its first
    /// block then.
    pub continues: bool,
}

/// Stiffness is opened by this at a suspected event, relative: what a failed strand takes along.
pub(super) const STRAND: f64 = 0.05;
/// Least data before and after a change, s: a contact doesn't last as long.
const EDGE_S: f64 = 5.0;
/// Two changes of the same thing within this time are one, s.
const SAME_S: f64 = 2.0;
/// A candidate is tried when half its chi-square exceeds this and one per unknown.
const WORTH_TRYING: f64 = 8.0;
/// What a change must take off the cost to be kept, beyond one per unknown: about five standard
/// deviations, because every moment of every joint is a chance to be fooled.
const KEEP: f64 = 12.0;
/// What a loss of stiffness with a slip must take off it: two and a half standard deviations.
const KEEP_SOFTER: f64 = 3.0;
/// Candidates of each weighing that are put into the estimate per round.
const TRIALS: usize = 5;
/// An offset's change below this is not reported, rad.
const LEAST_STEP_RAD: f64 = 1e-3;
/// A load's change below this is not reported, kg.
const LEAST_LOAD_KG: f64 = 0.01;
/// At most this many changes are kept in one stretch.
const MOST: usize = 8;

/// A candidate put into the estimate.
struct Found {
    /// What it takes off the cost.
    gain: f64,
    candidate: Candidate,
    estimate: MapEstimate,
}

#[derive(Debug, Clone)]
struct Candidate {
    change: Change,
    gain: f64,
    /// Its entries as the score has them.
    size: Vec<f64>,
}

impl MapEstimator {
    /// The estimate from `blocks`, sudden changes found on the way.
    ///
    /// The score of every possible change at every moment is computed from the estimate that knows
    /// of none: its gradient against what the rest of the state can't take up, in fits whose
    /// weights neither let a contact count by its size nor throw a true change away as a contact.
    /// The best moments of every kind are put into the estimate, and the one that takes most off
    /// the robust cost stays, if that is enough; changes it made needless go; so on until nothing
    /// is left.
    ///
    /// # Errors
    /// [`MapError`].
    pub fn watch(
        &self,
        start: &Belief,
        blocks: &[Block],
        payload: Payload,
        seek: Seek,
    ) -> Result<MapEstimate, MapError> {
        let mut best = self.solve(start, &[], payload, blocks)?;
        for _ in 0..MOST {
            let mut better: Option<Found> = None;
            let candidates = self.candidates(start, &best, blocks, payload, seek)?;
            for candidate in candidates {
                let trial = self.with_change(start, &best, blocks, payload, candidate)?;
                if trial.gain > better.as_ref().map_or(0.0, |b| b.gain) {
                    better = Some(trial);
                }
            }
            let Some(found) = better else { break };
            let Some(better) = self.settled(start, &best, blocks, payload, found)? else {
                break;
            };
            best = self.without_the_needless(start, better, blocks, payload)?;
        }
        if best.changes.len() > 1 {
            best = self.retimed(start, best, blocks, payload, seek)?;
        }
        Ok(best)
    }

    /// Every slip's moment once more, now that the other changes are known.
    fn retimed(
        &self,
        start: &Belief,
        mut best: MapEstimate,
        blocks: &[Block],
        payload: Payload,
        seek: Seek,
    ) -> Result<MapEstimate, MapError> {
        for k in 0..best.changes.len() {
            let change = best.changes[k];
            if !matches!(change.what, What::Offset(_)) {
                continue;
            }
            let others: Vec<Change> = best
                .changes
                .iter()
                .filter(|c| **c != change)
                .copied()
                .collect();
            let without = self.solve(start, &others, payload, blocks)?;
            let fit = self.fit(start, &without, blocks, payload, Weighing::Cut)?;
            let scored = self.score(&without, blocks, payload, seek, &[change.what], fit);
            for candidate in scored {
                let mut changes = best.changes.clone();
                changes[k].at_s = candidate.change.at_s;
                for c in &mut changes {
                    let softer = matches!((c.what, change.what), (What::Compliance(a), What::Offset(b)) if a == b);
                    if softer && c.at_s == change.at_s {
                        c.at_s = candidate.change.at_s;
                    }
                }
                let warm = best.state.clone();
                let warm = Some((warm.as_slice(), &best));
                let trial = self.solve_from(start, &changes, payload, blocks, warm)?;
                if trial.cost < self.cost_at(start, &best, &trial, payload, blocks)? {
                    best = trial;
                }
            }
        }
        Ok(best)
    }

    /// Drops changes that a later one has made needless.
    fn without_the_needless(
        &self,
        start: &Belief,
        mut best: MapEstimate,
        blocks: &[Block],
        payload: Payload,
    ) -> Result<MapEstimate, MapError> {
        let mut k = 0;
        while k < best.changes.len() {
            let change = best.changes[k];
            if matches!(change.what, What::Compliance(_)) {
                k += 1;
                continue;
            }
            let with_it = |c: &Change| {
                *c == change
                    || matches!((c.what, change.what), (What::Compliance(a), What::Offset(b)) if a == b)
                        && c.at_s == change.at_s
            };
            let kept: Vec<Change> = best
                .changes
                .iter()
                .filter(|c| !with_it(c))
                .copied()
                .collect();
            if kept.is_empty() {
                break;
            }
            let trial = self.solve(start, &kept, payload, blocks)?;
            let worth = self.cost_at(start, &trial, &best, payload, blocks)? - best.cost;
            if worth < KEEP + change.what.columns() as f64 {
                best = trial;
                k = 0;
            } else {
                k += 1;
            }
        }
        Ok(best)
    }

    /// The estimate with one more change and what it takes off the cost.
    fn with_change(
        &self,
        start: &Belief,
        best: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        candidate: Candidate,
    ) -> Result<Found, MapError> {
        let mut changes = best.changes.clone();
        changes.push(candidate.change);
        let mut state = best.state.clone();
        state.extend(&candidate.size);
        let warm = Some((state.as_slice(), best));
        let estimate = self.solve_from(start, &changes, payload, blocks, warm)?;
        let before = self.cost_at(start, best, &estimate, payload, blocks)?;
        Ok(Found {
            gain: before - estimate.cost,
            candidate,
            estimate,
        })
    }

    /// The best change with its moment and its stiffness settled, if it is sure.
    fn settled(
        &self,
        start: &Belief,
        best: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        mut found: Found,
    ) -> Result<Option<MapEstimate>, MapError> {
        let Candidate {
            change, ref size, ..
        } = found.candidate;
        let size = size.clone();
        // The score finds the moment to a block or two; the cost decides.
        for shift in [-2.0, -1.0, 1.0, 2.0] {
            let at_s = change.at_s + shift * self.block_s();
            let candidate = Candidate {
                change: Change { at_s, ..change },
                gain: 0.0,
                size: size.clone(),
            };
            let other = self.with_change(start, best, blocks, payload, candidate)?;
            if other.gain > found.gain {
                found = other;
            }
        }
        let Found {
            gain,
            mut estimate,
            candidate,
        } = found;
        if gain < KEEP + change.what.columns() as f64 {
            return Ok(None);
        }
        let [size, deviation] = estimate.change(self.prior(), estimate.changes.len() - 1);
        let least = match change.what {
            What::Payload => LEAST_LOAD_KG,
            What::Offset(_) | What::Compliance(_) => LEAST_STEP_RAD,
        };
        if size.abs() < least || size.abs() < 4.0 * deviation {
            return Ok(None);
        }
        if let What::Offset(joint) = change.what {
            let softer = Candidate {
                change: Change {
                    what: What::Compliance(joint),
                    at_s: candidate.change.at_s,
                },
                gain: 0.0,
                size: alloc::vec![0.0],
            };
            let softer = self.with_change(start, &estimate, blocks, payload, softer)?;
            if softer.gain > KEEP_SOFTER {
                estimate = softer.estimate;
            }
        }
        Ok(Some(estimate))
    }

    /// The most telling changes of every kind, by score.
    fn candidates(
        &self,
        start: &Belief,
        known: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        seek: Seek,
    ) -> Result<Vec<Candidate>, MapError> {
        let prior = self.prior();
        let mut offsets = Vec::new();
        if seek.offsets {
            offsets.extend(
                (0..prior.joints())
                    .filter(|&i| prior.is_elastic(i))
                    .map(What::Offset),
            );
        }
        let mut loads = offsets.clone();
        if seek.payload && payload != Payload::Empty {
            loads.push(What::Payload);
        }
        let mut out = Vec::new();
        for (kinds, weighing) in [(offsets, Weighing::Cut), (loads, Weighing::Huber)] {
            if !kinds.is_empty() {
                let fit = self.fit(start, known, blocks, payload, weighing)?;
                let mut scored = self.score(known, blocks, payload, seek, &kinds, fit);
                scored.sort_by(|a, b| b.gain.total_cmp(&a.gain));
                out.extend(scored.into_iter().take(TRIALS));
            }
        }
        Ok(out)
    }

    /// The best moments of every kind of change.
    fn score(
        &self,
        known: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        seek: Seek,
        kinds: &[What],
        mut fit: Fit,
    ) -> Vec<Candidate> {
        let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else {
            return Vec::new();
        };
        let from = if seek.continues { 0.0 } else { EDGE_S };
        let span = (first.time_s + from, last.time_s - EDGE_S);
        let taken = |what: What, at_s: f64| {
            let mut changes = known.changes.iter();
            changes.any(|c| c.what == what && (c.at_s - at_s).abs() < SAME_S)
        };
        let total = known.state.len();
        let deviations: Vec<Vec<f64>> = kinds
            .iter()
            .map(|k| self.change_deviations(*k, payload))
            .collect();
        let mut sums: Vec<Sum> = kinds.iter().map(|k| Sum::new(k.columns(), total)).collect();
        let mut best: Vec<Vec<Candidate>> = alloc::vec![Vec::new(); kinds.len()];
        for block in blocks.iter().rev() {
            let weight = fit.weights.pop().unwrap_or_default();
            self.equations(known, block, &mut fit.equations);
            for (sum, what) in sums.iter_mut().zip(kinds) {
                sum.add(self, &fit.equations, *what, &weight);
            }
            if !(span.0..span.1).contains(&block.time_s) {
                continue;
            }
            let at_s = block.time_s - 0.5 * self.block_s();
            for (k, what) in kinds.iter().enumerate() {
                let (gain, size) = sums[k].gain(&fit.covariance, &fit.step, &deviations[k]);
                let worth = WORTH_TRYING + what.columns() as f64;
                if gain > worth && !taken(*what, at_s) {
                    keep_best(
                        &mut best[k],
                        Candidate {
                            change: Change { what: *what, at_s },
                            gain,
                            size,
                        },
                    );
                }
            }
        }
        best.into_iter().flatten().collect()
    }

    /// What is believed of a change before: standard deviations of its entries.
    pub(super) fn change_deviations(&self, what: What, payload: Payload) -> Vec<f64> {
        match what {
            What::Offset(_) => alloc::vec![UNKNOWN_OFFSET_RAD],
            What::Compliance(_) => alloc::vec![STRAND],
            What::Payload => {
                let open = self.prior().payload_belief(Payload::Unknown);
                let stated = self.prior().payload_belief(payload);
                open.iter()
                    .zip(&stated)
                    .map(|((mean, deviation), (known, _))| {
                        libm::hypot(libm::hypot(*mean, *deviation), *known)
                    })
                    .collect()
            }
        }
    }

    /// A weighted fit around a known estimate.
    fn fit(
        &self,
        start: &Belief,
        known: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        weighing: Weighing,
    ) -> Result<Fit, MapError> {
        let total = known.state.len();
        let mut equations = Equations::default();
        let (mut information, mut gradient) =
            self.prior_equations(start, &known.changes, payload, &known.state)?;
        let mut weights = Vec::with_capacity(blocks.len());
        for (b, block) in blocks.iter().enumerate() {
            self.equations(known, block, &mut equations);
            let chi = self.chi(&equations, known);
            let whole = weighing.weight(chi);
            let weight: Vec<f64> = equations
                .list
                .iter()
                .map(|e| whole * self.information_of(e, known, b))
                .collect();
            for (e, weight) in equations.list.iter().zip(&weight) {
                let row = &equations.rows[e.from..e.to];
                for &(i, vi) in row {
                    gradient[i] += weight * vi * e.residual;
                    for &(k, vk) in row {
                        information[i * total + k] += weight * vi * vk;
                    }
                }
            }
            weights.push(weight);
        }
        let covariance = cholesky::inverse(&information, total).map_err(MapError::Prior)?;
        let step = (0..total)
            .map(|i| {
                covariance[i * total..(i + 1) * total]
                    .iter()
                    .zip(&gradient)
                    .map(|(c, g)| c * g)
                    .sum()
            })
            .collect();
        Ok(Fit {
            weights,
            covariance,
            step,
            equations,
        })
    }
}

/// How blocks that don't fit count while changes are looked for.
#[derive(Debug, Clone, Copy)]
enum Weighing {
    /// Up to any size, but by their square root: a load is as large as a contact, and only lasts.
    Huber,
    /// Less than a slip's size, not at all beyond: contacts don't count.
    Cut,
}

impl Weighing {
    fn weight(self, chi: f64) -> f64 {
        match self {
            Self::Huber => (4.0 / libm::sqrt(chi)).min(1.0),
            Self::Cut => {
                const SCALE: f64 = 25.0;
                let w = SCALE * SCALE / (SCALE * SCALE + chi);
                w * w
            }
        }
    }
}

/// Keeps the two best moments that are not the same one.
fn keep_best(best: &mut Vec<Candidate>, new: Candidate) {
    const APART_S: f64 = 5.0;
    const TWO: usize = 2;
    let near = |c: &Candidate| (c.change.at_s - new.change.at_s).abs() < APART_S;
    if let Some(k) = best.iter().position(near) {
        if best[k].gain >= new.gain {
            return;
        }
        best.retain(|c| !near(c));
    }
    best.push(new);
    best.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    best.truncate(TWO);
}

/// A weighted fit.
struct Fit {
    /// Information of every equation of every block.
    weights: Vec<Vec<f64>>,
    covariance: Vec<f64>,
    /// The step of the state the fit would take.
    step: Vec<f64>,
    equations: Equations,
}

/// What the blocks after a moment say of one kind of change.
struct Sum {
    columns: usize,
    total: usize,
    /// Gradient, `columns`.
    gradient: Vec<f64>,
    /// Own information, `columns × columns`.
    own: Vec<f64>,
    /// Information shared with the state, `columns × total`.
    shared: Vec<f64>,
}

impl Sum {
    fn new(columns: usize, total: usize) -> Self {
        Self {
            columns,
            total,
            gradient: alloc::vec![0.0; columns],
            own: alloc::vec![0.0; columns * columns],
            shared: alloc::vec![0.0; columns * total],
        }
    }

    fn add(
        &mut self,
        estimator: &MapEstimator,
        equations: &Equations,
        what: What,
        weights: &[f64],
    ) {
        let place = what.place(estimator.prior());
        for (e, weight) in equations.list.iter().zip(weights) {
            let concerned = match what {
                What::Offset(joint) | What::Compliance(joint) => {
                    e.side == Side::Link && e.joint == joint
                }
                What::Payload => true,
            };
            if !concerned {
                continue;
            }
            let row = &equations.rows[e.from..e.to];
            for &(i, own) in row {
                if !(place..place + self.columns).contains(&i) {
                    continue;
                }
                let c = i - place;
                self.gradient[c] += weight * own * e.residual;
                for &(k, value) in row {
                    self.shared[c * self.total + k] += weight * own * value;
                    if (place..place + self.columns).contains(&k) {
                        self.own[c * self.columns + k - place] += weight * own * value;
                    }
                }
            }
        }
    }

    /// Half the chi-square a change here would take off: `½ gᵀ A⁻¹ g` with gradient and
    /// information less what the state would take up.
    fn gain(&self, covariance: &[f64], step: &[f64], deviations: &[f64]) -> (f64, Vec<f64>) {
        let (m, total) = (self.columns, self.total);
        let mut a = self.own.clone();
        let mut g = self.gradient.clone();
        let mut through = alloc::vec![0.0; total];
        for c in 0..m {
            let row = &self.shared[c * total..(c + 1) * total];
            g[c] -= row.iter().zip(step).map(|(b, s)| b * s).sum::<f64>();
            for (i, t) in through.iter_mut().enumerate() {
                let line = &covariance[i * total..(i + 1) * total];
                *t = line.iter().zip(row).map(|(p, b)| p * b).sum();
            }
            for k in 0..m {
                let other = &self.shared[k * total..(k + 1) * total];
                a[k * m + c] -= other.iter().zip(&through).map(|(b, t)| b * t).sum::<f64>();
            }
            a[c * m + c] += 1.0 / (deviations[c] * deviations[c]);
        }
        let mut l = alloc::vec![0.0; m * m];
        if cholesky::factorise(&a, &mut l, m).is_err() {
            return (0.0, g);
        }
        let mut x = g.clone();
        cholesky::solve(&l, m, &mut x);
        let gain = 0.5 * g.iter().zip(&x).map(|(g, x)| g * x).sum::<f64>();
        (gain, x)
    }
}

/// What a joint's offset is made of at a time: its entry and every change to it before.
pub(super) fn offset_columns(
    prior: &super::Prior,
    changes: &[Change],
    joint: usize,
    time_s: f64,
) -> Vec<usize> {
    let mut columns = alloc::vec![prior.place(joint, JointParameter::Offset)];
    let mut column = prior.dimension();
    for change in changes {
        if change.what == What::Offset(joint) && change.at_s <= time_s {
            columns.push(column);
        }
        column += change.what.columns();
    }
    columns
}
