//! Candidates for the times of changes: the best times of every kind, by score.

use super::cost::cost_over;
use super::problem::Problem;
use super::schedule::Sampling;
use super::score::{Fit, ScoreSum, Weighing};
use crate::offset::change::{ChangeKind, ChangePoint, SearchScope};
use crate::offset::equations::loaded::Content;
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use crate::offset::executor::map_each;
use crate::offset::state_estimate::Payload;
use alloc::vec::Vec;

/// Minimum time between two changes of the same quantity, s.
pub(super) const MIN_SEPARATION_S: f64 = 2.0;
/// A candidate is tried when half its chi-square exceeds this and one per unknown.
const MIN_GAIN: f64 = 8.0;
/// Candidates that are put into the estimate per round, of each weighing.
const TRIALS: [usize; 2] = [10, 3];
/// Step in blocks between the tested times; for the change that is kept, the neighbouring times are tested too.
const BLOCK_STEP: usize = 2;

/// A change that may have happened.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) change: ChangePoint,
    gain: f64,
    /// 0 for the best time of its kind.
    rank: usize,
    /// Entries of the change estimated by the score.
    size: Vec<f64>,
    /// How the rest of the state moves along.
    along: Vec<f64>,
    /// How it moves in the fit of the score without any change.
    step: Vec<f64>,
}

impl Candidate {
    /// `best` with this change more, the rest of the state moved along: with the step that the
    /// score's fit would take or without it, whichever costs less. That fit trusts blocks and joints
    /// otherwise than the estimate does: where a slip was taken for noise its step is right, where
    /// little is known it leads far away.
    pub(super) fn added_to(&self, best: &MapEstimate, problem: &Problem<'_>) -> MapEstimate {
        let mut with = best.clone();
        with.changes.push(self.change);
        for (x, along) in with.state.iter_mut().zip(&self.along) {
            *x += along;
        }
        with.state.extend(&self.size);
        let mut stepped = with.clone();
        for (x, step) in stepped.state.iter_mut().zip(&self.step) {
            *x += step;
        }
        let every = Sampling::Thinned.every(problem.blocks.len());
        if cost_over(problem, &stepped, best, every) < cost_over(problem, &with, best, every) {
            stepped
        } else {
            with
        }
    }
}

/// The changes of every kind that explain most, by score.
pub(super) fn candidates(
    problem: &Problem<'_>,
    estimate: &MapEstimate,
    scope: SearchScope,
) -> Result<Vec<Candidate>, MapError> {
    let prior = &problem.model.prior;
    let mut offsets = Vec::new();
    if scope.offsets {
        let elastic = (0..prior.joints()).filter(|&i| prior.is_elastic(i));
        offsets.extend(elastic.map(ChangeKind::Offset));
    }
    let mut loads = offsets.clone();
    // A strand may fail without a slip.
    let compliances = offsets.iter().filter_map(|kind| match kind {
        ChangeKind::Offset(joint) => Some(ChangeKind::Compliance(*joint)),
        _ => None,
    });
    let compliances: Vec<ChangeKind> = compliances.collect();
    offsets.extend(compliances);
    if scope.payload && problem.payload != Payload::Empty {
        loads.push(ChangeKind::Payload);
    }
    // A change that lasts for most of a recording is interpreted as noise by the median; the residual of good sensors
    // is a better initial value during the search.
    const QUIET_RAD: f64 = 0.5e-3;
    let mut quiet = estimate.clone();
    for noise in &mut quiet.noise_rad {
        *noise = noise.min(QUIET_RAD);
    }
    let estimate = &quiet;
    let weighings = [(offsets, Weighing::Redescending), (loads, Weighing::Huber)];
    let scored = map_each(problem.executor, &weighings, |(kinds, weighing)| {
        if kinds.is_empty() {
            return Ok(Vec::new());
        }
        let fit = Fit::of(problem, estimate, *weighing)?;
        Ok(best_by_score(problem, estimate, scope, kinds, fit))
    });
    let mut out = Vec::new();
    for (scored, trials) in scored.into_iter().zip(TRIALS) {
        // The best of every kind before the second best of any: a failed strand and a slip have similar scores, and
        // must not crowd each other out.
        let (mut first, mut second): (Vec<_>, Vec<_>) =
            scored?.into_iter().partition(|c| c.rank == 0);
        for some in [&mut first, &mut second] {
            some.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        }
        out.extend(first.into_iter().chain(second).take(trials));
    }
    Ok(out)
}

