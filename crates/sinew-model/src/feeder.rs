//! Feeding of samples to an observer: selection of the samples and of the time step.
//!
//! All callers pass a robot's samples to an observer through a [`Feeder`], on a microcontroller as in a replay, so that
//! samples are treated identically.
//!
//! | sample | effect |
//! |---|---|
//! | the first one, a new segment, a pause longer than the gap limit | the observer is re-initialised |
//! | a joint position missing or not finite | the sample is rejected; the observer's filters step over it |
//! | a velocity or torque that the observer needs missing or not finite | the sample is rejected; the observer's filters step over it |
//! | an elastic joint's motor position missing or not finite | as specified by [`MissingMotor`] |
//! | a rigid joint's motor position missing or not finite | none: the joint position is used instead |
//! | a time stamp that does not increase, an implausibly large value | the sample is rejected |
//! | a position beyond the [`Reach`] of its joint, or that no drive reaches from the last accepted one | the sample is rejected |
//!
//! The time step is the time since the last sample that the observer **accepted**: rejected samples have no effect.

use crate::StepError;
use crate::offset::{FeatureObserver, OffsetObserver, Sample, TorqueSource, VelocityFilter};
use crate::routings::Routings;
use crate::transmission::Transmission;
use alloc::vec::Vec;

/// Default gap limit: a longer pause between samples re-initialises the observer, s.
pub const GAP_S: f64 = 0.5;

/// Speed that no drive of a robot exceeds, rad/s at its own shaft: 95 000 rpm, above the fastest small brushless motors (assumption,
/// within a factor of 2). Bound of joints whose description has none, and of all motors.
pub const SPEED_MAX_RAD_PER_S: f64 = 1e4;

/// Change of a position between two samples that is always accepted, rad (m): above the resolution, noise and play of an
/// encoder (assumption, within a factor of 2).
const CHANGE_MIN_RAD: f64 = 0.2;

/// Ratio of the largest accepted speed to that of the description, whose values are nominal (assumption, within a factor of 3).
const SPEED_MARGIN: f64 = 10.0;

/// Positions and speeds that a joint can reach; samples beyond them are rejected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// Smallest accepted position, rad (m).
    lower: f64,
    /// Largest accepted position, rad (m).
    upper: f64,
    /// Largest accepted speed, rad/s (m/s).
    speed: f64,
}

impl Reach {
    /// Reach of a joint with the limits of its description, rad and rad/s (m and m/s). A position may exceed its limits by their
    /// distance, for encoders whose zero is not calibrated; the speed may be ten times its limit. Limits of 0 or without
    /// end are none.
    pub fn new(lower: f64, upper: f64, speed: f64) -> Self {
        let range = upper - lower;
        let (lower, upper) = match range > 0.0 && range.is_finite() {
            true => (lower - range, upper + range),
            false => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let speed = match speed > 0.0 && speed.is_finite() {
            true => (SPEED_MARGIN * speed).min(SPEED_MAX_RAD_PER_S),
            false => SPEED_MAX_RAD_PER_S,
        };
        Self {
            lower,
            upper,
            speed,
        }
    }

    /// Whether `position` is reachable from `last`, `dt_s` before; NaN: nothing is known of it.
    fn includes(&self, position: f64, last: f64, dt_s: f64) -> bool {
        // Only a true comparison is beyond reach: NaN is checked elsewhere.
        !(position < self.lower
            || position > self.upper
            || (position - last).abs() > CHANGE_MIN_RAD + self.speed * dt_s)
    }
}

/// Measured values of a robot at one time. Slices have one entry per axis, NaN for missing values; slices that the
/// observer does not need may be empty. A [`FeatureObserver`] needs motor torques, though all may be NaN.
#[derive(Debug, Clone, Copy)]
pub struct RobotSample<'a> {
    /// Time by any clock that only rises, ns.
    pub time_ns: i64,
    /// Number of the segment; a new number re-initialises the observer.
    pub segment: u32,
    /// Joint position, rad.
    pub q: &'a [f64],
    /// Motor position reflected to the joint, as measured, rad; of a tendon with a [`Routing`](crate::tendons::Routing) that of its
    /// motor, as its encoder measures it.
    pub theta: &'a [f64],
    /// Joint velocity, rad/s.
    pub dq: &'a [f64],
    /// Measured elastic torque, N·m.
    pub tau_el: &'a [f64],
    /// Motor torque reflected to the joint, N·m; of a tendon with a routing that at the shaft of its motor.
    pub tau_m: &'a [f64],
    /// Known external torque, N·m.
    pub tau_ext: &'a [f64],
    /// Tension of the tendon by its sensor, N; empty where there is none.
    pub tension: &'a [f64],
    /// Temperature of the robot, °C.
    pub temperature_c: f64,
}

