//! Sudden changes within a recording: a slip, a failed strand, a load picked up or put down.

use super::block::Block;
use super::map::{MapError, MapEstimate, MapEstimator};
use super::prior::{Belief, JointParameter, Payload, UNKNOWN_OFFSET_RAD};
use super::score::{Candidate, Weighing};
use super::solve::{Problem, Solution};
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
const STRAND: f64 = 0.05;
/// Least data before and after a change, s: a contact doesn't last as long.
pub(super) const EDGE_S: f64 = 5.0;
/// Two changes of the same thing within this time are one, s.
pub(super) const SAME_S: f64 = 2.0;
/// What a change must take off the cost to be kept, beyond one per unknown: about five standard
/// deviations, because every moment of every joint is a chance to be fooled.
const KEEP: f64 = 12.0;
/// A candidate that takes less than this off the cost at a glance is not fitted to the end: on
/// recordings without a change 6 of 127 take more, at most 4.4, and a change is kept from 13 on.
const WORTH_A_FIT: f64 = 3.0;
/// What a loss of stiffness with a slip must take off it: two and a half standard deviations.
const KEEP_SOFTER: f64 = 3.0;
/// An offset's change below this is not reported, rad.
const LEAST_STEP_RAD: f64 = 1e-3;
/// A loss of stiffness below this is not reported.
const LEAST_SOFTER: f64 = 0.01;
/// A stiffness' change above this is no failed strand but something that isn't modelled, such as a
/// load where none was stated: it is left unexplained.
pub(super) const MOST_SOFTER: f64 = 0.25;
/// A load's change below this is not reported, kg.
const LEAST_LOAD_KG: f64 = 0.01;
/// At most this many changes are kept in one stretch.
const MOST: usize = 8;

/// A candidate put into the estimate.
struct Found {
    /// What it takes off the cost.
    gain: f64,
    candidate: Candidate,
    solution: Solution,
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
        Problem::new(self, start, payload, blocks)?.watch(seek)
    }

    /// What is believed of a change within the recording: standard deviations of its entries.
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
}

