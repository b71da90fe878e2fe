//! Distinct poses, which gravity loads differently.

use sinew_model::offset::Block;

/// Minimum difference of two distinct poses in at least one joint, rad.
const MIN_DIFFERENCE_RAD: f64 = 0.2;
/// Minimum number of distinct poses that separate payload, mass error and offset.
pub(super) const MIN_POSES: usize = 3;
/// Minimum number of distinct poses of a baseline; fewer degrade every estimate relative to it.
pub(super) const MIN_BASELINE_POSES: usize = 6;
/// Maximum number of counted poses.
const MAX_POSES: usize = 100;

/// Distinct poses so far, selected greedily.
#[derive(Debug, Clone, PartialEq)]
pub struct Poses {
    joints: usize,
    /// Joint positions, pose by pose, rad.
    poses_rad: Vec<f64>,
}

impl Poses {
    /// Creates an empty set for an arm with `joints` joints; the only function that allocates.
    pub fn new(joints: usize) -> Self {
        Self {
            joints: joints.max(1),
            poses_rad: Vec::with_capacity(MAX_POSES * joints),
        }
    }

    /// Distinct poses in a list of blocks.
    pub fn of(blocks: &[Block]) -> Self {
        let mut poses = Self::new(blocks.first().map_or(0, |block| block.q.len()));
        for block in blocks {
            poses.push(&block.q);
        }
        poses
    }

    /// Adds a pose if it is distinct, rad; a pose with another number of joints is ignored.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn push(&mut self, q_rad: &[f64]) {
        let is_apart = |pose: &[f64]| {
            let mut pairs = pose.iter().zip(q_rad);
            pairs.any(|(a, b)| (a - b).abs() > MIN_DIFFERENCE_RAD)
        };
        let is_new = self.poses_rad.chunks_exact(self.joints).all(is_apart);
        if is_new && self.count() < MAX_POSES && q_rad.len() == self.joints {
            self.poses_rad.extend_from_slice(q_rad);
        }
    }

    /// Number of distinct poses.
    pub fn count(&self) -> usize {
        self.poses_rad.len() / self.joints
    }

    /// Discards all poses, and keeps the allocation.
    pub fn clear(&mut self) {
        self.poses_rad.clear();
    }

    /// Joint positions of all poses, pose by pose, rad.
    pub fn as_slice(&self) -> &[f64] {
        &self.poses_rad
    }
}
