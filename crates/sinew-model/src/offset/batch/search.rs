//! Sudden changes within a recording: a slip, a failed strand, a payload picked up or put down.

use super::candidates::candidates;
use super::changepoint_time::{at_best_time, retimed};
use super::cost::{ThinnedResiduals, cost_at};
use super::creep;
use super::force;
use super::gauss_newton::{completed, refine, solve, solve_from, solve_without};
use super::initial_friction;
use super::lost_stiffness::{self, MAX_STIFFNESS_LOSS};
use super::model_error::{self, ModelError};
use super::posterior::{CERTAIN_SIGMA, posteriors};
use super::problem::Problem;
use super::schedule::{COARSE, ROUGH_START, SCREENING};
use super::solution::Solution;
use crate::offset::change::{ChangeKind, ChangePoint, SearchScope, without};
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use crate::offset::executor::map_each;
use alloc::vec::Vec;
#[cfg(test)]
use {
    crate::offset::block::Block, crate::offset::equations::estimation_model::EstimationModel,
    crate::offset::executor::Sequential, crate::offset::fixtures::SCOPE,
    crate::offset::state_estimate::Payload,
};

/// Minimum decrease of the cost for a change to be kept, in addition to one per unknown: about five standard
/// deviations, because every time and every joint is a separate chance of a false detection.
const MIN_GAIN: f64 = 12.0;
/// Minimum decrease of the cost in the screening of a candidate. On recordings without a change, 6 of 127 candidates
/// exceed it, and none exceeds 4.4; a change is accepted from 13.
const LEAST_SCREENED: f64 = 3.0;
/// Minimum decrease of the cost in the coarse solution of a candidate that is iterated to convergence, and minimum
/// share of the largest decrease. In all of 55 rounds the best candidate was within a fifth of the best coarse
/// solution.
const LEAST_COARSE: f64 = 6.0;
const NEAR_THE_BEST: f64 = 0.7;
/// Minimum decrease of the cost by a stiffness loss together with a slip: two and a half standard deviations.
const MIN_STIFFNESS_GAIN: f64 = 3.0;
/// An offset's change below this is not reported, rad.
const LEAST_STEP_RAD: f64 = 1e-3;
/// A loss of stiffness below this is not reported.
const MIN_STIFFNESS_LOSS: f64 = 0.01;
/// A payload's change below this is not reported, kg.
const LEAST_PAYLOAD_KG: f64 = 0.01;
/// Minimum size of a change, in standard deviations.
const MIN_SIGNIFICANCE: f64 = 4.0;
/// Maximum number of changes in one recording.
const MAX_CHANGES: usize = 8;

/// A change put into the estimate.
struct Trial {
    /// Decrease of the cost by the change.
    gain: f64,
    change: ChangePoint,
    solution: Solution,
}

impl Trial {
    /// Prior preference: a slip, possibly with stiffness loss, is more probable than a strand failure without
    /// slip.
    fn likely(&self) -> f64 {
        match self.change.kind {
            ChangeKind::Compliance(_) => self.gain - MIN_STIFFNESS_GAIN,
            _ => self.gain,
        }
    }
}

/// The search for changes in one recording.
pub(super) struct ChangePointSearch<'a> {
    pub(super) problem: &'a Problem<'a>,
    /// Problem of the estimate with the changes that were found: that of the search, or with rounds that share their information.
    pub(super) last: &'a Problem<'a>,
    pub(super) scope: SearchScope,
    /// Model error of the baseline, with which the evidence about causes is compared.
    pub(super) model_error: Option<&'a ModelError>,
}

