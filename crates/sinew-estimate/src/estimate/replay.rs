//! Frame by frame through the estimator, with a tally of what could be used.

use super::result::{Injection, Loss, Series};
use super::series::{Point, SeriesBuilder};
use super::tally::Tally;
use sinew_log::Frame;
use sinew_model::StepError;
use sinew_model::offset::{OffsetObserver, Sample, TorqueSource, VelocityFilter};
use sinew_model::transmission::Transmission;

/// Why a frame gave a joint no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reason {
    Settling,
    JointPosition,
    JointVelocity,
    MotorPosition,
    Torque,
    ExternalTorque,
    Range,
}

impl Reason {
    const COUNT: usize = 7;
    const ALL: [Self; Self::COUNT] = [
        Self::Settling,
        Self::JointPosition,
        Self::JointVelocity,
        Self::MotorPosition,
        Self::Torque,
        Self::ExternalTorque,
        Self::Range,
    ];

    fn text(self) -> &'static str {
        match self {
            Self::Settling => "settling after the start, a gap or missing samples",
            Self::JointPosition => "a joint position missing or not finite",
            Self::JointVelocity => "a joint velocity missing or not finite",
            Self::MotorPosition => "motor position missing or not finite",
            Self::Torque => "measured torque missing or not finite",
            Self::ExternalTorque => "external torque missing or not finite",
            Self::Range => "a value too large to be one",
        }
    }
}

/// Frames lost, by reason.
#[derive(Debug, Clone, Copy, Default)]
struct Losses([u64; Reason::COUNT]);

impl Losses {
    fn count(&mut self, reason: Reason) {
        self.0[reason as usize] += 1;
    }

    fn list(&self, frames: u64) -> Vec<Loss> {
        Reason::ALL
            .iter()
            .zip(self.0)
            .filter(|(_, n)| *n > 0)
            .map(|(reason, n)| Loss {
                reason: reason.text().to_string(),
                frames: n,
                share: n as f64 / frames.max(1) as f64,
            })
            .collect()
    }
}

/// One joint's way through the recording.
#[derive(Debug)]
struct Joint {
    stiffness: Option<f64>,
    /// Offsets to add: from this time since the start (ns), rad.
    injections: Vec<(i64, f64)>,
    theta: f64,
    theta_at_ns: Option<i64>,
    /// The motor position has been missing for too long to bridge: the last one is held.
    lost: bool,
    settled_at_ns: i64,
    delta_e: Tally,
    tau_el: Tally,
    series: SeriesBuilder,
    losses: Losses,
}

/// What a joint's way comes to.
#[derive(Debug)]
pub(super) struct JointSummary {
    pub(super) delta_e: Tally,
    pub(super) tau_el: Tally,
    pub(super) series: Series,
    pub(super) losses: Vec<Loss>,
}

/// One frame's outcome for `--csv`.
#[derive(Debug)]
pub(super) struct FrameOutcome<'a> {
    pub(super) time_ns: i64,
    pub(super) since_start_ns: i64,
    pub(super) delta_e: &'a [f64],
    pub(super) tau_el: &'a [f64],
    pub(super) usable: &'a [bool],
}

/// The way of a recording through the estimator.
pub(super) struct Replay {
    observer: OffsetObserver,
    use_tau_ext: bool,
    gap_ns: i64,
    settling_ns: i64,
    joints: Vec<Joint>,
    theta: Vec<f64>,
    usable: Vec<bool>,
    frames: u64,
    losses: Losses,
    start_ns: i64,
    last_ns: i64,
    /// Time of the last frame the estimator took.
    taken_ns: Option<i64>,
    segment: u32,
    segments: u32,
    intervals: IntervalSample,
}

/// The motor position may be missing for this long before the joint is given up until it comes
/// back: frames without it are left out and the filters step over them, which is exact for a
/// motion that is straight over the gap.
const BRIDGE_NS: i64 = 100_000_000;

