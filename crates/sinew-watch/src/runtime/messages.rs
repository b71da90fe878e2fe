//! What the monitor's threads tell each other.

use super::door::Shut;
use super::slot::Slot;
use crate::store::StoreError;
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
        /// Robot.
        robot: RobotId,
        /// What is asked for.
        config: Box<MonitorConfig>,
        /// Who waits.
        reply: SyncSender<Result<(), MonitorError>>,
    },
    /// Watch it no more; its session ends and is stored.
    Remove {
        /// Robot.
        robot: RobotId,
        /// Dropped when all is stored.
        gone: SyncSender<()>,
    },
    /// Somebody says something.
    Command {
        /// Robot.
        robot: RobotId,
        /// What.
        command: Command,
        /// Who waits.
        reply: Reply,
    },
    /// A transaction was stored, or not.
    Stored {
        /// Place of the robot.
        robot: usize,
        /// Which.
        transaction: Box<Transaction>,
        /// Why not.
        result: Result<(), NotStored>,
    },
    /// A robot's door is shut, or is open.
    Door {
        /// Robot.
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
        /// Until when.
        by: Instant,
    },
}

/// Why a transaction wasn't stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotStored {
    /// What kind of failure.
    pub fault: StoreFault,
    /// In words.
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
    /// Its queue.
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
        /// What.
        transaction: Transaction,
        /// Robot's place in its core.
        robot: usize,
        /// Its core.
        core: CoreHandle,
    },
    /// Remember that records are in a file.
    Exported {
        /// Of this type.
        robot_type: String,
        /// Of this month.
        month: String,
        /// In the file of this number.
        number: u32,
        /// Up to this one.
        last_record: i64,
    },
    /// All is stored that was asked for; end.
    End,
}

/// An estimate to make, and who waits for it.
pub(super) struct Work {
    /// What.
    pub job: Job,
    /// Robot's place in its core.
    pub robot: usize,
    /// Its core.
    pub core: CoreHandle,
}