impl ChangePointSearch<'_> {
    /// The estimate with the changes that were found.
    pub(super) fn run(&self) -> Result<MapEstimate, MapError> {
        let problem = self.problem;
        let sought = self.scope.offsets && !self.scope.continues;
        let with_stiffness = if sought {
            lost_stiffness::with_free_stiffness(problem)?
        } else {
            None
        };
        let mut best = match &with_stiffness {
            // The solution with free stiffness is a good starting point for the one without.
            Some(with_stiffness) => solve_without(problem, with_stiffness)?,
            None => solve(problem, &[])?,
        };
        let is_significant = |s: &&Solution| lost_stiffness::is_significant(problem, &best, s);
        if let Some(with_stiffness) = with_stiffness.as_ref().filter(is_significant) {
            best = with_stiffness.clone();
        }
        let alone = best.clone();
        if self.scope.offsets {
            best = force::with_free_force(problem, best)?;
        }
        best = self.with_slips_and_creep(best)?;
        if force::is_none(problem, &best) {
            // What spoke for it was a change.
            best = self.with_slips_and_creep(alone)?;
        }
        let posteriors = posteriors(problem, &best, self.scope)?;
        let stored = self.model_error.filter(|_| !self.scope.continues);
        let (mut estimate, evidence) = match with_stiffness {
            Some(with_stiffness) => {
                let both = (problem, self.last);
                let (estimate, evidence) =
                    lost_stiffness::averaged(both, best, with_stiffness, stored)?;
                (estimate, Some(evidence))
            }
            None if force::is_open(&best) => {
                let evidence = model_error::posteriors(problem, &best.estimate, stored)?;
                (completed(problem, self.last, best)?, Some(evidence))
            }
            None => (completed(problem, self.last, best)?, None),
        };
        creep::average(problem, &mut estimate)?;
        force::average(problem, &mut estimate, evidence.as_deref())?;
        Ok(MapEstimate {
            posteriors,
            ..estimate
        })
    }

    /// Adds the changes that are found in addition to those of `first`, and creep if there is any.
    fn with_slips_and_creep(&self, first: Solution) -> Result<Solution, MapError> {
        let best = self.with_changes(first.clone())?;
        match self.scope.offsets && self.scope.creep {
            true => creep::separate_creep_and_slips(self.problem, &first, best, |s| {
                self.with_changes(s)
            }),
            false => Ok(best),
        }
    }

    /// Adds the changes that are found in addition to the present ones, and removes those that become
    /// unnecessary.
    fn with_changes(&self, mut best: Solution) -> Result<Solution, MapError> {
        for _ in 0..MAX_CHANGES {
            let Some(found) = self.most_likely(&best.estimate)? else {
                break;
            };
            let Some(better) = self.settled(&best.estimate, found)? else {
                break;
            };
            best = self.without_needless(better)?;
        }
        retimed(self.problem, best, self.scope)
    }

    /// The candidate that takes most off the cost.
    fn most_likely(&self, best: &MapEstimate) -> Result<Option<Trial>, MapError> {
        let problem = self.problem;
        let thinned = ThinnedResiduals::of(problem, best);
        let candidates = candidates(problem, best, self.scope)?;
        let screened = map_each(problem.executor, &candidates, |candidate| {
            let MapEstimate { changes, state, .. } = candidate.added_to(best, problem);
            let screening = solve_from(problem, &changes, &state, best, SCREENING)?;
            if thinned.gain(&screening) <= LEAST_SCREENED {
                return Ok(None);
            }
            let coarse = solve_from(problem, &changes, &state, best, COARSE)?;
            Ok(Some((thinned.gain(&coarse), candidate.change, coarse)))
        });
        let mut kept: Vec<(f64, ChangePoint, Solution)> = Vec::new();
        for coarse in screened {
            let Some(coarse) = coarse? else {
                continue;
            };
            // Both weighings may suspect the same; where one of them starts from leads further.
            match kept.iter_mut().find(|(_, change, _)| *change == coarse.1) {
                Some(same) if same.0 < coarse.0 => *same = coarse,
                Some(_) => {}
                None => kept.push(coarse),
            }
        }
        let most = kept.iter().map(|l| l.0).fold(0.0, f64::max);
        kept.retain(|(gain, ..)| *gain > LEAST_COARSE.max(NEAR_THE_BEST * most));
        let fits = map_each(problem.executor, &kept, |(_, change, coarse)| {
            Ok(self.trial(best, *change, refine(problem, coarse)?))
        });
        let mut found: Option<Trial> = None;
        for trial in fits {
            let trial = trial?;
            if trial.likely() > found.as_ref().map_or(0.0, Trial::likely) {
                found = Some(trial);
            }
        }
        Ok(found)
    }

    /// Returns an estimate with `change` in addition to those of `best`, and the resulting decrease of the cost.
    fn trial(&self, best: &MapEstimate, change: ChangePoint, solution: Solution) -> Trial {
        Trial {
            gain: cost_at(self.problem, best, &solution.estimate) - solution.cost(),
            change,
            solution,
        }
    }

    /// Drops changes that a later one has made needless.
    fn without_needless(&self, mut best: Solution) -> Result<Solution, MapError> {
        let problem = self.problem;
        let mut k = 0;
        while k < best.estimate.changes.len() {
            let changes = &best.estimate.changes;
            let change = changes[k];
            // A stiffness change that accompanies a slip is kept or removed with it; stiffness changes since
            // before the recording mask each other.
            if problem.is_before_recording(&change)
                || changes.iter().any(|c| change.accompanies(c))
                || best.significance(problem.total(&changes[..k])) > CERTAIN_SIGMA
            {
                k += 1;
                continue;
            }
            let kept = without(changes, k);
            if kept.is_empty() {
                break;
            }
            let trial = solve(problem, &kept)?;
            let gain = cost_at(problem, &trial.estimate, &best.estimate) - best.cost();
            if gain < MIN_GAIN + change.kind.columns() as f64 {
                best = trial;
                k = 0;
            } else {
                k += 1;
            }
        }
        Ok(best)
    }

    /// Returns the best change with refined time and stiffness, if it is significant.
    fn settled(&self, best: &MapEstimate, mut found: Trial) -> Result<Option<Solution>, MapError> {
        let change = found.change;
        // The score finds the time to a block or two; the cost decides.
        let near = 2.5 * self.problem.model.block_s;
        let last = found.solution.estimate.changes.len() - 1;
        let is_near = |at_s: f64| (at_s - change.at_s).abs() < near;
        if let Some(other) = at_best_time(self.problem, &found.solution, last, is_near)? {
            let moved = other.estimate.changes[last];
            let other = self.trial(best, moved, other);
            if other.gain > found.gain {
                found = other;
            }
        }
        if found.gain < MIN_GAIN + change.kind.columns() as f64 {
            return Ok(None);
        }
        let at_s = found.change.at_s;
        let solution = found.solution;
        if !self.is_significant(&solution) {
            return Ok(None);
        }
        match change.kind {
            // With so little data the stiffness loss of a step is not identifiable.
            ChangeKind::Offset(_) if self.is_onset(change) => Ok(Some(solution)),
            ChangeKind::Offset(joint) => {
                let with_stiffness = self.with_stiffness_loss(&solution, joint, at_s, 0.0)?;
                Ok(Some(with_stiffness.unwrap_or(solution)))
            }
            // A rope that loses a strand elongates: strand failure and slip are separable as far as offset and
            // load differ, and the offset contains the remainder.
            ChangeKind::Compliance(joint)
                if self
                    .problem
                    .is_possible(ChangeKind::Offset(joint), at_s, self.scope) =>
            {
                self.with_slip(&solution, joint, at_s)
            }
            ChangeKind::Compliance(_)
            | ChangeKind::Payload
            | ChangeKind::Creep(_)
            | ChangeKind::Force => Ok(Some(solution)),
        }
    }

    /// Whether a change is possible only because of an independent indication.
    fn is_onset(&self, change: ChangePoint) -> bool {
        let scope = SearchScope {
            onset: None,
            ..self.scope
        };
        !self.problem.is_possible(change.kind, change.at_s, scope)
    }

    /// Whether the latest change is significant.
    fn is_significant(&self, solution: &Solution) -> bool {
        let estimate = &solution.estimate;
        let Some((change, before)) = estimate.changes.split_last() else {
            return false;
        };
        let place = self.problem.total(before);
        let friction = initial_friction::deviation_of(self.problem, solution, place);
        let size = estimate.state[place].abs();
        let std = libm::hypot(solution.std(place), friction);
        let (least, most) = match change.kind {
            ChangeKind::Payload => (LEAST_PAYLOAD_KG, f64::INFINITY),
            ChangeKind::Offset(_) => (LEAST_STEP_RAD, f64::INFINITY),
            ChangeKind::Compliance(_) => (MIN_STIFFNESS_LOSS, MAX_STIFFNESS_LOSS),
            ChangeKind::Creep(_) | ChangeKind::Force => (0.0, f64::INFINITY),
        };
        size >= least && size >= MIN_SIGNIFICANCE * std && size <= most
    }

    /// Returns a slip with a stiffness loss, searched from `size` on, if it explains the data significantly
    /// better.
    fn with_stiffness_loss(
        &self,
        slip: &Solution,
        joint: usize,
        at_s: f64,
        size: f64,
    ) -> Result<Option<Solution>, MapError> {
        let estimate = &slip.estimate;
        let with_stiffness = ChangePoint {
            kind: ChangeKind::Compliance(joint),
            at_s,
        };
        let changes = [&estimate.changes[..], &[with_stiffness]].concat();
        let mut state = estimate.state.clone();
        state.push(size);
        let with = solve_from(self.problem, &changes, &state, estimate, ROUGH_START)?;
        let with = self.trial(estimate, with_stiffness, with);
        let found = with.solution.estimate.state.last();
        let possible = found.is_some_and(|size| size.abs() < MAX_STIFFNESS_LOSS);
        Ok((with.gain > MIN_STIFFNESS_GAIN && possible).then_some(with.solution))
    }

    /// Replaces the last stiffness loss by a slip, or combines both.
    fn with_slip(
        &self,
        with_stiffness: &Solution,
        joint: usize,
        at_s: f64,
    ) -> Result<Option<Solution>, MapError> {
        let estimate = &with_stiffness.estimate;
        let slip = ChangePoint {
            kind: ChangeKind::Offset(joint),
            at_s,
        };
        let (mut changes, mut state) = (estimate.changes.clone(), estimate.state.clone());
        if let (Some(change), Some(size)) = (changes.last_mut(), state.last_mut()) {
            (*change, *size) = (slip, 0.0);
        }
        let alone = solve_from(self.problem, &changes, &state, estimate, ROUGH_START)?;
        let size = estimate.state.last().copied().unwrap_or_default();
        if let Some(both) = self.with_stiffness_loss(&alone, joint, at_s, size)? {
            return Ok(Some(both));
        }
        Ok(self.is_significant(&alone).then_some(alone))
    }
}