/// Observer that a feeder steps.
pub trait FrameObserver {
    /// Result of one step.
    type Output;

    /// Returns the inputs that the observer needs in addition to positions.
    fn needs(&self) -> Needs;

    /// The next step is a start.
    fn reset(&mut self);

    /// Steps by `dt_s` to a sample.
    ///
    /// # Errors
    /// Returns a [`StepError`]; the state is then unchanged.
    fn step(&mut self, dt_s: f64, input: &Input<'_>) -> Result<Self::Output, StepError>;
}

/// Inputs that an observer needs in addition to positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    /// Recorded joint velocities.
    pub velocity: bool,
    /// Source of the elastic torque; [`TorqueSource::Observer`] needs no measured torque.
    pub torque: TorqueSource,
}

/// A sample as an observer takes it.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// Positions and further inputs of the observer.
    pub sample: Sample<'a>,
    /// Motor torque, `n`, N·m; NaN if it is not recorded.
    pub motor_torque: &'a [f64],
    /// Tension, `n` or empty, N; NaN if it is not recorded.
    pub tension: &'a [f64],
    /// Temperature, °C; NaN if it is not recorded.
    pub temperature_c: f64,
}

impl FrameObserver for OffsetObserver {
    type Output = ();

    fn needs(&self) -> Needs {
        Needs {
            velocity: self.config().velocity == VelocityFilter::Recorded,
            torque: self.config().source,
        }
    }

    fn reset(&mut self) {
        self.reset();
    }

    fn step(&mut self, dt_s: f64, input: &Input<'_>) -> Result<(), StepError> {
        self.step(dt_s, &input.sample)
    }
}

/// Whether a block is complete.
impl FrameObserver for FeatureObserver {
    type Output = bool;

    fn needs(&self) -> Needs {
        Needs {
            velocity: false,
            torque: TorqueSource::Observer,
        }
    }

    fn reset(&mut self) {
        self.reset();
    }

    fn step(&mut self, dt_s: f64, input: &Input<'_>) -> Result<bool, StepError> {
        let Sample {
            q, theta_measured, ..
        } = input.sample;
        self.step_with_tension(
            dt_s,
            [q, theta_measured],
            [input.motor_torque, input.tension],
            input.temperature_c,
        )
    }
}

/// Treatment of a sample without an elastic joint's motor position. The two modes differ because a block of features
/// couples all joints in one equation, whereas the paper's estimate treats each joint independently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MissingMotor {
    /// The sample is rejected for all joints.
    Reject,
    /// The sample is rejected for up to 0.1 s. Then the joint is excluded: its last position is held and the other
    /// joints continue. When the motor position returns, the joint settles for `settling_s`.
    Bridge {
        /// Time the observer needs to settle, s.
        settling_s: f64,
    },
}

/// How samples are fed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeederOptions {
    /// Gap limit: a longer pause re-initialises the observer, s.
    pub gap_s: f64,
    /// Whether the recorded external torque is used as a measurement.
    pub tau_ext: bool,
    /// Treatment of a missing motor position.
    pub missing_motor: MissingMotor,
}

