//! When a change came.

use super::changes::{Change, SAME_S, Seek, What, softens};
use super::course::NEARLY;
use super::map::{MapError, MapEstimate};
use super::solution::Solution;
use super::solve::Problem;
use alloc::vec::Vec;

impl Problem<'_> {
    /// Every slip's moment once more, now that the other changes are known.
    pub(super) fn retimed(&self, mut best: Solution, seek: Seek) -> Result<Solution, MapError> {
        for k in 0..best.estimate.changes.len() {
            let changes = &best.estimate.changes;
            let change = changes[k];
            if !matches!(change.what, What::Offset(_)) {
                continue;
            }
            let others = changes
                .iter()
                .filter(|c| c.what == change.what && **c != change);
            let others: Vec<f64> = others.map(|c| c.at_s).collect();
            let free = |at_s: f64| others.iter().all(|other| (other - at_s).abs() >= SAME_S);
            let possible = |at_s: f64| free(at_s) && self.is_possible(change.what, at_s, seek);
            if let Some(trial) = self.at_its_moment(&best, k, possible)?
                && trial.estimate.cost < self.cost_at(&best.estimate, &trial.estimate)
            {
                best = trial;
            }
        }
        Ok(best)
    }

    /// The estimate with change `k`, and the stiffness that goes with it, at the moment that costs
    /// least; `None` where that is where it is. Between two moments that differ by a block the state
    /// hardly moves: what the block costs before and after the change decides.
    pub(super) fn at_its_moment(
        &self,
        at: &Solution,
        k: usize,
        possible: impl Fn(f64) -> bool,
    ) -> Result<Option<Solution>, MapError> {
        let known = &at.estimate;
        let change = known.changes[k];
        let (mut is, mut least) = (None, None);
        for (b, sum) in self.sums_by_moment(known, k).into_iter().enumerate() {
            let at_s = self.start_of(b);
            if is.is_none() && self.blocks[b].time_s >= change.at_s {
                is = Some(sum);
            }
            if possible(at_s) && least.is_none_or(|(least, _)| sum < least) {
                least = Some((sum, at_s));
            }
        }
        match (is, least) {
            (Some(is), Some((least, at_s))) if least < is => self
                .solve_from(&moved(known, k, at_s), &known.state, known, NEARLY)
                .map(Some),
            _ => Ok(None),
        }
    }

    /// What all blocks cost if change `k`, with the stiffness that goes with it, came with each of them:
    /// those before it as if it had not come, those from there on as if it had; over what they cost if
    /// it came with the first.
    pub(super) fn sums_by_moment(&self, known: &MapEstimate, k: usize) -> Vec<f64> {
        let cost = |at_s: f64| {
            let there = MapEstimate {
                changes: moved(known, k, at_s),
                ..known.clone()
            };
            self.cost_by_block(&there)
        };
        let (not_yet, since) = (cost(f64::INFINITY), cost(f64::NEG_INFINITY));
        let mut sum = 0.0;
        let mut sums = Vec::with_capacity(self.blocks.len());
        for (not_yet, since) in not_yet.into_iter().zip(since) {
            sums.push(sum);
            sum += not_yet - since;
        }
        sums
    }
}

/// The changes with the `k`-th, and the stiffness that goes with it, at another moment.
fn moved(known: &MapEstimate, k: usize, at_s: f64) -> Vec<Change> {
    let mut moved = known.changes.clone();
    for c in &mut moved {
        if softens(c, &known.changes[k]) {
            c.at_s = at_s;
        }
    }
    moved[k].at_s = at_s;
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::TENSIONED_OFFSET_RAD;
    use crate::offset::changes::KEEP;
    use crate::offset::course::LOOK;
    use crate::offset::drawn::{SLIPS_AT, slipping, turntable};
    use crate::offset::prior::Payload;

    #[test]
    fn a_slip_moves_to_the_block_it_came_with() {
        let estimator = turntable();
        let blocks = slipping(&estimator, 5e-3, 4);
        let believed = (estimator.prior()).belief(Payload::Empty, TENSIONED_OFFSET_RAD);
        let problem = Problem::new(&estimator, &believed, Payload::Empty, &blocks).unwrap();
        let slip = |b: usize| Change {
            what: What::Offset(0),
            at_s: problem.start_of(b),
        };
        for off in [SLIPS_AT - 7, SLIPS_AT + 2] {
            let at = problem.solve(&[slip(off)]).unwrap();
            let moved = problem.at_its_moment(&at, 0, |_| true).unwrap().unwrap();
            assert_eq!(moved.estimate.changes, [slip(SLIPS_AT)]);
            assert!(moved.estimate.cost < problem.cost_at(&at.estimate, &moved.estimate));
            // There it stays.
            let stays = problem.at_its_moment(&moved, 0, |_| true).unwrap();
            assert!(stays.is_none());
        }
        // As near as it may.
        let until = problem.start_of(SLIPS_AT - 3);
        let at = problem.solve(&[slip(SLIPS_AT - 7)]).unwrap();
        let near = problem.at_its_moment(&at, 0, |at_s| at_s <= until);
        let near = near.unwrap().unwrap().estimate.changes;
        assert_eq!(near, [slip(SLIPS_AT - 3)]);
    }

    #[test]
    fn a_look_takes_off_what_the_costs_differ_by() {
        let estimator = turntable();
        let blocks = slipping(&estimator, 5e-3, 4);
        let believed = (estimator.prior()).belief(Payload::Empty, TENSIONED_OFFSET_RAD);
        let problem = Problem::new(&estimator, &believed, Payload::Empty, &blocks).unwrap();
        let best = problem.solve(&[]).unwrap().estimate;
        let slip = Change {
            what: What::Offset(0),
            at_s: problem.start_of(SLIPS_AT),
        };
        let mut state = best.state.clone();
        state.push(4e-3);
        let look = problem.solve_from(&[slip], &state, &best, LOOK).unwrap();
        let gain = problem.seen(&best).gain(&look);
        let found = problem.fitted(&best, slip, look);
        assert!((gain - found.gain).abs() < 1e-9 * gain.abs(), "{gain}");
        assert!(gain > KEEP, "{gain}");
    }
}
