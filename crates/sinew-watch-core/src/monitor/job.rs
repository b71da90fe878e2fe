//! Estimates, made away from the thread that takes frames.

use super::online::{OnlineMade, OnlineWork, Successor};
use super::session::Stretch;
use super::trend::{TrendMade, TrendWork};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{
    Learning, SessionEstimate, SessionOptions, Since, estimate_stretch, learn_recorded,
};
use sinew_model::robot::Robot;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// An estimate to make, away from the thread that takes frames. [`Job::run`] is the whole of it.
#[derive(Debug)]
pub struct Job {
    pub(super) robot: Arc<Robot>,
    pub(super) work: Work,
}

#[derive(Debug)]
pub(super) enum Work {
    Stretch(Box<StretchWork>),
    Online(Box<OnlineWork>),
    Trend(Box<TrendWork>),
}

/// What the estimate of a stretch needs.
#[derive(Debug)]
pub(super) struct StretchWork {
    pub(super) stretch: Stretch,
    pub(super) options: SessionOptions,
    /// Where the chain stands.
    pub(super) baseline: Option<Baseline>,
    /// How the stretch follows on it.
    pub(super) since: Since,
    /// The baseline that is learned from it.
    pub(super) learns: Option<Learns>,
    /// Name of the session.
    pub(super) name: String,
}

/// A baseline that is learned.
#[derive(Debug)]
pub(super) struct Learns {
    /// Joints whose ropes were tensioned.
    pub(super) tensioned: Vec<usize>,
    /// Whether it was begun before.
    pub(super) continues: bool,
}

/// What a [`Job`] gave, for [`Monitor::done`](crate::Monitor::done).
#[derive(Debug)]
pub struct Done(pub(super) Outcome);

#[derive(Debug)]
pub(super) enum Outcome {
    Stretch {
        stretch: Box<Stretch>,
        learned: bool,
        result: Result<Box<Estimated>, String>,
    },
    /// `None`: the estimator failed.
    Online(Option<Box<OnlineMade>>),
    Trend(TrendMade),
}

/// What a stretch gave.
#[derive(Debug)]
pub(super) struct Estimated {
    pub(super) estimate: SessionEstimate,
    pub(super) next: Baseline,
    /// An estimate of now that begins from there, after the last stretch of a session.
    pub(super) successor: Option<Successor>,
}

impl Job {
    /// Whether nothing is lost without it: a trend is of what is stored already, and the offsets of now are not stored.
    pub fn may_be_left_out(&self) -> bool {
        matches!(self.work, Work::Trend(_) | Work::Online(_))
    }

    /// Makes the estimate: some hundredths of a second for a few joints and a minute.
    ///
    /// A panic of the estimator is a refusal: a monitor that runs for a year must not end of one stretch.
    pub fn run(self) -> Done {
        let robot = self.robot;
        Done(match self.work {
            Work::Stretch(work) => {
                let result = catch_unwind(AssertUnwindSafe(|| work.estimate(&robot)));
                Outcome::Stretch {
                    learned: work.learns.is_some(),
                    stretch: Box::new(work.stretch),
                    result: result.unwrap_or_else(|_| Err("the estimator failed".into())),
                }
            }
            Work::Online(work) => {
                let made = catch_unwind(AssertUnwindSafe(|| Box::new(work.run())));
                Outcome::Online(made.ok())
            }
            Work::Trend(work) => {
                let made = catch_unwind(AssertUnwindSafe(|| work.run(&robot)));
                Outcome::Trend(made.unwrap_or_else(|_| work.nothing()))
            }
        })
    }
}

/// Names of recordings a chain keeps: the first and the last.
const NAMES: usize = 2;

impl StretchWork {
    fn estimate(&self, robot: &Arc<Robot>) -> Result<Box<Estimated>, String> {
        let recorded = &self.stretch.recorded;
        let before = self.baseline.as_ref();
        let known = before.map(|baseline| (baseline, "what was learned before"));
        let result = match &self.learns {
            Some(learns) => {
                let learning = Learning {
                    known,
                    motor_torque: self.options.motor_torque,
                    temperature_c: self.options.temperature_c,
                    tensioned: Some(&learns.tensioned),
                    continues: learns.continues,
                };
                learn_recorded(robot, recorded, &self.name, &learning)
                    .map(|(baseline, estimate)| (estimate, baseline))
            }
            None => estimate_stretch(
                robot,
                recorded,
                &self.name,
                (known, self.since),
                &self.options,
            ),
        };
        let result = result.and_then(|(mut estimate, mut next)| {
            // A chain of months names its first and its last recording.
            let count = next.recordings.len();
            if count > NAMES {
                next.recordings.drain(1..count - 1);
            }
            next.before.truncate(NAMES);
            estimate.blocks = Vec::new();
            let ends = self.stretch.end.is_some() || self.learns.is_some();
            let successor = ends.then(|| Successor::new(robot, &next, &self.options));
            Ok(Box::new(Estimated {
                estimate,
                successor: successor.transpose()?,
                next,
            }))
        });
        result.map_err(|error| error.to_string())
    }
}
