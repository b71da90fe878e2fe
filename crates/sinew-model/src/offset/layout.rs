//! Where what is in a state.

use super::effects::{JointParameter, PAYLOAD, PER_JOINT};
use core::ops::Range;

/// A state: the parameters of every joint, then of moment arms at other joints, then what is unknown of the bodies, then the payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Joints of the arm.
    pub(crate) joints: usize,
    /// Parameters of all bodies.
    pub(crate) bodies: usize,
    /// Moment arms of tendons at joints other than their own, whose errors are parameters.
    pub(crate) arms: usize,
    /// Whether a tendon crosses several joints, so that its equations know parameters of these.
    pub(crate) is_coupled: bool,
}

impl Layout {
    pub(crate) fn place(self, joint: usize, parameter: JointParameter) -> usize {
        joint * PER_JOINT + parameter as usize
    }

    /// Places of a joint's own parameters.
    pub(crate) fn own(self, joint: usize) -> Range<usize> {
        joint * PER_JOINT..(joint + 1) * PER_JOINT
    }

    /// Place of the error of the first moment arm.
    pub(crate) fn arm_start(self) -> usize {
        self.joints * PER_JOINT
    }

    pub(crate) fn body_start(self) -> usize {
        self.arm_start() + self.arms
    }

    pub(crate) fn payload_place(self) -> usize {
        self.body_start() + self.bodies
    }

    /// Places of bodies and payload.
    pub(crate) fn carried(self) -> Range<usize> {
        self.body_start()..self.dimension()
    }

    pub(crate) fn dimension(self) -> usize {
        self.payload_place() + PAYLOAD
    }
}
