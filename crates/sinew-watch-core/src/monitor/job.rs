//! Estimation jobs, run outside the frame thread.

use super::online::{OnlineJob, OnlineResult, Successor};
use super::session::Segment;
use super::trend::{TrendJob, TrendResult};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{
    Learning, SessionEstimate, SessionOptions, Since, estimate_segment, learn_recorded,
};
use sinew_model::robot::Robot;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Estimate to make outside the frame thread, by [`QueuedJob::run`].
#[derive(Debug)]
pub struct QueuedJob {
    pub(super) robot: Arc<Robot>,
    pub(super) work: JobKind,
}

#[derive(Debug)]
pub(super) enum JobKind {
    Segment(Box<SegmentJob>),
    Online(Box<OnlineJob>),
    Trend(Box<TrendJob>),
}

/// Inputs of the estimate of a segment.
#[derive(Debug)]
pub(super) struct SegmentJob {
    pub(super) segment: Segment,
    pub(super) options: SessionOptions,
    /// Posterior of the previous segment.
    pub(super) baseline: Option<Baseline>,
    /// Time since the previous segment.
    pub(super) since: Since,
    /// Baseline acquired from the segment.
    pub(super) baseline_task: Option<BaselineTask>,
    /// Name of the session.
    pub(super) name: String,
    /// Number of the chain whose posterior it continues.
    pub(super) chain: u32,
}

/// Baseline acquisition by an estimate.
#[derive(Debug)]
pub(super) struct BaselineTask {
    /// Indices of the joints whose ropes were re-tensioned.
    pub(super) tensioned: Vec<usize>,
    /// Whether the acquisition continues an earlier one.
    pub(super) continues: bool,
}

/// Result of a [`QueuedJob`], for [`Monitor::done`](crate::Monitor::done).
#[derive(Debug)]
pub struct JobResult(pub(super) Outcome);

#[derive(Debug)]
pub(super) enum Outcome {
    Segment {
        segment: Box<Segment>,
        is_baseline: bool,
        /// Number of the chain whose posterior the estimate continues.
        chain: u32,
        result: Result<Box<Estimated>, String>,
    },
    /// Result of the online estimator; `None`: it failed.
    Online(Option<Box<OnlineResult>>),
    Trend(TrendResult),
}

/// Estimate of a segment.
#[derive(Debug)]
pub(super) struct Estimated {
    pub(super) estimate: SessionEstimate,
    pub(super) next: Baseline,
    /// Online estimator that starts from the posterior, after the last segment of a session.
    pub(super) successor: Option<Successor>,
}

impl QueuedJob {
    /// Whether the job may be skipped without loss: a trend uses stored records, and present offsets are not stored.
    pub fn is_optional(&self) -> bool {
        matches!(self.work, JobKind::Trend(_) | JobKind::Online(_))
    }

    /// Makes the estimate; takes some 10 ms for a few joints and one minute of data.
    ///
    /// A panic of the estimator is reported as an error, so that one segment does not end the monitor.
    pub fn run(self) -> JobResult {
        let robot = self.robot;
        JobResult(match self.work {
            JobKind::Segment(work) => {
                let result = catch_unwind(AssertUnwindSafe(|| work.estimate(&robot)));
                Outcome::Segment {
                    is_baseline: work.baseline_task.is_some(),
                    chain: work.chain,
                    segment: Box::new(work.segment),
                    result: result
                        .unwrap_or_else(|_| Err("estimator failed: internal error".into())),
                }
            }
            JobKind::Online(work) => {
                let result = catch_unwind(AssertUnwindSafe(|| Box::new(work.run())));
                Outcome::Online(result.ok())
            }
            JobKind::Trend(work) => {
                let result = catch_unwind(AssertUnwindSafe(|| work.run(&robot)));
                Outcome::Trend(result.unwrap_or_else(|_| work.failed()))
            }
        })
    }
}

/// Number of recording names kept in a posterior: the first and the last.
const MAX_RECORDING_NAMES: usize = 2;

impl SegmentJob {
    fn estimate(&self, robot: &Arc<Robot>) -> Result<Box<Estimated>, String> {
        let recorded = &self.segment.recorded;
        let before = self.baseline.as_ref();
        let prior = before.map(|baseline| (baseline, "the stored posterior"));
        let result = match &self.baseline_task {
            Some(task) => {
                let learning = Learning {
                    prior,
                    motor_torque: self.options.motor_torque,
                    temperature_c: self.options.temperature_c,
                    tensioned: Some(&task.tensioned),
                    continues: task.continues,
                };
                learn_recorded(robot, recorded, &self.name, &learning)
                    .map(|(baseline, estimate)| (estimate, baseline))
            }
            None => estimate_segment(
                robot,
                recorded,
                &self.name,
                (prior, self.since),
                &self.options,
            ),
        };
        let result = result.and_then(|(mut estimate, mut next)| {
            // A posterior of months names its first and last recording.
            let count = next.recordings.len();
            if count > MAX_RECORDING_NAMES {
                next.recordings.drain(1..count - 1);
            }
            next.before.truncate(MAX_RECORDING_NAMES);
            estimate.blocks = Vec::new();
            let ends = self.segment.end.is_some() || self.baseline_task.is_some();
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