impl Replay {
    pub(super) fn new(
        observer: OffsetObserver,
        transmissions: &[Option<Transmission>],
        joint_names: &[String],
        injections: &[Injection],
        use_tau_ext: bool,
        gap_s: f64,
    ) -> Self {
        let joints = transmissions
            .iter()
            .zip(joint_names)
            .map(|(t, name)| Joint {
                stiffness: t.as_ref().map(|t| t.stiffness_nm_per_rad),
                injections: injections
                    .iter()
                    .filter(|i| i.joint == *name)
                    .map(|i| {
                        let from = i.from_s.map_or(i64::MIN, |s| (s * 1e9) as i64);
                        (from, i.offset_rad)
                    })
                    .collect(),
                theta: 0.0,
                theta_at_ns: None,
                lost: false,
                settled_at_ns: i64::MIN,
                delta_e: Tally::new(),
                tau_el: Tally::new(),
                series: SeriesBuilder::new(),
                losses: Losses::default(),
            })
            .collect::<Vec<_>>();
        let n = joints.len();
        Self {
            settling_ns: (observer.settling_time_s() * 1e9) as i64,
            observer,
            use_tau_ext,
            gap_ns: (gap_s * 1e9) as i64,
            joints,
            theta: vec![0.0; n],
            usable: vec![false; n],
            frames: 0,
            losses: Losses::default(),
            start_ns: 0,
            last_ns: 0,
            taken_ns: None,
            segment: 0,
            segments: 0,
            intervals: IntervalSample::default(),
        }
    }

