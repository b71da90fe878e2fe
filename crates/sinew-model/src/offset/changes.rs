//! Sudden changes within a recording: a slip, a failed strand, a load picked up or put down.

use super::block::Block;
use super::certainty::kept_without;
use super::course::{GLANCE, LOOK, WARM};
use super::hands;
use super::map::{MapError, MapEstimate, MapEstimator};
use super::prior::{Belief, JointParameter, Payload, UNKNOWN_OFFSET_RAD};
use super::solution::Solution;
use super::solve::Problem;
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
pub(super) const KEEP: f64 = 12.0;
/// A candidate that takes less than this off the cost at a glance is not looked at: on
/// recordings without a change 6 of 127 take more, at most 4.4, and a change is kept from 13 on.
const WORTH_A_LOOK: f64 = 3.0;
/// One that takes less at a look is not fitted to the end, nor one that takes less than this share of
/// what the best takes: of 55 rounds the best fit was within a fifth of the best look in all.
const WORTH_A_FIT: f64 = 6.0;
const NEAR_THE_BEST: f64 = 0.7;
/// A change so many standard deviations from nothing isn't needless.
pub(super) const SURE: f64 = 12.0;
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
pub(super) struct Found {
    /// What it takes off the cost.
    pub(super) gain: f64,
    change: Change,
    solution: Solution,
}

