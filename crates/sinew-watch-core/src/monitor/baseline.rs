//! Baseline acquisition after a re-tensioning.

use super::session::Segment;
use crate::snapshot::Learning;
use crate::transaction::{BaselineAcquisition, MonitorState};
use sinew_estimate::session::Poses;
use sinew_model::offset::Block;

/// Minimum number of distinct poses of a baseline; four would degrade every estimate relative to it, and motion at work
/// passes many.
const MIN_POSES: usize = 12;
/// Minimum duration of motion of a baseline, s.
const MIN_MOTION_S: f64 = 60.0;

/// Progress of a baseline acquisition, updated with each block.
#[derive(Debug, Clone)]
pub(super) struct BaselineProgress {
    joints: Vec<String>,
    poses: Poses,
    motion_s: f64,
    /// Whether the complete motion was already taken for the estimate.
    is_taken: bool,
}

impl BaselineProgress {
    /// Returns the acquisition in progress; `None` if there is none.
    pub(super) fn of(state: &MonitorState, joints: usize) -> Option<Self> {
        let so_far = state.learns.as_ref()?;
        let mut poses = Poses::new(joints);
        for pose in so_far.poses_rad.chunks_exact(joints.max(1)) {
            poses.push(pose);
        }
        Some(Self {
            joints: so_far.joints.clone(),
            poses,
            motion_s: so_far.duration_s,
            is_taken: false,
        })
    }

    /// Adds a segment.
    pub(super) fn with(mut self, segment: &Segment) -> Self {
        for block in &segment.recorded.blocks {
            self.poses.push(&block.q);
        }
        self.motion_s += segment.motion_s;
        self
    }

    /// Adds a block.
    pub(super) fn block(&mut self, block: &Block, moved: bool, block_s: f64) {
        self.poses.push(&block.q);
        if moved {
            self.motion_s += block_s;
        }
    }

    /// Returns the number of distinct poses so far.
    pub(super) fn poses(&self) -> u64 {
        self.poses.count() as u64
    }

    /// Returns true once, when poses and motion are sufficient.
    pub(super) fn take_ready(&mut self) -> bool {
        let now = self.is_ready() && !self.is_taken;
        self.is_taken |= now;
        now
    }

    /// Whether the numbers of poses and the duration of motion are sufficient.
    pub(super) fn is_ready(&self) -> bool {
        self.poses.count() >= MIN_POSES && self.motion_s >= MIN_MOTION_S
    }

    /// Returns the progress in its stored form.
    pub(super) fn so_far(&self) -> BaselineAcquisition {
        BaselineAcquisition {
            joints: self.joints.clone(),
            duration_s: self.motion_s,
            poses_rad: self.poses.as_slice().to_vec(),
        }
    }

    /// Returns the progress as snapshot in a snapshot.
    pub(super) fn snapshot(&self) -> Learning {
        Learning::Baseline {
            duration_s: self.motion_s,
            poses: self.poses(),
            poses_needed: MIN_POSES as u64,
        }
    }
}
