//! Processing of the frames of a recording by the estimator, with statistics of the used frames.

use super::result::{Loss, LossReason, Series};
use super::series::{Point, SeriesBuilder};
use super::tally::Tally;
use crate::feeder::{FeedOutcome, Feeder, FeederOptions, Injection, MissingMotor};
use sinew_log::Frame;
use sinew_model::offset::OffsetObserver;
use sinew_model::robot::Robot;
use sinew_model::transmission::Transmission;

/// Reasons of unused frames that are counted, in the order of the list.
const REASONS: [LossReason; 7] = [
    LossReason::Settling,
    LossReason::JointPosition,
    LossReason::JointVelocity,
    LossReason::MotorPosition,
    LossReason::Torque,
    LossReason::ExternalTorque,
    LossReason::Range,
];

/// Numbers of unused frames by reason.
#[derive(Debug, Clone, Copy, Default)]
struct Losses([u64; REASONS.len()]);

impl Losses {
    fn count(&mut self, reason: LossReason) {
        if let Some(at) = REASONS.iter().position(|r| *r == reason) {
            self.0[at] += 1;
        }
    }

    fn list(&self, frames: u64) -> Vec<Loss> {
        REASONS
            .iter()
            .zip(self.0)
            .filter(|(_, n)| *n > 0)
            .map(|(reason, n)| Loss {
                reason: *reason,
                frames: n,
                share: n as f64 / frames.max(1) as f64,
            })
            .collect()
    }
}

/// Accumulated statistics of one joint.
#[derive(Debug)]
struct Joint {
    stiffness: Option<f64>,
    delta_e: Tally,
    tau_el: Tally,
    series: SeriesBuilder,
    losses: Losses,
}

/// Summary of one joint after the last frame.
#[derive(Debug)]
pub(super) struct JointSummary {
    pub(super) delta_e: Tally,
    pub(super) tau_el: Tally,
    pub(super) series: Series,
    pub(super) losses: Vec<Loss>,
}

/// Estimates of one frame for `--csv`.
#[derive(Debug)]
pub(super) struct FrameOutcome<'a> {
    pub(super) time_ns: i64,
    pub(super) since_start_ns: i64,
    pub(super) delta_e: &'a [f64],
    pub(super) tau_el: &'a [f64],
    pub(super) usable: &'a [bool],
}

/// Estimator of the paper, applied to the frames of a recording.
pub(super) struct Replay {
    feeder: Feeder<OffsetObserver>,
    joints: Vec<Joint>,
    usable: Vec<bool>,
    frames: u64,
    losses: Losses,
    start_ns: i64,
    last_ns: i64,
    intervals: IntervalSample,
}

impl Replay {
    /// Creates a replay before the first frame. A joint without motor position is not used until it is available again;
    /// the other joints continue.
    pub(super) fn new(
        robot: &Robot,
        observer: OffsetObserver,
        transmissions: &[Option<Transmission>],
        injections: &[Injection],
        tau_ext: bool,
        gap_s: f64,
    ) -> Self {
        let joints = transmissions.iter().map(|t| Joint {
            stiffness: t.as_ref().map(|t| t.stiffness_nm_per_rad),
            delta_e: Tally::new(),
            tau_el: Tally::new(),
            series: SeriesBuilder::new(),
            losses: Losses::default(),
        });
        let options = FeederOptions {
            gap_s,
            tau_ext,
            missing_motor: MissingMotor::Bridge {
                settling_s: observer.settling_time_s(),
            },
        };
        Self {
            joints: joints.collect(),
            feeder: Feeder::new(observer, transmissions, options)
                .with_injections(robot, injections),
            usable: vec![false; transmissions.len()],
            frames: 0,
            losses: Losses::default(),
            start_ns: 0,
            last_ns: 0,
            intervals: IntervalSample::default(),
        }
    }

    /// Processes one frame, and returns its estimates.
    pub(super) fn frame(&mut self, frame: &Frame) -> FrameOutcome<'_> {
        if self.frames == 0 {
            self.start_ns = frame.time_ns;
        }
        let segments = self.feeder.segments();
        let fed = self.feeder.frame(frame);
        if self.feeder.segments() == segments {
            self.intervals.add(frame.time_ns - self.last_ns);
        }
        self.frames += 1;
        self.last_ns = frame.time_ns;
        self.usable.fill(false);
        match fed {
            FeedOutcome::Accepted(()) | FeedOutcome::Restarted(()) => self.tally(frame),
            FeedOutcome::Rejected(reason) => self.lose(frame, reason.into()),
        }
        FrameOutcome {
            time_ns: frame.time_ns,
            since_start_ns: frame.time_ns - self.start_ns,
            delta_e: self.feeder.observer().delta_e(),
            tau_el: self.feeder.observer().tau_el(),
            usable: &self.usable,
        }
    }

    /// Adds a frame that the estimator accepted to the statistics.
    fn tally(&mut self, frame: &Frame) {
        let since_start_ns = frame.time_ns - self.start_ns;
        let observer = self.feeder.observer();
        let settled = observer.is_settled();
        let mut any = None;
        let outputs = observer
            .delta_e()
            .iter()
            .zip(observer.tau_el())
            .zip(observer.deflection());
        for (i, (((joint, usable), q), ((delta_e, tau_el), deflection))) in self
            .joints
            .iter_mut()
            .zip(&mut self.usable)
            .zip(&frame.q)
            .zip(outputs)
            .enumerate()
        {
            let Some(stiffness) = joint.stiffness else {
                continue;
            };
            let reason = if self.feeder.is_held(i) {
                Some(LossReason::MotorPosition)
            } else if !settled || !self.feeder.is_joint_settled(i) {
                Some(LossReason::Settling)
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

    /// Counts a frame that the estimator rejected.
    fn lose(&mut self, frame: &Frame, reason: LossReason) {
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
        self.feeder.segments()
    }

    pub(super) fn rate_hz(&self) -> Option<f64> {
        self.intervals.rate_hz()
    }

    /// Numbers of frames that were not used for any joint, by reason.
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

/// Intervals between the first thousand frames, ns.
#[derive(Debug, Default)]
struct IntervalSample(Vec<i64>);

impl IntervalSample {
    fn add(&mut self, interval_ns: i64) {
        if self.0.len() < 1000 {
            self.0.push(interval_ns);
        }
    }

    /// Median frame rate, Hz; `None` with fewer than two frames.
    fn rate_hz(&self) -> Option<f64> {
        let mut sorted = self.0.clone();
        sorted.sort_unstable();
        sorted.get(sorted.len() / 2).map(|&ns| 1e9 / ns as f64)
    }
}
