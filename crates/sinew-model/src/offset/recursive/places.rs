//! Whether an arm works or stands.

use crate::offset::block::copy;
use crate::offset::external_force::PLACE_RAD;
use alloc::vec::Vec;

/// The poses that an arm was in most, and for how long.
///
/// Counts are those of the *space-saving* algorithm (Metwally, Agrawal, El Abbadi, 2005): a pose in which the arm is for more than
/// one in [`Places::MOST`] of the blocks is always among them.
#[derive(Debug, Clone)]
pub(super) struct Places {
    /// Poses, a row each, and blocks in them.
    poses: Vec<f64>,
    blocks: Vec<f64>,
    /// Blocks of this span.
    taken: f64,
    /// The least share of a span's blocks that were in one pose, of all spans that are over.
    least: f64,
    /// Share of the blocks of the last span that is over that were in [`Places::FEW`] poses.
    in_few: Option<f64>,
}

impl Places {
    const MOST: usize = 16;
    /// So few poses say little of which torque goes with which: an arm on one of two ways stops in four.
    const FEW: usize = 4;
    /// Blocks of a span, five minutes: an arm that worked, and stands since, has said what it did of a force.
    const SPAN: f64 = 1500.0;
    /// Blocks of a span that say something of it, a minute.
    const ENOUGH: f64 = 300.0;

    pub(super) fn new(joints: usize) -> Self {
        Self {
            poses: alloc::vec![0.0; joints * Self::MOST],
            blocks: alloc::vec![0.0; Self::MOST],
            taken: 0.0,
            least: f64::INFINITY,
            in_few: None,
        }
    }

    /// A block has come.
    pub(super) fn note(&mut self, q: &[f64]) {
        if self.taken >= Self::SPAN {
            let [one, few] = self.shares();
            self.least = self.least.min(one);
            self.in_few = Some(few);
            self.blocks.fill(0.0);
            self.taken = 0.0;
        }
        self.taken += 1.0;
        let n = q.len().max(1);
        let mut rarest = (f64::INFINITY, 0);
        let poses = self.poses.chunks_exact_mut(n).zip(&mut self.blocks);
        for (k, (pose, blocks)) in poses.enumerate() {
            let is_here = |(a, b): (&f64, &f64)| (a - b).abs() <= PLACE_RAD;
            if *blocks > 0.0 && pose.iter().zip(q).all(is_here) {
                *blocks += 1.0;
                // Its middle.
                for (pose, q) in pose.iter_mut().zip(q) {
                    *pose += (q - *pose) / *blocks;
                }
                return;
            }
            if *blocks < rarest.0 {
                rarest = (*blocks, k);
            }
        }
        let (_, k) = rarest;
        if let (Some(pose), Some(blocks)) = (
            self.poses.get_mut(k * n..(k + 1) * n),
            self.blocks.get_mut(k),
        ) {
            copy(pose, q);
            *blocks += 1.0;
        }
    }

    /// Share of this span's blocks in the pose that has most, and in the few that have.
    fn shares(&self) -> [f64; 2] {
        let mut most = [0.0; Self::FEW];
        for &blocks in &self.blocks {
            let mut left: f64 = blocks;
            for place in &mut most {
                (*place, left) = (left.max(*place), left.min(*place));
            }
        }
        let [first, ..] = most;
        let few: f64 = most.iter().sum();
        [first, few].map(|blocks| blocks / self.taken.max(1.0))
    }

    /// Share of the time in which the arm was in one pose, 0 to 1: of the span in which that was least.
    pub(super) fn most_in_one(&self) -> f64 {
        let [one, _] = self.shares();
        match self.least.is_finite() {
            true => self.least,
            false => one,
        }
    }

    /// Share of the time in which the arm was in the four poses that have most: of this span, or of the one before while this one is
    /// shorter than a minute. What slips now is seen from where the arm is now.
    pub(super) fn most_in_few(&self) -> f64 {
        let [_, few] = self.shares();
        let before = self.in_few.filter(|_| self.taken < Self::ENOUGH);
        before.unwrap_or(few)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::random;

    /// An arm that stands, with a lean of two blocks in fifty; then works; then stands for an hour.
    #[test]
    fn an_arm_that_has_worked_is_not_one_that_stands() {
        let mut seed = 3;
        let mut places = Places::new(2);
        let stand = |places: &mut Places, blocks: usize, seed: &mut u64| {
            for k in 0..blocks {
                let leant = if k % 50 < 2 { 0.5 } else { 0.0 };
                places.note(&[1.0 + leant + 0.05 * random(seed), -0.3]);
            }
        };
        stand(&mut places, 1500, &mut seed);
        assert!(
            (places.most_in_one() - 0.96).abs() < 0.01,
            "{}",
            places.most_in_one()
        );
        for _ in 0..3000 {
            places.note(&[0, 1].map(|_| 2.0 * random(&mut seed)));
        }
        let worked = (places.most_in_one(), places.most_in_few());
        assert!(worked.0 < 0.3 && worked.1 < 0.5, "{worked:?}");
        stand(&mut places, 200, &mut seed);
        assert_eq!((places.most_in_one(), places.most_in_few()), worked);
        stand(&mut places, 17_800, &mut seed);
        assert_eq!(places.most_in_one(), worked.0);
        assert!(places.most_in_few() > 0.99, "{}", places.most_in_few());
    }

    /// Half of the time in the first of five poses, an eighth in each of the others.
    #[test]
    fn the_few_poses_that_have_most_are_counted() {
        let mut places = Places::new(2);
        for pose in [0, 1, 0, 2, 0, 3, 0, 4].repeat(20) {
            places.note(&[f64::from(pose), 0.0]);
        }
        assert!((places.most_in_one() - 0.5).abs() < 1e-12);
        assert!((places.most_in_few() - 0.875).abs() < 1e-12);
    }
}
