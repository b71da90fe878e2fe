//! A baseline on its way, after a rope was tensioned.

use super::session::Stretch;
use crate::snapshot::Learning;
use crate::transaction::{Belief, LearnsBaseline};
use sinew_estimate::session::Poses;
use sinew_model::offset::Block;

/// Distinct poses a baseline needs: with four it spoils what is compared with it, and motion at work passes many.
const POSES_NEEDED: usize = 12;
/// Motion it needs, s.
const MOTION_NEEDED_S: f64 = 60.0;

/// A baseline on its way, block by block.
#[derive(Debug, Clone)]
pub(super) struct BaselineProgress {
    joints: Vec<String>,
    poses: Poses,
    motion_s: f64,
    /// Whether all it needs was handed over to be estimated.
    handed_over: bool,
}

impl BaselineProgress {
    /// The one that is to be learned, if one is.
    pub(super) fn of(belief: &Belief, joints: usize) -> Option<Self> {
        let so_far = belief.learns.as_ref()?;
        let mut poses = Poses::new(joints);
        for pose in so_far.poses_rad.chunks_exact(joints.max(1)) {
            poses.push(pose);
        }
        Some(Self {
            joints: so_far.joints.clone(),
            poses,
            motion_s: so_far.duration_s,
            handed_over: false,
        })
    }

    /// Adds a stretch.
    pub(super) fn with(mut self, stretch: &Stretch) -> Self {
        for block in &stretch.recorded.blocks {
            self.poses.push(&block.q);
        }
        self.motion_s += stretch.motion_s;
        self
    }

    /// Adds a block.
    pub(super) fn block(&mut self, block: &Block, moved: bool, block_s: f64) {
        self.poses.push(&block.q);
        if moved {
            self.motion_s += block_s;
        }
    }

    /// Distinct poses so far.
    pub(super) fn poses(&self) -> u64 {
        self.poses.count() as u64
    }

    /// Whether that is enough, said once.
    pub(super) fn hand_over(&mut self) -> bool {
        let now = self.is_ready() && !self.handed_over;
        self.handed_over |= now;
        now
    }

    /// Whether that is enough.
    pub(super) fn is_ready(&self) -> bool {
        self.poses.count() >= POSES_NEEDED && self.motion_s >= MOTION_NEEDED_S
    }

    /// As it is stored.
    pub(super) fn so_far(&self) -> LearnsBaseline {
        LearnsBaseline {
            joints: self.joints.clone(),
            duration_s: self.motion_s,
            poses_rad: self.poses.as_slice().to_vec(),
        }
    }

    /// As a snapshot has it.
    pub(super) fn shown(&self) -> Learning {
        Learning::Baseline {
            duration_s: self.motion_s,
            poses: self.poses(),
            poses_needed: POSES_NEEDED as u64,
        }
    }
}
