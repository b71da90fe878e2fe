//! Sudden changes within a recording: a slip, a failed strand, a payload picked up or put down.

use super::candidates::candidates;
use super::changepoint_time::{at_best_time, retimed};
use super::cost::{ThinnedResiduals, cost_at};
use super::creep;
use super::force;
use super::gauss_newton::{refine, solve, solve_from, solve_without};
use super::lost_stiffness::{self, MOST_SOFTER};
use super::posterior::{SURE, posteriors};
use super::problem::Problem;
use super::schedule::{COARSE, ROUGH_START, SCREENING};
use super::solution::Solution;
use super::stuck_friction;
use crate::offset::change::{ChangeKind, ChangePoint, SearchScope, without};
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use crate::offset::executor::map_each;
use alloc::vec::Vec;
#[cfg(test)]
use {
    crate::offset::belief::Payload, crate::offset::block::Block,
    crate::offset::equations::estimation_model::EstimationModel,
    crate::offset::executor::Sequential,
};

/// What a change must take off the cost to be kept, beyond one per unknown: about five standard
/// deviations, because every time of every joint is a chance to be fooled.
const LEAST_GAIN: f64 = 12.0;
/// A candidate that takes less than this off the cost when it is screened is left: on recordings
/// without a change 6 of 127 take more, at most 4.4, and a change is kept from 13 on.
const LEAST_SCREENED: f64 = 3.0;
/// One whose coarse solution takes less is not fitted to the end, nor one that takes less than this
/// share of what the best takes: of 55 rounds the best fit was within a fifth of the best coarse
/// solution in all.
const LEAST_COARSE: f64 = 6.0;
const NEAR_THE_BEST: f64 = 0.7;
/// What a loss of stiffness with a slip must take off it: two and a half standard deviations.
const LEAST_SOFTER_GAIN: f64 = 3.0;
/// An offset's change below this is not reported, rad.
const LEAST_STEP_RAD: f64 = 1e-3;
/// A loss of stiffness below this is not reported.
const LEAST_SOFTER: f64 = 0.01;
/// A payload's change below this is not reported, kg.
const LEAST_PAYLOAD_KG: f64 = 0.01;
/// A change must be so many standard deviations from zero.
const LEAST_SIGNIFICANCE: f64 = 4.0;
/// At most this many changes are kept in one recording.
const MOST: usize = 8;

/// A change put into the estimate.
struct Trial {
    /// What it takes off the cost.
    gain: f64,
    change: ChangePoint,
    solution: Solution,
}

impl Trial {
    /// A slip that may have taken stiffness along is likelier than a strand that failed without one.
    fn likely(&self) -> f64 {
        match self.change.kind {
            ChangeKind::Compliance(_) => self.gain - LEAST_SOFTER_GAIN,
            _ => self.gain,
        }
    }
}

/// The search for changes in one recording.
pub(super) struct ChangePointSearch<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) scope: SearchScope,
}

