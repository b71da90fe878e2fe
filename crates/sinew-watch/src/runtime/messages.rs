//! Messages between the threads of the monitor.

use super::health::Health;
use super::recorder::Recorder;
use super::slot::Slot;
use super::transport::Disconnected;
use crate::store::{Pending, StoreError};
use sinew_transport::{FrameAssembler, Inbox, RobotId};
use sinew_watch_core::alarm::StoreFault;
use sinew_watch_core::command::{Command, CommandError};
use sinew_watch_core::{JobResult, Monitor, MonitorConfig, MonitorError, QueuedJob, Transaction};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel};
use std::time::Instant;

/// Request to a core thread.
pub enum Control {
    /// Monitors a robot.
    Add(Box<MonitoredRobot>),
    /// Applies another configuration to a robot; the reply contains the error, if any.
    Reload {
        /// Index of the robot's queue.
        robot: RobotId,
        /// New configuration of the robot.
        config: Box<MonitorConfig>,
        /// Receiver of the reply.
        reply: SyncSender<Result<(), MonitorError>>,
    },
    /// Stops monitoring a robot; its session ends and is stored.
    Remove {
        /// Index of the robot's queue.
        robot: RobotId,
        /// Dropped when all data are stored.
        gone: SyncSender<()>,
    },
    /// Executes an operator command.
    Command {
        /// Index of the robot's queue.
        robot: RobotId,
        /// Command to execute.
        command: Command,
        /// Receiver of the answer.
        reply: Reply,
    },
    /// Reports that a transaction was stored, or the failure.
    Stored {
        /// Index of the robot in the core thread.
        robot: usize,
        /// Transaction that was submitted.
        transaction: Box<Transaction>,
        /// Result, with the reason of a failure.
        result: Result<(), NotStored>,
    },
    /// Reports the connection state of a robot's transport.
    Transport {
        /// Index of the robot's queue.
        robot: RobotId,
        /// Reason of the disconnection; `None`: connected.
        disconnected: Option<Disconnected>,
    },
    /// Reports a finished estimate.
    JobResult {
        /// Index of the robot in the core thread.
        robot: usize,
        /// Result of the estimate.
        done: Box<JobResult>,
    },
    /// Reports an estimate that was skipped because the monitor is stopping.
    Skipped {
        /// Index of the robot in the core thread.
        robot: usize,
    },
    /// Ends all sessions, stores them, and stops the thread.
    End {
        /// Time at which the thread stops at the latest.
        by: Instant,
    },
}

impl Control {
    /// Index of the robot that the request concerns; that of no robot for all.
    pub(super) fn robot(&self) -> usize {
        match self {
            Self::Add(monitored) => monitored.id.index(),
            Self::Reload { robot, .. }
            | Self::Remove { robot, .. }
            | Self::Command { robot, .. }
            | Self::Transport { robot, .. } => robot.index(),
            Self::Stored { robot, .. }
            | Self::JobResult { robot, .. }
            | Self::Skipped { robot } => *robot,
            Self::End { .. } => usize::MAX,
        }
    }
}

/// Reason why a transaction was not stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotStored {
    /// Kind of the failure.
    pub fault: StoreFault,
    /// Reason as text.
    pub reason: String,
}

impl NotStored {
    /// Converts an error of the store.
    pub fn of(error: &StoreError) -> Self {
        Self {
            fault: error.fault(),
            reason: error.in_words(),
        }
    }
}

/// Outcome of a command.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// Executed and stored.
    Stored,
    /// Executed, but not stored yet; the reason.
    NotStored(String),
    /// Rejected by the monitor.
    Rejected(CommandError),
    /// The robot is not monitored any more.
    Gone,
}

/// Callback that receives the outcome of a command.
pub type Reply = Box<dyn FnOnce(Answer) + Send>;

/// Handle to a core thread.
#[derive(Clone)]
pub struct CoreHandle {
    sender: Sender<Control>,
    inbox: Inbox,
}

impl CoreHandle {
    /// Creates a handle and the receiver of its requests.
    pub fn new(inbox: Inbox) -> (Self, Receiver<Control>) {
        let (sender, receiver) = channel();
        (Self { sender, inbox }, receiver)
    }

    /// Sends a request to the thread; ignored if the thread has ended.
    pub fn send(&self, control: Control) {
        let _ended = self.sender.send(control);
        self.inbox.nudge();
    }

    /// Returns the inbox of the thread's robots.
    pub fn inbox(&self) -> &Inbox {
        &self.inbox
    }
}

/// Robot to monitor.
pub struct MonitoredRobot {
    /// Index of the robot's queue.
    pub id: RobotId,
    /// Assembler of frames from messages.
    pub intake: FrameAssembler,
    /// Monitor with the state of the robot.
    pub monitor: Monitor,
    /// Recorder of its incidents.
    pub recorder: Recorder,
    /// Place of its snapshots.
    pub slot: Arc<Slot>,
}

impl MonitoredRobot {
    /// Writes the recordings that are complete; if `ends`, all of them.
    pub(super) fn record(&mut self, now_utc_s: f64, health: &Arc<Health>, ends: bool) {
        let description = self.intake.live().robot_description();
        let to = (&self.slot, health);
        self.recorder.tick(now_utc_s, description, to, ends);
    }
}

/// Request to the store thread.
pub enum Request {
    /// Stores a transaction; the result goes to the robot's core thread.
    Store {
        /// Transaction to store.
        transaction: Transaction,
        /// Index of the robot in its core thread.
        robot: usize,
        /// Core thread of the robot.
        core: CoreHandle,
    },
    /// Records that the records of a month are in their file.
    Exported(Pending),
    /// Deletes records of a robot before a time that the trend does not use.
    Thin {
        /// Name of the robot.
        robot: String,
        /// End of the range, s since 1970 UTC.
        before_utc_s: f64,
    },
    /// Stops the thread after all pending requests.
    End,
}

/// Estimate to compute, and the receiver of its result.
pub(super) struct RobotJob {
    /// Job to compute.
    pub job: QueuedJob,
    /// Index of the robot in its core thread.
    pub robot: usize,
    /// Core thread of the robot.
    pub core: CoreHandle,
}
