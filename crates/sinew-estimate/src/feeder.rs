//! From frames to an observer, sans I/O.
//!
//! Replay of a recording, the session's recorder, the scenario bench and a live program all feed
//! their observer through a [`Feeder`], so that a frame means the same to each. Which frames are used, and with which time
//! step, stands in [`sinew_model::feeder`]; a microcontroller uses that one itself.

use sinew_log::Frame;
use sinew_model::feeder::Reading;
pub use sinew_model::feeder::{
    Fed, FeederOptions, FrameObserver, Input, MissingMotor, Needs, Refusal,
};
use sinew_model::robot::Robot;
use sinew_model::transmission::Transmission;

/// An offset added to a joint's motor position, as the paper does to see it found again.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Injection {
    /// Tendon it is added to, in the coordinate of the joint it is paired with.
    pub joint: String,
    /// Offset, rad.
    pub offset_rad: f64,
    /// From this time of the recording on, s; `None` from the start.
    pub from_s: Option<f64>,
}

/// A frame as a feeder takes it.
pub fn reading(frame: &Frame) -> Reading<'_> {
    Reading {
        time_ns: frame.time_ns,
        segment: frame.segment,
        q: &frame.q,
        theta: &frame.theta,
        dq: &frame.dq,
        tau_el: &frame.tau_el,
        tau_m: &frame.tau_m,
        tau_ext: &frame.tau_ext,
        temperature_c: frame.temperature_c,
    }
}

/// Feeds frames to an observer, which it owns.
#[derive(Debug, Clone)]
pub struct Feeder<O>(sinew_model::feeder::Feeder<O>);

impl<O: FrameObserver> Feeder<O> {
    /// A feeder of `observer`. Joints without a transmission are rigid. All memory is allocated here.
    pub fn new(
        observer: O,
        transmissions: &[Option<Transmission>],
        options: FeederOptions,
    ) -> Self {
        let feeder = sinew_model::feeder::Feeder::new(observer, transmissions, options);
        Self(feeder)
    }

    /// Adds offsets to the motor positions on the way; those of tendons that the robot doesn't have are
    /// left out.
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

    /// When the recording began that injections count from; otherwise with the first frame.
    pub fn set_start(&mut self, time_ns: i64) {
        self.0.set_start(time_ns);
    }

    /// Takes the next frame.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock of its own; the observer's step besides.
    pub fn frame(&mut self, frame: &Frame) -> Fed<O::Output> {
        self.0.take(&reading(frame))
    }

    /// The next frame is a start, as after a gap.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn restart(&mut self) {
        self.0.restart();
    }

    /// The observer, after the last frame it took.
    pub fn observer(&self) -> &O {
        self.0.observer()
    }

    /// Motor positions as the observer got them last, injected offsets included, `n`, rad.
    pub fn theta(&self) -> &[f64] {
        self.0.theta()
    }

    /// Time of the first frame, ns.
    pub fn start_ns(&self) -> Option<i64> {
        self.0.start_ns()
    }

    /// Segments so far.
    pub fn segments(&self) -> u32 {
        self.0.segments()
    }

    /// Whether a joint's motor position has been missing for so long that its last one is held.
    pub fn is_held(&self, joint: usize) -> bool {
        self.0.is_held(joint)
    }

    /// Whether a joint has settled since its motor position came back.
    pub fn is_joint_settled(&self, joint: usize) -> bool {
        self.0.is_joint_settled(joint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feeder_starts_anew_where_a_recording_is_cut() {
        let cut = sinew_log::OpenOptions::default().gap_s;
        assert_eq!(FeederOptions::default().gap_s.to_bits(), cut.to_bits());
    }
}