impl ChangePointSearch<'_> {
    /// The estimate with the changes that were found.
    pub(super) fn run(&self) -> Result<MapEstimate, MapError> {
        let problem = self.problem;
        let sought = self.scope.offsets && !self.scope.continues;
        let softer = if sought {
            lost_stiffness::opened(problem)?
        } else {
            None
        };
        let mut best = match &softer {
            // What holds with every stiffness opened is nearly right without.
            Some(softer) => solve_without(problem, softer)?,
            None => solve(problem, &[])?,
        };
        let sure = |s: &&Solution| lost_stiffness::is_sure(problem, &best, s);
        if let Some(softer) = softer.as_ref().filter(sure) {
            best = softer.clone();
        }
        let alone = best.clone();
        if self.scope.offsets {
            best = force::opened(problem, best)?;
        }
        best = self.with_slips_and_creep(best)?;
        if force::is_none(problem, &best) {
            // What spoke for it was a change.
            best = self.with_slips_and_creep(alone)?;
        }
        let posteriors = posteriors(problem, &best, self.scope)?;
        let mut estimate = match softer {
            Some(softer) => lost_stiffness::averaged(problem, best, softer)?,
            None => problem.complete(best)?,
        };
        creep::average(problem, &mut estimate)?;
        force::average(problem, &mut estimate)?;
        Ok(MapEstimate {
            posteriors,
            ..estimate
        })
    }

    /// With the changes that are found beside those of `first`, and creep where there is any.
    fn with_slips_and_creep(&self, first: Solution) -> Result<Solution, MapError> {
        let best = self.with_changes(first.clone())?;
        match self.scope.offsets && self.scope.creep {
            true => creep::told_apart(self.problem, &first, best, |s| self.with_changes(s)),
            false => Ok(best),
        }
    }

    /// With the changes that are found beside those there are, and without those that makes needless.
    fn with_changes(&self, mut best: Solution) -> Result<Solution, MapError> {
        for _ in 0..MOST {
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

    /// An estimate with `change` more than in `best`, and what that takes off the cost.
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
            // A stiffness that was opened with a slip stays and goes with it; those opened since
            // before the recording hide behind each other one by one.
            if problem.is_before_recording(&change)
                || changes.iter().any(|c| change.accompanies(c))
                || best.significance(problem.total(&changes[..k])) > SURE
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
            if gain < LEAST_GAIN + change.kind.columns() as f64 {
                best = trial;
                k = 0;
            } else {
                k += 1;
            }
        }
        Ok(best)
    }

    /// The best change with its time and its stiffness settled, if it is sure.
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
        if found.gain < LEAST_GAIN + change.kind.columns() as f64 {
            return Ok(None);
        }
        let at_s = found.change.at_s;
        let solution = found.solution;
        if !self.is_significant(&solution) {
            return Ok(None);
        }
        match change.kind {
            // So little data can't tell what a step took along.
            ChangeKind::Offset(_) if self.is_onset(change) => Ok(Some(solution)),
            ChangeKind::Offset(joint) => {
                let softer = self.with_softer(&solution, joint, at_s, 0.0)?;
                Ok(Some(softer.unwrap_or(solution)))
            }
            // A rope that loses a strand gives way: strand and slip are separable as far as stretch
            // and load differ, and the offset holds what isn't.
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

    /// Whether a change is possible only because it is known from elsewhere.
    fn is_onset(&self, change: ChangePoint) -> bool {
        let scope = SearchScope {
            onset: None,
            ..self.scope
        };
        !self.problem.is_possible(change.kind, change.at_s, scope)
    }

    /// Whether the last change is large enough to be one.
    fn is_significant(&self, solution: &Solution) -> bool {
        let known = &solution.estimate;
        let Some((change, before)) = known.changes.split_last() else {
            return false;
        };
        let place = self.problem.total(before);
        let friction = stuck_friction::deviation_of(self.problem, solution, place);
        let size = known.state[place].abs();
        let deviation = libm::hypot(solution.deviation(place), friction);
        let (least, most) = match change.kind {
            ChangeKind::Payload => (LEAST_PAYLOAD_KG, f64::INFINITY),
            ChangeKind::Offset(_) => (LEAST_STEP_RAD, f64::INFINITY),
            ChangeKind::Compliance(_) => (LEAST_SOFTER, MOST_SOFTER),
            ChangeKind::Creep(_) | ChangeKind::Force => (0.0, f64::INFINITY),
        };
        size >= least && size >= LEAST_SIGNIFICANCE * deviation && size <= most
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
        let softer = ChangePoint {
            kind: ChangeKind::Compliance(joint),
            at_s,
        };
        let changes = [&known.changes[..], &[softer]].concat();
        let mut state = known.state.clone();
        state.push(size);
        let with = solve_from(self.problem, &changes, &state, known, ROUGH_START)?;
        let with = self.trial(known, softer, with);
        let found = with.solution.estimate.state.last();
        let possible = found.is_some_and(|size| size.abs() < MOST_SOFTER);
        Ok((with.gain > LEAST_SOFTER_GAIN && possible).then_some(with.solution))
    }

    /// A slip in the place of the loss of stiffness that came last, or both.
    fn with_slip(
        &self,
        softer: &Solution,
        joint: usize,
        at_s: f64,
    ) -> Result<Option<Solution>, MapError> {
        let known = &softer.estimate;
        let slip = ChangePoint {
            kind: ChangeKind::Offset(joint),
            at_s,
        };
        let (mut changes, mut state) = (known.changes.clone(), known.state.clone());
        if let (Some(change), Some(size)) = (changes.last_mut(), state.last_mut()) {
            (*change, *size) = (slip, 0.0);
        }
        let alone = solve_from(self.problem, &changes, &state, known, ROUGH_START)?;
        let size = known.state.last().copied().unwrap_or_default();
        if let Some(both) = self.with_softer(&alone, joint, at_s, size)? {
            return Ok(Some(both));
        }
        Ok(self.is_significant(&alone).then_some(alone))
    }
}

/// What a recording with an empty gripper comes to: offsets `0 ± deviation_rad` before, slips and creep sought.
#[cfg(test)]
pub(super) fn searched(
    model: &EstimationModel,
    deviation_rad: f64,
    blocks: &[Block],
) -> MapEstimate {
    let believed = model.prior.belief(Payload::Empty, deviation_rad);
    let problem = Problem::new(model, &Sequential, &believed, Payload::Empty, blocks).unwrap();
    let scope = SearchScope {
        offsets: true,
        payload: false,
        creep: true,
        continues: false,
        onset: None,
    };
    let search = ChangePointSearch {
        problem: &problem,
        scope,
    };
    search.run().unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::belief::{Payload, TENSIONED_OFFSET_RAD, UNKNOWN_OFFSET_RAD};
    use crate::offset::change::Onset;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{SLIPS_AT, slipping, turntable};

    #[test]
    fn a_coarse_solution_takes_off_what_the_costs_differ_by() {
        let model = turntable();
        let blocks = slipping(&model, 5e-3, 4);
        let believed = model.prior.belief(Payload::Empty, TENSIONED_OFFSET_RAD);
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
        assert!(gain > LEAST_GAIN, "{gain}");
    }

    /// Three seconds before the end a slip is looked for only where it is known from elsewhere, and at its joint.
    #[test]
    fn an_onset_lets_a_late_slip_be_found() {
        let model = turntable();
        let blocks = &slipping(&model, 5e-3, 4)[..SLIPS_AT + 15];
        let believed = model.prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem = Problem::new(&model, &Sequential, &believed, Payload::Empty, blocks).unwrap();
        let at_s = problem.start_of(SLIPS_AT);
        let found = |onset: Option<Onset>| {
            let scope = SearchScope {
                offsets: true,
                payload: false,
                creep: false,
                continues: false,
                onset,
            };
            let search = ChangePointSearch {
                problem: &problem,
                scope,
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