impl Problem<'_> {
    fn watch(&self, seek: Seek) -> Result<MapEstimate, MapError> {
        let sought = seek.offsets && !seek.continues;
        let softer = if sought { self.softer_since()? } else { None };
        let mut best = match &softer {
            // What holds with every stiffness opened is nearly right without.
            Some(softer) => self.solve_without(softer)?,
            None => self.solve(&[])?,
        };
        if let Some(softer) = softer.as_ref().filter(|s| self.is_sure(&best, s)) {
            best = softer.clone();
        }
        for _ in 0..MOST {
            let mut better: Option<Found> = None;
            for candidate in self.candidates(&best.estimate, seek)? {
                if self.gain_at_a_glance(&best.estimate, &candidate)? < WORTH_A_FIT {
                    continue;
                }
                let trial = self.with_change(&best.estimate, candidate)?;
                if trial.gain > better.as_ref().map_or(0.0, |b| b.gain) {
                    better = Some(trial);
                }
            }
            let Some(found) = better else { break };
            let Some(better) = self.settled(&best.estimate, found)? else {
                break;
            };
            best = self.without_the_needless(better)?;
        }
        if best.estimate.changes.len() > 1 {
            best = self.retimed(best, seek)?;
        }
        match softer {
            Some(softer) => self.averaged(best, softer),
            None => self.complete(best),
        }
    }

    /// Every slip's moment once more, now that the other changes are known.
    fn retimed(&self, mut best: Solution, seek: Seek) -> Result<Solution, MapError> {
        for k in 0..best.estimate.changes.len() {
            let change = best.estimate.changes[k];
            if !matches!(change.what, What::Offset(_)) {
                continue;
            }
            let changes = best.estimate.changes.iter().copied();
            let others: Vec<Change> = changes.filter(|c| *c != change).collect();
            let without = self.solve(&others)?.estimate;
            let fit = self.fit(&without, Weighing::Cut)?;
            for candidate in self.score(&without, seek, &[change.what], fit, 1) {
                let mut changes = best.estimate.changes.clone();
                changes[k].at_s = candidate.change.at_s;
                for c in &mut changes {
                    if softens(c, &change) {
                        c.at_s = candidate.change.at_s;
                    }
                }
                let known = &best.estimate;
                let trial = self.solve_from(&changes, &known.state, known)?;
                if trial.estimate.cost < self.cost_at(&best.estimate, &trial.estimate) {
                    best = trial;
                }
            }
        }
        Ok(best)
    }

    /// Drops changes that a later one has made needless.
    fn without_the_needless(&self, mut best: Solution) -> Result<Solution, MapError> {
        let mut k = 0;
        while k < best.estimate.changes.len() {
            let change = best.estimate.changes[k];
            // A stiffness that was opened with a slip stays and goes with it; those opened since
            // before the recording hide behind each other one by one.
            if self.is_since_before(&change)
                || best.estimate.changes.iter().any(|c| softens(&change, c))
            {
                k += 1;
                continue;
            }
            let changes = best.estimate.changes.iter().copied();
            let kept: Vec<Change> = changes
                .filter(|c| *c != change && !softens(c, &change))
                .collect();
            if kept.is_empty() {
                break;
            }
            let trial = self.solve(&kept)?;
            let worth = self.cost_at(&trial.estimate, &best.estimate) - best.estimate.cost;
            if worth < KEEP + change.what.columns() as f64 {
                best = trial;
                k = 0;
            } else {
                k += 1;
            }
        }
        Ok(best)
    }

    /// What a change takes off the cost, roughly.
    fn gain_at_a_glance(&self, best: &MapEstimate, candidate: &Candidate) -> Result<f64, MapError> {
        let (changes, state) = candidate.with(best);
        let estimate = self.glance_from(&changes, &state, best)?.estimate;
        Ok(self.cost_at_a_glance(best, &estimate) - estimate.cost)
    }

    /// The estimate with one more change and what it takes off the cost.
    fn with_change(&self, best: &MapEstimate, candidate: Candidate) -> Result<Found, MapError> {
        let (changes, state) = candidate.with(best);
        let solution = self.solve_from(&changes, &state, best)?;
        let before = self.cost_at(best, &solution.estimate);
        Ok(Found {
            gain: before - solution.estimate.cost,
            candidate,
            solution,
        })
    }

    /// The best change with its moment and its stiffness settled, if it is sure.
    fn settled(&self, best: &MapEstimate, mut found: Found) -> Result<Option<Solution>, MapError> {
        let Candidate {
            change,
            size,
            along,
            ..
        } = found.candidate.clone();
        // The score finds the moment to a block or two; the cost decides.
        for shift in [-2.0, -1.0, 1.0, 2.0] {
            let at_s = change.at_s + shift * self.estimator.block_s();
            let candidate = Candidate {
                change: Change { at_s, ..change },
                gain: 0.0,
                rank: 0,
                size: size.clone(),
                along: along.clone(),
            };
            let other = self.with_change(best, candidate)?;
            if other.gain > found.gain {
                found = other;
            }
        }
        if found.gain < KEEP + change.what.columns() as f64 {
            return Ok(None);
        }
        let solution = found.solution;
        let known = &solution.estimate;
        let place = self.total(&known.changes[..known.changes.len() - 1]);
        let (size, deviation) = (known.state[place], solution.deviation(place));
        let least = match change.what {
            What::Payload => LEAST_LOAD_KG,
            What::Offset(_) => LEAST_STEP_RAD,
            What::Compliance(_) => LEAST_SOFTER,
        };
        let stiffness = matches!(change.what, What::Compliance(_));
        if size.abs() < least
            || size.abs() < 4.0 * deviation
            || (stiffness && size.abs() > MOST_SOFTER)
        {
            return Ok(None);
        }
        if let What::Offset(joint) = change.what {
            let softer = Candidate {
                change: Change {
                    what: What::Compliance(joint),
                    at_s: found.candidate.change.at_s,
                },
                gain: 0.0,
                rank: 0,
                size: alloc::vec![0.0],
                along: Vec::new(),
            };
            let softer = self.with_change(known, softer)?;
            let [.., size] = softer.solution.estimate.state[..] else {
                return Ok(Some(solution));
            };
            if softer.gain > KEEP_SOFTER && size.abs() < MOST_SOFTER {
                return Ok(Some(softer.solution));
            }
        }
        Ok(Some(solution))
    }
}

/// Whether `softer` is the loss of stiffness that was opened with `slip`.
fn softens(softer: &Change, slip: &Change) -> bool {
    softer.at_s == slip.at_s
        && matches!((softer.what, slip.what), (What::Compliance(a), What::Offset(b)) if a == b)
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