impl Default for FeederOptions {
    /// Every joint's motor position is needed; recordings are cut at gaps of the same length by default.
    fn default() -> Self {
        Self {
            gap_s: GAP_S,
            tau_ext: false,
            missing_motor: MissingMotor::Reject,
        }
    }
}

/// Outcome of passing a sample to the observer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeedOutcome<T> {
    /// The observer used the sample.
    Accepted(T),
    /// The observer used the sample as its first one: at the start, after a gap, in a new segment.
    Restarted(T),
    /// The sample was rejected; observer and clock are unchanged.
    Rejected(RejectionReason),
}

impl<T> FeedOutcome<T> {
    /// Returns the output of the step, if the sample was accepted.
    pub fn output(self) -> Option<T> {
        match self {
            Self::Accepted(output) | Self::Restarted(output) => Some(output),
            Self::Rejected(_) => None,
        }
    }
}

/// Reason for the rejection of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RejectionReason {
    /// A joint position is missing or not finite.
    JointPosition,
    /// A joint velocity is missing or not finite.
    JointVelocity,
    /// An elastic joint's motor position is missing or not finite.
    MotorPosition,
    /// An elastic joint's measured torque is missing or not finite.
    Torque,
    /// An external torque is missing or not finite.
    ExternalTorque,
    /// The time stamp is not after that of the last accepted sample, or too far ahead.
    TimeStep,
    /// A value is implausibly large, beyond the [`Reach`] of its joint or not reachable since the last accepted sample, or the number
    /// of joints differs.
    Range,
}

/// Maximum time without motor position that is bridged before the joint is excluded until the position returns, ns.
/// Samples without it are skipped and the filters step over them, which is exact for a motion that is linear in time
/// over the gap.
const BRIDGE_NS: i64 = 100_000_000;

/// One joint's motor side.
#[derive(Debug, Clone)]
struct Motor {
    elastic: bool,
    /// Last time it was there.
    seen_ns: Option<i64>,
    /// The position has been missing for too long to bridge: the last position is held.
    held: bool,
    settled_at_ns: i64,
    /// Reach of the joint of the axis.
    reach: Reach,
    /// Last accepted positions of joint and motor as measured, rad; NaN before.
    last: [f64; 2],
}

/// Feeds samples to an observer, which it owns.
#[derive(Debug, Clone)]
pub struct Feeder<O> {
    observer: O,
    options: FeederOptions,
    gap_ns: i64,
    motors: Vec<Motor>,
    /// Motor positions as passed to the observer, rad.
    theta: Vec<f64>,
    /// Routings of tendons that cross several joints.
    routes: Option<Routings>,
    /// Motor torques as passed to the observer, N·m; unused without routings.
    tau_m: Vec<f64>,
    /// Offsets to add: joint, from this time since the start on, ns, and rad.
    injections: Vec<(usize, i64, f64)>,
    start_ns: Option<i64>,
    /// Time of the last sample the observer took; `None`: the next is a start.
    accepted_ns: Option<i64>,
    segment: Option<u32>,
    segments: u32,
}

impl<O: FrameObserver> Feeder<O> {
    /// A feeder of `observer`. Joints without a transmission are rigid. All memory is allocated here.
    pub fn new(
        observer: O,
        transmissions: &[Option<Transmission>],
        options: FeederOptions,
    ) -> Self {
        let motors = transmissions.iter().map(|transmission| Motor {
            elastic: transmission.is_some(),
            seen_ns: None,
            held: false,
            settled_at_ns: i64::MIN,
            reach: Reach::new(0.0, 0.0, 0.0),
            last: [f64::NAN; 2],
        });
        Self {
            observer,
            options,
            gap_ns: (options.gap_s * 1e9) as i64,
            motors: motors.collect(),
            theta: alloc::vec![0.0; transmissions.len()],
            routes: Routings::of(transmissions),
            tau_m: alloc::vec![f64::NAN; transmissions.len()],
            injections: Vec::new(),
            start_ns: None,
            accepted_ns: None,
            segment: None,
            segments: 0,
        }
    }

