//! What the monitor's threads tell each other.

use super::door::Shut;
use super::slot::Slot;
use crate::store::{Pending, StoreError};
use sinew_door::{Inbox, Intake, RobotId};
use sinew_watch_core::alarm::StoreFault;
use sinew_watch_core::command::{Command, CommandError};
use sinew_watch_core::{Done, Job, Monitor, MonitorConfig, MonitorError, Transaction};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel};
use std::time::Instant;

/// What a core thread is told.
pub enum Control {
    /// Watch this robot.
    Add(Box<Watched>),
    /// Take another configuration of a robot; the answer says why not.
    Reload {
        /// Name of the robot in the configuration.
        robot: RobotId,
        /// What is asked for.
        config: Box<MonitorConfig>,
        /// Where the answer goes.
        reply: SyncSender<Result<(), MonitorError>>,
    },
    /// Watch it no more; its session ends and is stored.
    Remove {
        /// Name of the robot in the configuration.
        robot: RobotId,
        /// Dropped when all is stored.
        gone: SyncSender<()>,
    },
    /// Somebody says something.
    Command {
        /// Name of the robot in the configuration.
        robot: RobotId,
        /// What was said.
        command: Command,
        /// Where the answer goes.
        reply: Reply,
    },
    /// A transaction was stored, or not.
    Stored {
        /// Place of the robot.
        robot: usize,
        /// The transaction that was tried.
        transaction: Box<Transaction>,
        /// Why it was not stored, where it was not.
        result: Result<(), NotStored>,
    },
    /// A robot's door is shut, or is open.
    Door {
        /// Name of the robot in the configuration.
        robot: RobotId,
        /// Why it is shut; `None`: it is open.
        shut: Option<Shut>,
    },
    /// An estimate was made.
    Done {
        /// Place of the robot.
        robot: usize,
        /// What it gave.
        done: Box<Done>,
    },
    /// An estimate was left out, for the monitor ends.
    LeftOut {
        /// Place of the robot.
        robot: usize,
    },
    /// End all sessions, store them, and end by then.
    End {
        /// When the thread ends at the latest.
        by: Instant,
    },
}

/// Why a transaction wasn't stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotStored {
    /// What kind of failure.
    pub fault: StoreFault,
    /// The reason in words.
    pub why: String,
}

impl NotStored {
    /// Of what the store says.
    pub fn of(error: &StoreError) -> Self {
        Self {
            fault: error.fault(),
            why: error.in_words(),
        }
    }
}

/// What became of a command.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// It is done and stored.
    Stored,
    /// It is done, and could not be stored yet.
    NotStored(String),
    /// It was refused.
    Refused(CommandError),
    /// The robot isn't watched any more.
    Gone,
}

/// Who waits for the answer to a command.
pub type Reply = Box<dyn FnOnce(Answer) + Send>;

/// How others reach a core thread.
#[derive(Clone)]
pub struct CoreHandle {
    sender: Sender<Control>,
    inbox: Inbox,
}

impl CoreHandle {
    /// A handle, and what it is connected to.
    pub fn new(inbox: Inbox) -> (Self, Receiver<Control>) {
        let (sender, receiver) = channel();
        (Self { sender, inbox }, receiver)
    }

    /// Tells the thread something; one that has ended hears nothing.
    pub fn tell(&self, control: Control) {
        let _ended = self.sender.send(control);
        self.inbox.nudge();
    }

    /// Where its robots' messages go.
    pub fn inbox(&self) -> &Inbox {
        &self.inbox
    }
}

/// A robot that is watched.
pub struct Watched {
    /// The robot's queue.
    pub id: RobotId,
    /// Makes frames of messages.
    pub intake: Intake,
    /// What is known of it.
    pub monitor: Monitor,
    /// Where that is shown.
    pub slot: Arc<Slot>,
}

/// What the store is asked for.
pub enum Request {
    /// Store this; the answer goes to the robot's core.
    Store {
        /// The transaction.
        transaction: Transaction,
        /// Robot's place in its core.
        robot: usize,
        /// The core thread of the robot.
        core: CoreHandle,
    },
    /// Remember that the records of a month are in their file.
    Exported(Pending),
    /// All is stored that was asked for; end.
    End,
}

/// An estimate to make, and who waits for it.
pub(super) struct Work {
    /// The estimate to make.
    pub job: Job,
    /// Robot's place in its core.
    pub robot: usize,
    /// The core thread of the robot.
    pub core: CoreHandle,
}