/// The best times of every kind of change.
fn best_by_score(
    problem: &Problem<'_>,
    estimate: &MapEstimate,
    scope: SearchScope,
    kinds: &[ChangeKind],
    mut fit: Fit,
) -> Vec<Candidate> {
    let taken = |kind: ChangeKind, at_s: f64| {
        let mut changes = estimate.changes.iter();
        changes.any(|c| c.kind == kind && (c.at_s - at_s).abs() < MIN_SEPARATION_S)
    };
    let total = estimate.state.len();
    let stds: Vec<Vec<f64>> = kinds.iter().map(|k| problem.stds_within(*k)).collect();
    let mut sums: Vec<ScoreSum> = kinds
        .iter()
        .map(|k| ScoreSum::new(k.columns(), total))
        .collect();
    let mut best: Vec<Vec<Candidate>> = alloc::vec![Vec::new(); kinds.len()];
    for b in (0..problem.blocks.len()).rev() {
        let weight = fit.weights.pop().unwrap_or_default();
        problem.equations(estimate, b, Content::Rows, &mut fit.equations);
        for (sum, kind) in sums.iter_mut().zip(kinds) {
            sum.add(&fit.equations, *kind, &weight);
        }
        if b % BLOCK_STEP != 0 {
            continue;
        }
        let at_s = problem.start_of(b);
        for (k, kind) in kinds.iter().enumerate() {
            if !problem.is_possible(*kind, at_s, scope) || taken(*kind, at_s) {
                continue;
            }
            let least = MIN_GAIN + kind.columns() as f64;
            let least = least.max(to_beat(&best[k], at_s));
            let Some((gain, size)) = sums[k].gain(&fit, &stds[k], least) else {
                continue;
            };
            if gain > least {
                keep_best(
                    &mut best[k],
                    Candidate {
                        change: ChangePoint { kind: *kind, at_s },
                        gain,
                        rank: 0,
                        along: sums[k].taken_up(&size),
                        step: fit.step.clone(),
                        size,
                    },
                );
            }
        }
    }
    for kind in &mut best {
        for (rank, candidate) in kind.iter_mut().enumerate() {
            candidate.rank = rank;
            fit.factor.backward(&mut candidate.along);
        }
    }
    best.into_iter().flatten().collect()
}

/// Times closer than this are the same one, s.
const DISTINCT_S: f64 = 5.0;
/// Number of candidates kept per kind.
const CANDIDATES_PER_KIND: usize = 2;

/// Returns the score that a candidate at a time must exceed to be kept among the best.
fn to_beat(best: &[Candidate], at_s: f64) -> f64 {
    let near = best
        .iter()
        .find(|c| (c.change.at_s - at_s).abs() < DISTINCT_S);
    let worst = best.get(CANDIDATES_PER_KIND - 1);
    near.or(worst).map_or(0.0, |c| c.gain)
}

/// Keeps the two best times that are not the same one.
fn keep_best(best: &mut Vec<Candidate>, new: Candidate) {
    let near = |c: &Candidate| (c.change.at_s - new.change.at_s).abs() < DISTINCT_S;
    if let Some(k) = best.iter().position(near) {
        if best[k].gain >= new.gain {
            return;
        }
        best.retain(|c| !near(c));
    }
    best.push(new);
    best.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    best.truncate(CANDIDATES_PER_KIND);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::gauss_newton::solve;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{BLOCKS, SCOPE, SLIPS_AT, slipping, turntable};
    use crate::offset::state_estimate::UNKNOWN_OFFSET_RAD;

    /// Returns candidate times of slips, s: of a joint that slips at the start of block `b`, with accepted slips at
    /// the specified times.
    fn suspected(model: &EstimationModel, b: usize, specified_s: &[f64]) -> Vec<f64> {
        let mut blocks = slipping(model, 0.0, 4);
        for block in &mut blocks[b..] {
            let y = block.y[0] + 5e-3;
            (block.y[0], block.y_square[0], block.y_cube[0]) = (y, y * y, y * y * y);
        }
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem = Problem::new(model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let slip = |at_s: &f64| ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s: *at_s,
        };
        let changes: Vec<ChangePoint> = specified_s.iter().map(slip).collect();
        let estimate = solve(&problem, &changes).unwrap().estimate;
        let found = candidates(&problem, &estimate, SCOPE).unwrap();
        let slips = found
            .iter()
            .filter(|c| c.change.kind == ChangeKind::Offset(0));
        slips.map(|c| c.change.at_s).collect()
    }

    #[test]
    fn slip_candidate_not_next_to_accepted_slip() {
        let model = turntable();
        let at_s = 0.2 * SLIPS_AT as f64;
        let near = |t: &f64| (t - at_s).abs() < MIN_SEPARATION_S;
        assert!(suspected(&model, SLIPS_AT, &[]).iter().any(near));
        // The specified time is 1.5 s early; the refinement step corrects it.
        let specified_s = at_s - 1.5;
        for t in suspected(&model, SLIPS_AT, &[specified_s]) {
            assert!((t - specified_s).abs() >= MIN_SEPARATION_S, "{t}");
        }
    }

    #[test]
    fn change_near_end_is_no_candidate() {
        let model = turntable();
        let end_s = 0.2 * BLOCKS as f64;
        // Data of five seconds before and after a slip is sufficient.
        for before_end in [5, 10, 15] {
            let found = suspected(&model, BLOCKS - before_end, &[]);
            let inside = |t: &f64| (5.0 - 1e-9..end_s - 5.0).contains(t);
            assert!(found.iter().all(inside), "{before_end}: {found:?}");
        }
    }
}