/// Returns the estimate of a recording with an empty gripper: prior offsets `0 ± std_rad`, with a search for
/// slips and creep.
#[cfg(test)]
pub(super) fn searched(model: &EstimationModel, std_rad: f64, blocks: &[Block]) -> MapEstimate {
    let believed = model.prior.state_estimate(Payload::Empty, std_rad);
    let problem = Problem::new(model, &Sequential, &believed, Payload::Empty, blocks).unwrap();
    let search = ChangePointSearch {
        problem: &problem,
        last: &problem,
        scope: SCOPE,
        model_error: None,
    };
    search.run().unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::change::Onset;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{SLIPS_AT, slipping, turntable};
    use crate::offset::state_estimate::{Payload, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};

    #[test]
    fn coarse_gain_equals_cost_difference() {
        let model = turntable();
        let blocks = slipping(&model, 5e-3, 4);
        let believed = model
            .prior
            .state_estimate(Payload::Empty, TENSIONED_OFFSET_RAD);
        let problem =
            Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let best = solve(&problem, &[]).unwrap().estimate;
        let slip = ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s: problem.start_of(SLIPS_AT),
        };
        let mut state = best.state.clone();
        state.push(4e-3);
        let coarse = solve_from(&problem, &[slip], &state, &best, COARSE).unwrap();
        let gain = ThinnedResiduals::of(&problem, &best).gain(&coarse);
        let found = cost_at(&problem, &best, &coarse.estimate) - coarse.cost();
        assert!((gain - found).abs() < 1e-9 * gain.abs(), "{gain}");
        assert!(gain > MIN_GAIN, "{gain}");
    }

    /// A slip three seconds before the end is searched for only if an independent indication names its joint.
    #[test]
    fn late_slip_with_onset_is_found() {
        let model = turntable();
        let blocks = &slipping(&model, 5e-3, 4)[..SLIPS_AT + 15];
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem = Problem::new(&model, &Sequential, &believed, Payload::Empty, blocks).unwrap();
        let at_s = problem.start_of(SLIPS_AT);
        let found = |onset: Option<Onset>| {
            let scope = SearchScope {
                creep: false,
                onset,
                ..SCOPE
            };
            let search = ChangePointSearch {
                problem: &problem,
                last: &problem,
                scope,
                model_error: None,
            };
            search.run().unwrap().changes
        };
        let slip = ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s,
        };
        // The check dates it to a few blocks.
        for (joint, off_s) in [(0, 0.0), (0, 0.4), (0, -0.4)] {
            let at_s = at_s + off_s;
            assert_eq!(found(Some(Onset { joint, at_s })), [slip], "{off_s}");
        }
        assert!(found(None).is_empty());
        assert!(found(Some(Onset { joint: 1, at_s })).is_empty());
        assert!(
            found(Some(Onset {
                joint: 0,
                at_s: at_s - 4.0
            }))
            .is_empty()
        );
    }
}