    /// Sets what the joints can reach, in their order; further joints keep the bound of [`SPEED_MAX_RAD_PER_S`].
    #[must_use]
    pub fn with_reach(mut self, reach: impl IntoIterator<Item = Reach>) -> Self {
        for (motor, reach) in self.motors.iter_mut().zip(reach) {
            motor.reach = reach;
        }
        self
    }

    /// Adds `offset_rad` to a joint's motor position from `from_ns` since the start on, as the paper does to see it found
    /// again. Allocates.
    pub fn inject(&mut self, joint: usize, from_ns: i64, offset_rad: f64) {
        self.injections.push((joint, from_ns, offset_rad));
    }

    /// When the recording began that injections count from; otherwise with the first sample.
    pub fn set_start(&mut self, time_ns: i64) {
        self.start_ns = Some(time_ns);
    }

    /// Takes the next sample.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock, apart from the observer's step.
    pub fn take(&mut self, reading: &RobotSample<'_>) -> FeedOutcome<O::Output> {
        let start_ns = *self.start_ns.get_or_insert(reading.time_ns);
        let since_start_ns = reading.time_ns.saturating_sub(start_ns);
        if self.segment != Some(reading.segment) {
            self.segment = Some(reading.segment);
            self.segments = self.segments.saturating_add(1);
            self.restart();
        }
        match self.feed(reading, since_start_ns) {
            Ok(fed) => fed,
            Err(reason) => FeedOutcome::Rejected(reason),
        }
    }

