//! Time of a change.

use super::candidates::MIN_SEPARATION_S;
use super::cost::{cost_at, cost_by_block};
use super::gauss_newton::solve_from;
use super::problem::Problem;
use super::schedule::WARM_START;
use super::solution::Solution;
use crate::offset::change::{ChangeKind, SearchScope, moved};
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use alloc::vec::Vec;

/// Refines the time of every slip again, given the other changes.
pub(super) fn retimed(
    problem: &Problem<'_>,
    mut best: Solution,
    scope: SearchScope,
) -> Result<Solution, MapError> {
    for k in 0..best.estimate.changes.len() {
        let changes = &best.estimate.changes;
        let change = changes[k];
        if !matches!(change.kind, ChangeKind::Offset(_)) {
            continue;
        }
        let others = changes
            .iter()
            .filter(|c| c.kind == change.kind && **c != change);
        let others: Vec<f64> = others.map(|c| c.at_s).collect();
        let free = |at_s: f64| {
            others
                .iter()
                .all(|other| (other - at_s).abs() >= MIN_SEPARATION_S)
        };
        let possible = |at_s: f64| free(at_s) && problem.is_possible(change.kind, at_s, scope);
        if let Some(trial) = at_best_time(problem, &best, k, possible)?
            && trial.cost() < cost_at(problem, &best.estimate, &trial.estimate)
        {
            best = trial;
        }
    }
    Ok(best)
}

/// Returns the estimate with change `k`, and the stiffness change that accompanies it, at the time
/// of lowest cost;
/// `None` where that is where it is. The state is nearly equal for two times that differ by one block, so the cost of
/// the block before and after the change determines the better time.
pub(super) fn at_best_time(
    problem: &Problem<'_>,
    at: &Solution,
    k: usize,
    possible: impl Fn(f64) -> bool,
) -> Result<Option<Solution>, MapError> {
    let estimate = &at.estimate;
    let change = estimate.changes[k];
    let (mut is, mut least) = (None, None);
    for (b, sum) in costs_by_time(problem, estimate, k).into_iter().enumerate() {
        let at_s = problem.start_of(b);
        if is.is_none() && problem.blocks[b].time_s >= change.at_s {
            is = Some(sum);
        }
        if possible(at_s) && least.is_none_or(|(least, _)| sum < least) {
            least = Some((sum, at_s));
        }
    }
    match (is, least) {
        (Some(is), Some((least, at_s))) if least < is => {
            let changes = moved(&estimate.changes, k, at_s);
            solve_from(problem, &changes, &estimate.state, estimate, WARM_START).map(Some)
        }
        _ => Ok(None),
    }
}

/// Returns the cost of all blocks if change `k`, with the stiffness change that accompanies it,
/// occurred at each of them: earlier blocks without the change, later blocks with it; relative to
/// the cost if it occurred at the first block.
pub(super) fn costs_by_time(problem: &Problem<'_>, estimate: &MapEstimate, k: usize) -> Vec<f64> {
    let cost = |at_s: f64| {
        let there = MapEstimate {
            changes: moved(&estimate.changes, k, at_s),
            ..estimate.clone()
        };
        cost_by_block(problem, &there)
    };
    let (not_yet, since) = (cost(f64::INFINITY), cost(f64::NEG_INFINITY));
    let mut sum = 0.0;
    let mut sums = Vec::with_capacity(problem.blocks.len());
    for (not_yet, since) in not_yet.into_iter().zip(since) {
        sums.push(sum);
        sum += not_yet - since;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::gauss_newton::solve;
    use crate::offset::change::ChangePoint;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{SLIPS_AT, slipping, turntable};
    use crate::offset::state_estimate::{Payload, TENSIONED_OFFSET_RAD};

    #[test]
    fn slip_time_moves_to_true_block() {
        let model = turntable();
        let blocks = slipping(&model, 5e-3, 4);
        let believed = model
            .prior
            .state_estimate(Payload::Empty, TENSIONED_OFFSET_RAD);
        let problem =
            Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let slip = |b: usize| ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s: problem.start_of(b),
        };
        for off in [SLIPS_AT - 7, SLIPS_AT + 2] {
            let at = solve(&problem, &[slip(off)]).unwrap();
            let moved = at_best_time(&problem, &at, 0, |_| true).unwrap().unwrap();
            assert_eq!(moved.estimate.changes, [slip(SLIPS_AT)]);
            assert!(moved.cost() < cost_at(&problem, &at.estimate, &moved.estimate));
            // There it stays.
            let stays = at_best_time(&problem, &moved, 0, |_| true).unwrap();
            assert!(stays.is_none());
        }
        // As near as it may.
        let until = problem.start_of(SLIPS_AT - 3);
        let at = solve(&problem, &[slip(SLIPS_AT - 7)]).unwrap();
        let near = at_best_time(&problem, &at, 0, |at_s| at_s <= until);
        let near = near.unwrap().unwrap().estimate.changes;
        assert_eq!(near, [slip(SLIPS_AT - 3)]);
    }
}
