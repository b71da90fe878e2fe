//! When a change came.

use super::changes::{SAME_S, Seek, What, softens};
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
        let moved = |at_s: f64| {
            let mut moved = known.changes.clone();
            for c in &mut moved {
                if softens(c, &change) {
                    c.at_s = at_s;
                }
            }
            moved[k].at_s = at_s;
            moved
        };
        let cost = |at_s: f64| {
            let there = MapEstimate {
                changes: moved(at_s),
                ..known.clone()
            };
            self.cost_by_block(&there)
        };
        // Sum of costs if it happened with a block: those before it, and those from there on.
        let (not_yet, since) = (cost(f64::INFINITY), cost(f64::NEG_INFINITY));
        let (mut sum, mut is, mut least) = (0.0, None, None);
        for (b, (not_yet, since)) in not_yet.into_iter().zip(since).enumerate() {
            let at_s = self.start_of(b);
            if is.is_none() && self.blocks[b].time_s >= change.at_s {
                is = Some((sum, at_s));
            }
            if possible(at_s) && least.is_none_or(|(least, _)| sum < least) {
                least = Some((sum, at_s));
            }
            sum += not_yet - since;
        }
        match (is, least) {
            (Some((is, _)), Some((least, at_s))) if least < is => self
                .solve_from(&moved(at_s), &known.state, known, NEARLY)
                .map(Some),
            _ => Ok(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{ArmBuilder, BodyInertia, BodySpec, JointKind, Pose};
    use crate::offset::block::Block;
    use crate::offset::changes::{Change, KEEP};
    use crate::offset::course::LOOK;
    use crate::offset::drawn::random;
    use crate::offset::map::MapEstimator;
    use crate::offset::prior::{JointPrior, Payload, Prior};
    use crate::offset::{FeatureConfig, TENSIONED_OFFSET_RAD};
    use crate::tolerances::Tolerances;
    use alloc::string::String;

    const BLOCKS: usize = 80;
    const SLIPS_AT: usize = 40;

    /// A joint about the vertical.
    fn estimator() -> MapEstimator {
        let turntable = BodySpec {
            name: String::from("one"),
            parent: None,
            kind: JointKind::Revolute,
            axis: [0.0, 0.0, 1.0],
            placement: Pose::from_xyz_rpy([0.0; 3], [0.0; 3]),
            body: BodyInertia::point(1.0, [0.1, 0.0, 0.0]),
        };
        let arm = ArmBuilder::new().body(turntable).build().unwrap();
        let mut prior = Prior::new(&arm, &[None], 0, [0.0; 3], Tolerances::default());
        prior.joints[0] = Some(JointPrior {
            stiffness_nm_per_rad: 40.0,
            motor_inertia_kg_m2: None,
            coulomb_nm: 0.0,
            viscous_nm_s_per_rad: 0.0,
            motor_coulomb_nm: 0.0,
            motor_viscous_nm_s_per_rad: 0.0,
            antagonistic: false,
        });
        MapEstimator::new(prior, &FeatureConfig::default())
    }

    /// Poses without a load, of a joint that slips by 5 mrad.
    fn blocks(estimator: &MapEstimator) -> Vec<Block> {
        let columns = estimator.model().layout.bodies;
        let mut seed = 4;
        (0..BLOCKS)
            .map(|b| {
                let mut block = Block::zero(1, columns);
                block.time_s = 0.1 + 0.2 * b as f64;
                block.q[0] = random(&mut seed);
                let slipped = if b >= SLIPS_AT { 5e-3 } else { 0.0 };
                let y = 1e-3 + slipped + 0.2e-3 * random(&mut seed);
                (block.y[0], block.y_square[0], block.y_cube[0]) = (y, y * y, y * y * y);
                block.motor_torque[0] = f64::NAN;
                block
            })
            .collect()
    }

    #[test]
    fn a_slip_moves_to_the_block_it_came_with() {
        let estimator = estimator();
        let blocks = blocks(&estimator);
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
        let estimator = estimator();
        let blocks = blocks(&estimator);
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