    /// The next sample is a start, as after a gap.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn restart(&mut self) {
        self.observer.reset();
        self.accepted_ns = None;
        for motor in &mut self.motors {
            motor.held = false;
            motor.seen_ns = None;
            motor.settled_at_ns = i64::MIN;
            motor.last = [f64::NAN; 2];
        }
    }

    fn feed(
        &mut self,
        reading: &RobotSample<'_>,
        since_start_ns: i64,
    ) -> Result<FeedOutcome<O::Output>, RejectionReason> {
        let needs = self.observer.needs();
        self.check(reading, needs)?;
        self.check_reach(reading)?;
        self.read_motors(reading, since_start_ns)?;
        if self.is_after_gap(reading) {
            self.restart();
        }
        let since = |t: i64| reading.time_ns.saturating_sub(t) as f64 * 1e-9;
        let dt_s = self.accepted_ns.map_or(0.0, since);
        let torque_from = |source| needs.torque == source;
        let tau_m = match &self.routes {
            Some(routes) if reading.tau_m.len() == self.tau_m.len() => {
                let torques = self.tau_m.iter_mut().zip(reading.tau_m).enumerate();
                for (i, (to, torque)) in torques {
                    *to = torque / routes.drive_ratio(i);
                }
                &self.tau_m
            }
            _ => reading.tau_m,
        };
        let input = Input {
            sample: Sample {
                q: reading.q,
                theta_measured: &self.theta,
                dq: needs.velocity.then_some(reading.dq),
                tau_el: torque_from(TorqueSource::TorqueSensor).then_some(reading.tau_el),
                tau_m: torque_from(TorqueSource::Motor).then_some(tau_m),
                tau_ext: self.options.tau_ext.then_some(reading.tau_ext),
            },
            motor_torque: tau_m,
            tension: reading.tension,
            temperature_c: reading.temperature_c,
        };
        let output = self
            .observer
            .step(dt_s, &input)
            .map_err(|error| match error {
                StepError::TimeStep => RejectionReason::TimeStep,
                StepError::Length
                | StepError::NotFinite
                | StepError::NotPositiveDefinite { .. }
                | StepError::Spring { .. }
                | StepError::UnknownLink => RejectionReason::Range,
            })?;
        for i in 0..self.motors.len() {
            let position = [reading.q.get(i).copied(), self.measured(reading, i)];
            let Some(motor) = self.motors.get_mut(i) else {
                continue;
            };
            for (last, position) in motor.last.iter_mut().zip(position) {
                *last = position.filter(|p| p.is_finite()).unwrap_or(*last);
            }
        }
        Ok(match self.accepted_ns.replace(reading.time_ns) {
            Some(_) => FeedOutcome::Accepted(output),
            None => FeedOutcome::Restarted(output),
        })
    }

    /// Whether the last accepted sample is longer ago than the gap limit.
    fn is_after_gap(&self, reading: &RobotSample<'_>) -> bool {
        let is_gap = |t: i64| reading.time_ns.saturating_sub(t) > self.gap_ns;
        self.accepted_ns.is_some_and(is_gap)
    }

    /// Position of the motor of axis `i`; tendons may share a motor.
    fn measured(&self, reading: &RobotSample<'_>, i: usize) -> Option<f64> {
        let routes = self.routes.as_ref();
        let axis = routes.map_or(i, |routes| routes.motor_axis(i));
        reading.theta.get(axis).copied()
    }

    /// Checks that the positions are reachable since the last accepted sample. At a start, and after a gap, only the range is checked.
    fn check_reach(&self, reading: &RobotSample<'_>) -> Result<(), RejectionReason> {
        let from_ns = match self.is_after_gap(reading) {
            true => None,
            false => self.accepted_ns,
        };
        let dt_s = from_ns.map_or(f64::INFINITY, |t| {
            reading.time_ns.saturating_sub(t).max(0) as f64 * 1e-9
        });
        let of_motor = Reach::new(0.0, 0.0, 0.0);
        let mut motors = self.motors.iter().zip(reading.q).enumerate();
        let is_reachable = motors.all(|(i, (motor, q))| {
            let [last_q, last_theta] = motor.last;
            // A missing motor position is not beyond reach.
            let theta = self.measured(reading, i);
            let theta = theta.filter(|theta| motor.elastic && theta.is_finite());
            motor.reach.includes(*q, last_q, dt_s)
                && theta.is_none_or(|theta| of_motor.includes(theta, last_theta, dt_s))
        });
        match is_reachable {
            true => Ok(()),
            false => Err(RejectionReason::Range),
        }
    }

    /// Checks that a sample has all inputs except motor positions.
    fn check(&self, reading: &RobotSample<'_>, needs: Needs) -> Result<(), RejectionReason> {
        let lacks = |x: &[f64]| x.iter().any(|v| !v.is_finite());
        let n = self.motors.len();
        if reading.q.len() != n || reading.theta.len() != n {
            return Err(RejectionReason::Range);
        }
        if lacks(reading.q) {
            return Err(RejectionReason::JointPosition);
        }
        if needs.velocity && lacks(reading.dq) {
            return Err(RejectionReason::JointVelocity);
        }
        if self.options.tau_ext && lacks(reading.tau_ext) {
            return Err(RejectionReason::ExternalTorque);
        }
        let torque = match needs.torque {
            TorqueSource::Observer => return Ok(()),
            TorqueSource::TorqueSensor => reading.tau_el,
            TorqueSource::Motor => reading.tau_m,
        };
        let mut motors = self.motors.iter().zip(torque);
        match motors.any(|(motor, torque)| motor.elastic && !torque.is_finite()) {
            true => Err(RejectionReason::Torque),
            false => Ok(()),
        }
    }

    /// Writes the motor positions for the observer to `theta`.
    fn read_motors(
        &mut self,
        reading: &RobotSample<'_>,
        since_start_ns: i64,
    ) -> Result<(), RejectionReason> {
        let now_ns = reading.time_ns;
        let rejects = |motor: &Motor| match self.options.missing_motor {
            MissingMotor::Reject => true,
            MissingMotor::Bridge { .. } => motor
                .seen_ns
                .is_some_and(|t| now_ns.saturating_sub(t) <= BRIDGE_NS),
        };
        // Tendons may share a motor.
        let routes = self.routes.as_ref();
        let measured = |i: usize| {
            let axis = routes.map_or(i, |routes| routes.motor_axis(i));
            reading.theta.get(axis).copied().unwrap_or(f64::NAN)
        };
        let mut motors = self.motors.iter().enumerate();
        if motors.any(|(i, motor)| motor.elastic && !measured(i).is_finite() && rejects(motor)) {
            return Err(RejectionReason::MotorPosition);
        }
        let settling_ns = match self.options.missing_motor {
            MissingMotor::Reject => 0,
            MissingMotor::Bridge { settling_s } => (settling_s * 1e9) as i64,
        };
        let motors = self.motors.iter_mut().zip(&mut self.theta);
        for (i, ((motor, fed), q)) in motors.zip(reading.q).enumerate() {
            let theta = if motor.elastic { measured(i) } else { *q };
            if !theta.is_finite() {
                motor.held = true;
                continue;
            }
            if motor.held {
                motor.held = false;
                motor.settled_at_ns = now_ns.saturating_add(settling_ns);
            }
            motor.seen_ns = Some(now_ns);
            *fed = match routes {
                Some(routes) if motor.elastic => {
                    let others = routes.moved_by_others(i, reading.q.iter().copied());
                    routes.drive_ratio(i) * theta - others
                }
                _ => theta,
            };
            for (_, _, offset_rad) in self
                .injections
                .iter()
                .filter(|(joint, from_ns, _)| *joint == i && since_start_ns >= *from_ns)
            {
                *fed += offset_rad;
            }
        }
        Ok(())
    }

    /// The observer, after the last sample it took.
    pub fn observer(&self) -> &O {
        &self.observer
    }

    /// Latest motor positions passed to the observer, including injected offsets, `n`, rad; for a tendon that crosses
    /// other joints, without the part that these joints cause.
    pub fn theta(&self) -> &[f64] {
        &self.theta
    }

    /// Time of the first sample, ns.
    pub fn start_ns(&self) -> Option<i64> {
        self.start_ns
    }

    /// Segments so far.
    pub fn segments(&self) -> u32 {
        self.segments
    }

    /// Whether a joint's motor position has been missing for so long that its last one is held.
    pub fn is_held(&self, joint: usize) -> bool {
        self.motors.get(joint).is_some_and(|motor| motor.held)
    }

    /// Whether a joint has settled since its motor position returned.
    pub fn is_joint_settled(&self, joint: usize) -> bool {
        let motor = self.motors.get(joint);
        motor.is_some_and(|motor| self.accepted_ns >= Some(motor.settled_at_ns))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes its steps down.
    #[derive(Debug)]
    struct Steps {
        needs: Needs,
        dt_s: Vec<f64>,
    }

    impl FrameObserver for Steps {
        type Output = ();

        fn needs(&self) -> Needs {
            self.needs
        }

        fn reset(&mut self) {
            self.dt_s.clear();
        }

        fn step(&mut self, dt_s: f64, _: &Input<'_>) -> Result<(), StepError> {
            self.dt_s.push(dt_s);
            Ok(())
        }
    }

    /// Returns a feeder with two joints, the second of them elastic.
    fn feeder(velocity: bool, torque: TorqueSource, tau_ext: bool) -> Feeder<Steps> {
        let observer = Steps {
            needs: Needs { velocity, torque },
            dt_s: Vec::new(),
        };
        let options = FeederOptions {
            tau_ext,
            ..FeederOptions::default()
        };
        Feeder::new(observer, &[None, Some(Transmission::spring(40.0))], options)
    }

    /// A sample every millisecond, all there.
    fn whole(ms: i64) -> RobotSample<'static> {
        const ALL: &[f64] = &[0.1, 0.2];
        RobotSample {
            time_ns: ms * 1_000_000,
            segment: 1,
            q: ALL,
            theta: ALL,
            dq: ALL,
            tau_el: ALL,
            tau_m: ALL,
            tau_ext: ALL,
            tension: &[],
            temperature_c: 23.0,
        }
    }

    type Lacks = fn(RobotSample<'static>, &'static [f64]) -> RobotSample<'static>;

    const LACKS: [(RejectionReason, Lacks); 5] = [
        (RejectionReason::JointPosition, |r, q| RobotSample {
            q,
            ..r
        }),
        (RejectionReason::JointVelocity, |r, dq| RobotSample {
            dq,
            ..r
        }),
        (RejectionReason::MotorPosition, |r, theta| RobotSample {
            theta,
            ..r
        }),
        (RejectionReason::Torque, |r, tau_el| RobotSample {
            tau_el,
            ..r
        }),
        (RejectionReason::ExternalTorque, |r, tau_ext| RobotSample {
            tau_ext,
            ..r
        }),
    ];

    #[test]
    fn missing_input_named_and_stepped_over() {
        const BAD: [&[f64]; 2] = [&[0.1, f64::NAN], &[0.1, f64::INFINITY]];
        for (reason, lacks) in LACKS {
            for bad in BAD {
                let mut feeder = feeder(true, TorqueSource::TorqueSensor, true);
                assert_eq!(feeder.take(&whole(0)), FeedOutcome::Restarted(()));
                assert_eq!(
                    feeder.take(&lacks(whole(1), bad)),
                    FeedOutcome::Rejected(reason)
                );
                assert_eq!(feeder.take(&whole(2)), FeedOutcome::Accepted(()));
                assert_eq!(feeder.observer().dt_s, [0.0, 2e-3], "{reason:?}");
            }
        }
    }

    #[test]
    fn unneeded_inputs_may_be_missing() {
        let needed = [
            RejectionReason::JointPosition,
            RejectionReason::MotorPosition,
        ];
        for (reason, lacks) in LACKS {
            let mut feeder = feeder(false, TorqueSource::Observer, false);
            let fed = feeder.take(&lacks(whole(0), &[0.1, f64::NAN]));
            match needed.contains(&reason) {
                true => assert_eq!(fed, FeedOutcome::Rejected(reason)),
                false => assert_eq!(fed, FeedOutcome::Restarted(()), "{reason:?}"),
            }
        }
        // Nor does a rigid joint need a motor's position and torque.
        let mut feeder = feeder(true, TorqueSource::TorqueSensor, true);
        let none = &[f64::NAN, 0.2];
        let reading = RobotSample {
            theta: none,
            tau_el: none,
            ..whole(0)
        };
        assert_eq!(feeder.take(&reading), FeedOutcome::Restarted(()));
        assert_eq!(feeder.theta(), [0.1, 0.2]);
    }

    /// The joint settles 0.5 s after its motor position returns.
    #[test]
    fn joint_settles_for_specified_time() {
        let observer = Steps {
            needs: Needs {
                velocity: false,
                torque: TorqueSource::Observer,
            },
            dt_s: Vec::new(),
        };
        let options = FeederOptions {
            missing_motor: MissingMotor::Bridge { settling_s: 0.5 },
            ..FeederOptions::default()
        };
        let springs = [None, Some(Transmission::spring(40.0))];
        let mut feeder = Feeder::new(observer, &springs, options);
        let mut settled_ms = Vec::new();
        for ms in 0..2_000 {
            let lacks = (300..600).contains(&ms);
            let theta: &[f64] = if lacks { &[0.1, f64::NAN] } else { &[0.1, 0.2] };
            let reading = RobotSample { theta, ..whole(ms) };
            let _rejected_at_first = feeder.take(&reading);
            if ms >= 600 && feeder.is_joint_settled(1) {
                settled_ms.push(ms);
            }
        }
        assert_eq!(settled_ms.first(), Some(&1_100));
    }
}
