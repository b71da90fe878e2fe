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
/// An offset's change below this is not reported, rad.
const LEAST_STEP_RAD: f64 = 1e-3;
/// At most this many changes are kept in one stretch.
const MOST: usize = 8;
/// After this many candidates that were none, nobody looks further.
const REFUSED: usize = 4;

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
    /// of none: its gradient against what the rest of the state can't take up, in a Huber-weighted
    /// fit, so that neither a contact counts by its size nor a true change is thrown away as a
    /// contact. The best candidate is put into the estimate and stays if the robust cost falls by
    /// enough; so on until nothing is left.
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
        let mut refused: Vec<Change> = Vec::new();
        while best.changes.len() < MOST && refused.len() < REFUSED {
            let Some(candidate) = self.candidate(start, &best, blocks, payload, seek, &refused)?
            else {
                break;
            };
            match self.with_change(start, &best, blocks, payload, &candidate)? {
                Some(better) => best = better,
                None => refused.push(candidate.change),
            }
        }
        Ok(best)
    }

    /// The estimate with one more change, if it is worth it.
    fn with_change(
        &self,
        start: &Belief,
        best: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        candidate: &Candidate,
    ) -> Result<Option<MapEstimate>, MapError> {
        let change = candidate.change;
        let trial = |shift_s: f64| {
            let at_s = change.at_s + shift_s;
            let mut changes = best.changes.clone();
            changes.push(Change { at_s, ..change });
            if let What::Offset(joint) = change.what {
                changes.push(Change {
                    what: What::Compliance(joint),
                    at_s,
                });
            }
            let mut state = best.state.clone();
            state.extend(&candidate.size);
            let columns: usize = changes.iter().map(|c| c.what.columns()).sum();
            state.resize(self.prior().dimension() + columns, 0.0);
            self.solve_from(start, &changes, payload, blocks, Some((&state, best)))
        };
        let mut better = trial(0.0)?;
        let unknowns = change.what.columns() as f64;
        let gain = |better: &MapEstimate| {
            let before = self.cost_at(start, best, better, payload, blocks)?;
            Ok::<_, MapError>(before - better.cost)
        };
        if gain(&better)? < 0.5 * KEEP {
            return Ok(None);
        }
        // The score finds the moment to a block or two; the cost decides.
        for shift_s in [-2.0, -1.0, 1.0, 2.0] {
            let other = trial(shift_s * self.block_s())?;
            if other.cost < better.cost {
                better = other;
            }
        }
        if gain(&better)? < KEEP + unknowns {
            return Ok(None);
        }
        let sure = match change.what {
            What::Payload => true,
            What::Offset(_) | What::Compliance(_) => {
                let k = better
                    .changes
                    .iter()
                    .rposition(|c| c.what == change.what)
                    .unwrap_or_default();
                let [size, deviation] = better.change(self.prior(), k);
                size.abs() > LEAST_STEP_RAD && size.abs() > 4.0 * deviation
            }
        };
        Ok(sure.then_some(better))
    }

    /// The most telling change nobody has tried.
    fn candidate(
        &self,
        start: &Belief,
        known: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
        seek: Seek,
        refused: &[Change],
    ) -> Result<Option<Candidate>, MapError> {
        let prior = self.prior();
        let mut kinds = Vec::new();
        if seek.offsets {
            kinds.extend(
                (0..prior.joints())
                    .filter(|&i| prior.is_elastic(i))
                    .map(What::Offset),
            );
        }
        if seek.payload && payload != Payload::Empty {
            kinds.push(What::Payload);
        }
        let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else {
            return Ok(None);
        };
        let from = if seek.continues { 0.0 } else { EDGE_S };
        let span = (first.time_s + from, last.time_s - EDGE_S);
        let taken = |what: What, at_s: f64| {
            known
                .changes
                .iter()
                .chain(refused)
                .any(|c| c.what == what && (c.at_s - at_s).abs() < SAME_S)
        };
        let total = known.state.len();
        let mut scores = self.huber(start, known, blocks, payload)?;
        let mut best: Option<Candidate> = None;
        let mut sums: Vec<Sum> = kinds.iter().map(|k| Sum::new(k.columns(), total)).collect();
        for block in blocks.iter().rev() {
            let weight = scores.weights.pop().unwrap_or_default();
            self.equations(known, block, &mut scores.equations);
            for (sum, what) in sums.iter_mut().zip(&kinds) {
                sum.add(self, &scores.equations, *what, &weight);
            }
            if !(span.0..span.1).contains(&block.time_s) {
                continue;
            }
            let at_s = block.time_s - 0.5 * self.block_s();
            for (sum, what) in sums.iter().zip(&kinds) {
                if taken(*what, at_s) {
                    continue;
                }
                let deviations = self.change_deviations(*what, payload);
                let (gain, size) = sum.gain(&scores.covariance, &scores.step, &deviations);
                let gain = gain - 2.0 * (what.columns() as f64 - 1.0);
                let worth = WORTH_TRYING + what.columns() as f64;
                if gain > worth && best.as_ref().is_none_or(|b| gain > b.gain) {
                    best = Some(Candidate {
                        change: Change { what: *what, at_s },
                        gain,
                        size,
                    });
                }
            }
        }
        Ok(best)
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

    /// The Huber-weighted fit around a known estimate.
    fn huber(
        &self,
        start: &Belief,
        known: &MapEstimate,
        blocks: &[Block],
        payload: Payload,
    ) -> Result<Huber, MapError> {
        const SCALE: f64 = 4.0;
        let total = known.state.len();
        let mut equations = Equations::default();
        let (mut information, mut gradient) =
            self.prior_equations(start, &known.changes, payload, &known.state)?;
        let mut weights = Vec::with_capacity(blocks.len());
        for (b, block) in blocks.iter().enumerate() {
            self.equations(known, block, &mut equations);
            let chi = self.chi(&equations, known);
            let huber = (SCALE / libm::sqrt(chi)).min(1.0);
            let weight: Vec<f64> = equations
                .list
                .iter()
                .map(|e| huber * self.information_of(e, known, b))
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
        Ok(Huber {
            weights,
            covariance,
            step,
            equations,
        })
    }
}

/// A Huber-weighted fit.
struct Huber {
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

/// What a joint's offset is made of at the end of a recording: its entry and every change to it.
pub(super) fn offset_columns(prior: &super::Prior, changes: &[Change], joint: usize) -> Vec<usize> {
    let mut columns = alloc::vec![prior.place(joint, JointParameter::Offset)];
    let mut column = prior.dimension();
    for change in changes {
        if change.what == What::Offset(joint) {
            columns.push(column);
        }
        column += change.what.columns();
    }
    columns
}
