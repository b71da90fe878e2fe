//! Layout of the entries in a state.

use super::effects::{JointParameter, PAYLOAD, PER_JOINT};
use core::ops::Range;

/// Layout of the state: the parameters of every axis, then the errors of moment arms at other joints, joint springs
/// and tension sensors, then the unknown parameters of the bodies, then the payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Axes: joints of the arm, and tendons beyond these.
    pub(crate) joints: usize,
    /// Parameters of all bodies.
    pub(crate) bodies: usize,
    /// Moment arms of tendons at joints other than their own, whose errors are parameters.
    pub(crate) arms: usize,
    /// Joints with a passive spring, each with two parameters.
    pub(crate) springs: usize,
    /// Axes whose tension may be measured, each with two parameters.
    pub(crate) sensors: usize,
    /// Whether a tendon crosses several joints, so that its equations contain their parameters.
    pub(crate) is_coupled: bool,
}

impl Layout {
    pub(crate) fn place(self, joint: usize, parameter: JointParameter) -> usize {
        joint * PER_JOINT + parameter as usize
    }

    /// Returns the indices of a joint's parameters.
    pub(crate) fn own(self, joint: usize) -> Range<usize> {
        joint * PER_JOINT..(joint + 1) * PER_JOINT
    }

    /// Place of the error of the first moment arm.
    pub(crate) fn arm_start(self) -> usize {
        self.joints * PER_JOINT
    }

    /// Place of the first parameter of the first joint spring.
    pub(crate) fn spring_start(self) -> usize {
        self.arm_start() + self.arms
    }

    /// Place of the first parameter of the tension sensor of the first axis.
    pub(crate) fn sensor_start(self) -> usize {
        self.spring_start() + 2 * self.springs
    }

    pub(crate) fn body_start(self) -> usize {
        self.sensor_start() + 2 * self.sensors
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

#[cfg(test)]
impl Layout {
    /// Layout of a robot on which every joint has a tendon of its own.
    pub(crate) fn diagonal(joints: usize, bodies: usize) -> Self {
        Self {
            joints,
            bodies,
            arms: 0,
            springs: 0,
            sensors: 0,
            is_coupled: false,
        }
    }
}