    /// Takes one frame.
    pub(super) fn frame(&mut self, frame: &Frame) -> FrameOutcome<'_> {
        if self.frames == 0 {
            self.start_ns = frame.time_ns;
        }
        if self.frames == 0 || frame.segment != self.segment {
            self.segment = frame.segment;
            self.segments += 1;
            self.restart();
        } else {
            self.intervals.add(frame.time_ns - self.last_ns);
        }
        self.frames += 1;
        self.last_ns = frame.time_ns;
        self.usable.fill(false);
        match self.take(frame) {
            Ok(()) => self.tally(frame),
            Err((reason, joint)) => self.lose(frame, reason, joint),
        }
        FrameOutcome {
            time_ns: frame.time_ns,
            since_start_ns: frame.time_ns - self.start_ns,
            delta_e: self.observer.delta_e(),
            tau_el: self.observer.tau_el(),
            usable: &self.usable,
        }
    }

    /// Starts the estimator anew.
    fn restart(&mut self) {
        self.observer.reset();
        self.taken_ns = None;
        for joint in &mut self.joints {
            joint.lost = false;
            joint.theta_at_ns = None;
            joint.settled_at_ns = i64::MIN;
        }
    }

    /// Checks the frame and steps the estimator; says why not, and for which joint if only one.
    fn take(&mut self, frame: &Frame) -> Result<(), (Reason, Option<usize>)> {
        let config = *self.observer.config();
        let bad = |x: &[f64]| x.iter().position(|v| !v.is_finite());
        if bad(&frame.q).is_some() {
            return Err((Reason::JointPosition, None));
        }
        if config.velocity == VelocityFilter::Recorded && bad(&frame.dq).is_some() {
            return Err((Reason::JointVelocity, None));
        }
        if self.use_tau_ext && bad(&frame.tau_ext).is_some() {
            return Err((Reason::ExternalTorque, None));
        }
        let measured = match config.source {
            TorqueSource::Observer => None,
            TorqueSource::TorqueSensor => Some(&frame.tau_el),
            TorqueSource::Motor => Some(&frame.tau_m),
        };
        if let Some(tau) = measured
            && self
                .joints
                .iter()
                .zip(tau)
                .any(|(j, tau)| j.stiffness.is_some() && !tau.is_finite())
        {
            return Err((Reason::Torque, None));
        }
        self.motor_positions(frame)?;
        if self
            .taken_ns
            .is_some_and(|t| frame.time_ns - t > self.gap_ns)
        {
            self.restart();
        }
        let dt_s = self
            .taken_ns
            .map_or(0.0, |t| (frame.time_ns - t) as f64 * 1e-9);
        let sample = Sample {
            q: &frame.q,
            theta_measured: &self.theta,
            dq: (config.velocity == VelocityFilter::Recorded).then_some(&frame.dq),
            tau_el: (config.source == TorqueSource::TorqueSensor).then_some(&frame.tau_el),
            tau_m: (config.source == TorqueSource::Motor).then_some(&frame.tau_m),
            tau_ext: self.use_tau_ext.then_some(&frame.tau_ext),
        };
        match self.observer.step(dt_s, &sample) {
            Ok(()) => {
                self.taken_ns = Some(frame.time_ns);
                Ok(())
            }
            Err(StepError::TimeStep) => Err((Reason::Settling, None)),
            Err(_) => Err((Reason::Range, None)),
        }
    }

    /// Fills `theta` with what the estimator gets.
    fn motor_positions(&mut self, frame: &Frame) -> Result<(), (Reason, Option<usize>)> {
        let since_start_ns = frame.time_ns - self.start_ns;
        for (i, (joint, theta)) in self.joints.iter().zip(&frame.theta).enumerate() {
            let short = |t: i64| frame.time_ns - t <= BRIDGE_NS;
            if joint.stiffness.is_some()
                && !theta.is_finite()
                && joint.theta_at_ns.is_some_and(short)
            {
                return Err((Reason::MotorPosition, Some(i)));
            }
        }
        for ((joint, theta), slot) in self
            .joints
            .iter_mut()
            .zip(&frame.theta)
            .zip(&mut self.theta)
        {
            if theta.is_finite() {
                if joint.lost {
                    joint.lost = false;
                    joint.settled_at_ns = frame.time_ns + self.settling_ns;
                }
                joint.theta = *theta;
                joint.theta_at_ns = Some(frame.time_ns);
                for &(from, offset) in &joint.injections {
                    if since_start_ns >= from {
                        joint.theta += offset;
                    }
                }
            } else {
                joint.lost = true;
            }
            *slot = joint.theta;
        }
        Ok(())
    }

    /// Counts a frame the estimator took.
    fn tally(&mut self, frame: &Frame) {
        let since_start_ns = frame.time_ns - self.start_ns;
        let settled = self.observer.is_settled();
        let mut any = None;
        let outputs = self
            .observer
            .delta_e()
            .iter()
            .zip(self.observer.tau_el())
            .zip(self.observer.deflection());
        for (((joint, usable), q), ((delta_e, tau_el), deflection)) in self
            .joints
            .iter_mut()
            .zip(&mut self.usable)
            .zip(&frame.q)
            .zip(outputs)
        {
            let Some(stiffness) = joint.stiffness else {
                continue;
            };
            let reason = if joint.lost {
                Some(Reason::MotorPosition)
            } else if !settled || frame.time_ns < joint.settled_at_ns {
                Some(Reason::Settling)
            } else {
                None
            };
            *usable = reason.is_none();
            match reason {
                None => {
                    joint.delta_e.add(*delta_e);
                    joint.tau_el.add(*tau_el);
                }
                Some(reason) => {
                    joint.losses.count(reason);
                    any = any.or(Some(reason));
                }
            }
            joint.series.add(
                since_start_ns,
                Point {
                    delta_e: *delta_e,
                    tau_el: *tau_el,
                    tau_spring: stiffness * deflection,
                    q: *q,
                    usable: *usable,
                },
            );
        }
        if !self.usable.iter().any(|u| *u)
            && let Some(reason) = any
        {
            self.losses.count(reason);
        }
    }

    /// Counts a frame the estimator did not take.
    fn lose(&mut self, frame: &Frame, reason: Reason, _joint: Option<usize>) {
        let since_start_ns = frame.time_ns - self.start_ns;
        self.losses.count(reason);
        for (joint, q) in self.joints.iter_mut().zip(&frame.q) {
            if joint.stiffness.is_none() {
                continue;
            }
            joint.losses.count(reason);
            if q.is_finite() {
                joint.series.add(
                    since_start_ns,
                    Point {
                        delta_e: f64::NAN,
                        tau_el: f64::NAN,
                        tau_spring: f64::NAN,
                        q: *q,
                        usable: false,
                    },
                );
            }
        }
    }

    pub(super) fn frames(&self) -> u64 {
        self.frames
    }

    pub(super) fn start_ns(&self) -> i64 {
        self.start_ns
    }

    pub(super) fn duration_s(&self) -> f64 {
        (self.last_ns - self.start_ns) as f64 * 1e-9
    }

    pub(super) fn segments(&self) -> u32 {
        self.segments
    }

    pub(super) fn rate_hz(&self) -> f64 {
        self.intervals.rate_hz()
    }

    /// Frames lost for every joint.
    pub(super) fn losses(&self) -> Vec<Loss> {
        self.losses.list(self.frames)
    }

    pub(super) fn finish(self) -> Vec<JointSummary> {
        let frames = self.frames;
        self.joints
            .into_iter()
            .map(|joint| JointSummary {
                losses: joint.losses.list(frames),
                series: joint.series.finish(),
                delta_e: joint.delta_e,
                tau_el: joint.tau_el,
            })
            .collect()
    }
}

/// Time between frames, from the first thousand.
#[derive(Debug, Default)]
struct IntervalSample(Vec<i64>);

impl IntervalSample {
    fn add(&mut self, interval_ns: i64) {
        if self.0.len() < 1000 {
            self.0.push(interval_ns);
        }
    }

    /// Median rate, or NaN with fewer than two frames.
    fn rate_hz(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_unstable();
        sorted
            .get(sorted.len() / 2)
            .map_or(f64::NAN, |&ns| 1e9 / ns as f64)
    }
}
