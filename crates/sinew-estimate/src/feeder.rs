//! Input of frames to an observer, without I/O.
//!
//! The replay of a recording, the session recorder, the scenario bench and online programs pass frames to
//! their observer through a [`Feeder`], so that all treat a frame in the same way. [`sinew_model::feeder`] defines
//! which frames are used and with which time step; a microcontroller uses it directly.

use sinew_log::Frame;
use sinew_model::feeder::RobotSample;
pub use sinew_model::feeder::{
    FeedOutcome, FeederOptions, FrameObserver, Input, MissingMotor, Needs, Reach, RejectionReason,
};
use sinew_model::robot::Robot;
use sinew_model::transmission::Transmission;

/// Offset added to a joint's motor position to test the estimate, as in the paper.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Injection {
    /// Name of the tendon; the offset is in the coordinate of the joint paired with it.
    pub joint: String,
    /// Added offset, rad.
    pub offset_rad: f64,
    /// Start of the injection since the start of the recording, s; none: from the start.
    pub from_s: Option<f64>,
}

/// Converts a frame to the input of a feeder.
pub fn robot_sample(frame: &Frame) -> RobotSample<'_> {
    RobotSample {
        time_ns: frame.time_ns,
        segment: frame.segment,
        q: &frame.q,
        theta: &frame.theta,
        dq: &frame.dq,
        tau_el: &frame.tau_el,
        tau_m: &frame.tau_m,
        tau_ext: &frame.tau_ext,
        tension: &frame.tension,
        temperature_c: frame.temperature_c,
    }
}

/// Feeder of frames that owns its observer.
#[derive(Debug, Clone)]
pub struct Feeder<O>(sinew_model::feeder::Feeder<O>);

impl<O: FrameObserver> Feeder<O> {
    /// Creates a feeder of `observer`. Joints without a transmission are rigid. Allocates all memory.
    pub fn new(
        observer: O,
        transmissions: &[Option<Transmission>],
        options: FeederOptions,
    ) -> Self {
        let feeder = sinew_model::feeder::Feeder::new(observer, transmissions, options);
        Self(feeder)
    }

    /// Adds offsets to the motor positions. Injections at tendons that the robot does not have are ignored.
    #[must_use]
    pub fn with_injections(mut self, robot: &Robot, injections: &[Injection]) -> Self {
        for injection in injections {
            let from_ns = injection.from_s.map_or(i64::MIN, |s| (s * 1e9) as i64);
            if let Some(joint) = robot.tendon_index(&injection.joint) {
                self.0.inject(joint, from_ns, injection.offset_rad);
            }
        }
        self
    }

    /// Rejects samples beyond the limits of the robot's joints, with the margins of [`Reach`].
    #[must_use]
    pub fn with_limits(self, robot: &Robot) -> Self {
        let limits = robot.limits.iter();
        let reach = limits.map(|limit| Reach::new(limit.lower, limit.upper, limit.velocity));
        Self(self.0.with_reach(reach))
    }

    /// Sets the start of the recording to which the times of injections refer; default: the first frame.
    pub fn set_start(&mut self, time_ns: i64) {
        self.0.set_start(time_ns);
    }

    /// Processes the next frame.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock, apart from the observer's step.
    pub fn frame(&mut self, frame: &Frame) -> FeedOutcome<O::Output> {
        self.0.take(&robot_sample(frame))
    }

    /// Treats the next frame as the first one, as after a gap.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn restart(&mut self) {
        self.0.restart();
    }

    /// Returns the observer after its last frame.
    pub fn observer(&self) -> &O {
        self.0.observer()
    }

    /// Returns the latest motor positions passed to the observer, including injected offsets, rad, length `n`.
    pub fn theta(&self) -> &[f64] {
        self.0.theta()
    }

    /// Returns the time of the first frame, ns.
    pub fn start_ns(&self) -> Option<i64> {
        self.0.start_ns()
    }

    /// Returns the number of segments so far.
    pub fn segments(&self) -> u32 {
        self.0.segments()
    }

    /// Whether a joint's motor position has been missing for long enough that its last value is used.
    pub fn is_held(&self, joint: usize) -> bool {
        self.0.is_held(joint)
    }

    /// Whether the estimate of a joint has settled since its motor position was available again.
    pub fn is_joint_settled(&self, joint: usize) -> bool {
        self.0.is_joint_settled(joint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feeder_gap_limit_equals_recording_gap_limit() {
        let cut = sinew_log::OpenOptions::default().gap_s;
        assert_eq!(FeederOptions::default().gap_s.to_bits(), cut.to_bits());
    }
}
