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
}

impl Places {
    const MOST: usize = 16;
    /// Blocks of a span, five minutes: an arm that worked, and stands since, has said what it did of a force.
    const SPAN: f64 = 1500.0;

    pub(super) fn new(joints: usize) -> Self {
        Self {
            poses: alloc::vec![0.0; joints * Self::MOST],
            blocks: alloc::vec![0.0; Self::MOST],
            taken: 0.0,
            least: f64::INFINITY,
        }
    }

    /// A block has come.
    pub(super) fn note(&mut self, q: &[f64]) {
        if self.taken >= Self::SPAN {
            self.least = self.least.min(self.share());
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

    /// Share of this span's blocks in the pose that has most.
    fn share(&self) -> f64 {
        self.blocks.iter().fold(0.0_f64, |most, b| most.max(*b)) / self.taken.max(1.0)
    }

    /// Share of the time in which the arm was in one pose, 0 to 1: of the span in which that was least.
    pub(super) fn most_in_one(&self) -> f64 {
        match self.least.is_finite() {
            true => self.least,
            false => self.share(),
        }
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
        let worked = places.most_in_one();
        assert!(worked < 0.3, "{worked}");
        stand(&mut places, 18_000, &mut seed);
        assert_eq!(places.most_in_one(), worked);
    }
}
