//! Whether motor and joint side are one signal.

use crate::error::{EstimateError, SidesFault};
use sinew_log::Frame;
use sinew_model::robot::Robot;

/// A joint that moved less than this tells nothing, rad.
const MOVED_RAD: f64 = 10e-3;
/// A spring whose deflection changes by no more than this carries nothing at all: rounding of positions, rad.
const NOTHING_RAD: f64 = 1e-9;

/// Least and largest of some readings.
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

/// Looks at every frame of a recording.
#[derive(Debug)]
pub(crate) struct OneSignal {
    /// Of every elastic joint its index, the travel of the joint and that of motor less joint.
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
            // NaN is passed over by both.
            joint.push(q);
            spring.push(theta - q);
        }
    }

    /// Refuses a recording in which a joint moved and its motor went along to the last digit.
    pub(crate) fn judge(&self, robot: &Robot, file: &str) -> Result<(), EstimateError> {
        let same = self.joints.iter().filter(|(_, joint, spring)| {
            joint.travel() > MOVED_RAD && (0.0..=NOTHING_RAD).contains(&spring.travel())
        });
        let joints: Vec<String> = same
            .map(|(i, ..)| robot.joint_names()[*i].clone())
            .collect();
        match joints.is_empty() {
            true => Ok(()),
            false => Err(EstimateError::Sides {
                file: file.into(),
                fault: SidesFault::Same { joints },
            }),
        }
    }
}
