//! Detection of motor and joint positions that are the same signal.

use crate::error::{EstimateError, SidesFault};
use sinew_log::Frame;
use sinew_model::robot::Robot;

/// Minimum travel of a joint for the check, rad.
const MIN_TRAVEL_RAD: f64 = 10e-3;
/// Maximum travel of the deflection of an unloaded spring, rad; bounds the rounding of positions.
const MAX_UNLOADED_DEFLECTION_RAD: f64 = 1e-9;

/// Minimum and maximum of a signal.
#[derive(Debug, Clone, Copy)]
struct Range(f64, f64);

impl Range {
    fn push(&mut self, x: f64) {
        *self = Self(self.0.min(x), self.1.max(x));
    }

    fn travel(self) -> f64 {
        self.1 - self.0
    }
}

/// Check of all frames of a recording.
#[derive(Debug)]
pub(crate) struct OneSignal {
    /// Index, joint position range and range of motor minus joint position of every elastic joint.
    joints: Vec<(usize, Range, Range)>,
}

impl OneSignal {
    pub(crate) fn new(robot: &Robot) -> Self {
        let nothing = Range(f64::INFINITY, f64::NEG_INFINITY);
        let elastic = robot.transmissions.iter().enumerate();
        let elastic = elastic.filter(|(_, t)| t.is_some());
        Self {
            joints: elastic.map(|(i, _)| (i, nothing, nothing)).collect(),
        }
    }

    pub(crate) fn frame(&mut self, frame: &Frame) {
        for (i, joint, spring) in &mut self.joints {
            let (q, theta) = (frame.q[*i], frame.theta[*i]);
            // Both ignore NaN.
            joint.push(q);
            spring.push(theta - q);
        }
    }

    /// Returns an error if a joint moved and its motor position was identical in all frames.
    pub(crate) fn check(&self, robot: &Robot, file: &str) -> Result<(), EstimateError> {
        let same = self.joints.iter().filter(|(_, joint, spring)| {
            joint.travel() > MIN_TRAVEL_RAD
                && (0.0..=MAX_UNLOADED_DEFLECTION_RAD).contains(&spring.travel())
        });
        let joints: Vec<String> = same.map(|(i, ..)| robot.axis_name(*i).to_owned()).collect();
        match joints.is_empty() {
            true => Ok(()),
            false => Err(EstimateError::Sides {
                file: file.into(),
                fault: SidesFault::Same { joints },
            }),
        }
    }
}
