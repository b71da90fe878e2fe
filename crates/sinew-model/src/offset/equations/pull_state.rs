//! Tension of a tendon whose group has one equation per joint.

use crate::offset::effects::{JointRow, PER_JOINT};

/// Tension of a tendon at a state.
#[derive(Debug, Clone, Copy)]
pub(super) struct PullState {
    /// Mean tension, N·m in the tendon's coordinate.
    pub(super) f: f64,
    /// Decrease per rad of deflection that does not act on the spring, N·m/rad; 0 of a slack strand.
    pub(super) slope: f64,
    /// Extension that it was computed with, rad.
    pub(super) y: f64,
    /// How it moves with the parameters of its axis, errors of encoders aside.
    pub(super) row: JointRow,
}

impl PullState {
    pub(super) const NONE: Self = Self {
        f: 0.0,
        slope: 0.0,
        y: 0.0,
        row: [0.0; PER_JOINT],
    };
}
