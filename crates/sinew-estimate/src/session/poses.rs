//! Distinct poses, as far as gravity tells them apart.

use sinew_model::offset::Block;

/// Poses differ by more than this in some joint, rad.
const APART_RAD: f64 = 0.2;
/// Poses counted at most.
const MOST: usize = 100;

/// Distinct poses so far, greedily.
#[derive(Debug, Clone, PartialEq)]
pub struct Poses {
    joints: usize,
    /// One after the other, rad.
    poses_rad: Vec<f64>,
}

impl Poses {
    /// None yet, of an arm of so many joints; allocates here only.
    pub fn new(joints: usize) -> Self {
        Self {
            joints: joints.max(1),
            poses_rad: Vec::with_capacity(MOST * joints),
        }
    }

    /// Those of some blocks.
    pub fn of(blocks: &[Block]) -> Self {
        let mut poses = Self::new(blocks.first().map_or(0, |block| block.q.len()));
        for block in blocks {
            poses.push(&block.q);
        }
        poses
    }

    /// Takes a pose; one of another arm is left out.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn push(&mut self, q_rad: &[f64]) {
        let is_apart = |pose: &[f64]| {
            let mut pairs = pose.iter().zip(q_rad);
            pairs.any(|(a, b)| (a - b).abs() > APART_RAD)
        };
        let is_new = self.poses_rad.chunks_exact(self.joints).all(is_apart);
        if is_new && self.count() < MOST && q_rad.len() == self.joints {
            self.poses_rad.extend_from_slice(q_rad);
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.poses_rad.len() / self.joints
    }

    /// Forgets them.
    pub fn clear(&mut self) {
        self.poses_rad.clear();
    }

    /// One after the other, rad.
    pub fn as_slice(&self) -> &[f64] {
        &self.poses_rad
    }
}