impl Found {
    /// A slip that may have taken stiffness along is likelier than a strand that failed without one.
    fn likely(&self) -> f64 {
        match self.change.what {
            What::Compliance(_) => self.gain - KEEP_SOFTER,
            _ => self.gain,
        }
    }
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
            let Some(found) = self.most_telling(&best.estimate, seek)? else {
                break;
            };
            let Some(better) = self.settled(&best.estimate, found, seek)? else {
                break;
            };
            best = self.without_the_needless(better)?;
        }
        best = self.retimed(best, seek)?;
        let certainties = self.certainties(&best, seek)?;
        let said = match softer {
            Some(softer) => self.averaged(best, softer),
            None => self.complete(best),
        };
        Ok(MapEstimate {
            certainties,
            ..said?
        })
    }

    /// The candidate that takes most off the cost.
    fn most_telling(&self, best: &MapEstimate, seek: Seek) -> Result<Option<Found>, MapError> {
        let hands = self.estimator.hands();
        let seen = self.seen(best);
        let candidates = self.candidates(best, seek)?;
        let looks = hands::each(hands, &candidates, |candidate| {
            let MapEstimate { changes, state, .. } = self.with(candidate, best);
            let glance = self.solve_from(&changes, &state, best, GLANCE)?;
            if seen.gain(&glance) <= WORTH_A_LOOK {
                return Ok(None);
            }
            let look = self.solve_from(&changes, &state, best, LOOK)?;
            Ok(Some((seen.gain(&look), candidate.change, look)))
        });
        let mut looked: Vec<(f64, Change, Solution)> = Vec::new();
        for look in looks {
            let Some(look) = look? else {
                continue;
            };
            // Both weighings may suspect the same; where one of them starts from leads further.
            match looked.iter_mut().find(|(_, change, _)| *change == look.1) {
                Some(same) if same.0 < look.0 => *same = look,
                Some(_) => {}
                None => looked.push(look),
            }
        }
        let most = looked.iter().map(|l| l.0).fold(0.0, f64::max);
        looked.retain(|(gain, ..)| *gain > WORTH_A_FIT.max(NEAR_THE_BEST * most));
        let fits = hands::each(hands, &looked, |(_, change, look)| {
            Ok(self.fitted(best, *change, self.solve_on(look)?))
        });
        let mut found: Option<Found> = None;
        for trial in fits {
            let trial = trial?;
            if trial.likely() > found.as_ref().map_or(0.0, Found::likely) {
                found = Some(trial);
            }
        }
        Ok(found)
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
                || self.significance(&best, k) > SURE
            {
                k += 1;
                continue;
            }
            let kept = kept_without(&best.estimate.changes, k);
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

    /// Size of a change over its standard deviation.
    pub(super) fn significance(&self, at: &Solution, k: usize) -> f64 {
        let place = self.total(&at.estimate.changes[..k]);
        at.estimate.state[place].abs() / at.deviation(place)
    }

    /// An estimate with `change` more than in `best`, and what that takes off the cost.
    pub(super) fn fitted(&self, best: &MapEstimate, change: Change, solution: Solution) -> Found {
        Found {
            gain: self.cost_at(best, &solution.estimate) - solution.estimate.cost,
            change,
            solution,
        }
    }

    /// The best change with its moment and its stiffness settled, if it is sure.
    fn settled(
        &self,
        best: &MapEstimate,
        mut found: Found,
        seek: Seek,
    ) -> Result<Option<Solution>, MapError> {
        let change = found.change;
        // The score finds the moment to a block or two; the cost decides.
        let near = 2.5 * self.estimator.block_s();
        let last = found.solution.estimate.changes.len() - 1;
        let is_near = |at_s: f64| (at_s - change.at_s).abs() < near;
        if let Some(other) = self.at_its_moment(&found.solution, last, is_near)? {
            let moved = other.estimate.changes[last];
            let other = self.fitted(best, moved, other);
            if other.gain > found.gain {
                found = other;
            }
        }
        if found.gain < KEEP + change.what.columns() as f64 {
            return Ok(None);
        }
        let at_s = found.change.at_s;
        let solution = found.solution;
        if !self.is_telling(&solution) {
            return Ok(None);
        }
        match change.what {
            What::Offset(joint) => {
                let softer = self.with_softer(&solution, joint, at_s, 0.0)?;
                Ok(Some(softer.unwrap_or(solution)))
            }
            // A rope that loses a strand gives way: strand and slip are told apart as far as stretch and
            // load differ, and the offset holds what isn't.
            What::Compliance(joint) if self.is_possible(What::Offset(joint), at_s, seek) => {
                self.with_slip(&solution, joint, at_s)
            }
            What::Compliance(_) | What::Payload => Ok(Some(solution)),
        }
    }

    /// Whether the last change is large enough to be one.
    fn is_telling(&self, solution: &Solution) -> bool {
        let known = &solution.estimate;
        let Some((change, before)) = known.changes.split_last() else {
            return false;
        };
        let place = self.total(before);
        let (size, deviation) = (known.state[place].abs(), solution.deviation(place));
        let (least, most) = match change.what {
            What::Payload => (LEAST_LOAD_KG, f64::INFINITY),
            What::Offset(_) => (LEAST_STEP_RAD, f64::INFINITY),
            What::Compliance(_) => (LEAST_SOFTER, MOST_SOFTER),
        };
        size >= least && size >= 4.0 * deviation && size <= most
    }

    /// A slip with a loss of stiffness, looked for from `size` on, if that explains enough more.
    fn with_softer(
        &self,
        slip: &Solution,
        joint: usize,
        at_s: f64,
        size: f64,
    ) -> Result<Option<Solution>, MapError> {
        let known = &slip.estimate;
        let softer = Change {
            what: What::Compliance(joint),
            at_s,
        };
        let changes = [&known.changes[..], &[softer]].concat();
        let mut state = known.state.clone();
        state.push(size);
        let with = self.solve_from(&changes, &state, known, WARM)?;
        let with = self.fitted(known, softer, with);
        let found = with.solution.estimate.state.last();
        let possible = found.is_some_and(|size| size.abs() < MOST_SOFTER);
        Ok((with.gain > KEEP_SOFTER && possible).then_some(with.solution))
    }

    /// A slip in the place of the loss of stiffness that came last, or both.
    fn with_slip(
        &self,
        softer: &Solution,
        joint: usize,
        at_s: f64,
    ) -> Result<Option<Solution>, MapError> {
        let known = &softer.estimate;
        let slip = Change {
            what: What::Offset(joint),
            at_s,
        };
        let (mut changes, mut state) = (known.changes.clone(), known.state.clone());
        if let (Some(change), Some(size)) = (changes.last_mut(), state.last_mut()) {
            (*change, *size) = (slip, 0.0);
        }
        let alone = self.solve_from(&changes, &state, known, WARM)?;
        let size = known.state.last().copied().unwrap_or_default();
        if let Some(both) = self.with_softer(&alone, joint, at_s, size)? {
            return Ok(Some(both));
        }
        Ok(self.is_telling(&alone).then_some(alone))
    }
}

/// Whether `softer` is the loss of stiffness that was opened with `slip`.
pub(super) fn softens(softer: &Change, slip: &Change) -> bool {
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
