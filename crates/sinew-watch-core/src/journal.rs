//! What happened, for people to read later.

use crate::alarm::Transition;
use crate::command::Command;
use serde::{Deserialize, Serialize};

/// An entry of the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Entry {
    /// When, s since 1970 UTC, by the monitor's clock at the time.
    pub time_utc_s: f64,
    /// What happened.
    pub event: Event,
}

/// What happened to a robot, its alarms or its monitor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The monitor began to watch the robot; `restored`: from what it had stored.
    Started {
        /// Whether there was something stored.
        restored: bool,
    },
    /// Data came again, after so long.
    Back {
        /// s; `None`: for the first time.
        after_s: Option<f64>,
    },
    /// No data come any more.
    Silent,
    /// A session ended, and was recorded.
    Session {
        /// Time in motion, s.
        duration_s: f64,
        /// Why it ended.
        end: SessionEnd,
    },
    /// A new baseline was learned.
    Baseline {
        /// Distinct poses it rests on.
        poses: u64,
    },
    /// A baseline could not be learned yet.
    BaselineWaits {
        /// The reason.
        why: BaselineWaits,
    },
    /// The civil clock stepped against the one that never does.
    ClockStep {
        /// By so much, s.
        by_s: f64,
    },
    /// The robot's stamps do not run with time.
    StampsNotTime {
        /// Seconds of stamps in a second.
        rate: f64,
    },
    /// Messages were dropped before the estimator, by a full queue.
    Dropped {
        /// Messages that are missing.
        messages: u64,
    },
    /// Motion was not estimated, because estimates take longer than the motion they are of.
    Behind {
        /// Time of it, s.
        motion_s: f64,
    },
    /// What was stored of the tendons doesn't belong to this robot any more, and is left alone.
    BeliefLeft {
        /// The reason.
        why: String,
    },
    /// Older entries or records were given up, because they could not be stored for too long.
    GivenUp {
        /// Entries of the journal.
        entries: u64,
        /// Records that were given up.
        records: u64,
    },
    /// An alarm took a step.
    Alarm {
        /// The step the alarm took.
        #[serde(flatten)]
        transition: Transition,
    },
    /// Somebody said something.
    Command {
        /// What was said.
        #[serde(flatten)]
        command: Command,
    },
    /// The configuration was read again.
    Reloaded,
}

/// Why a session ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SessionEnd {
    /// It was long enough.
    Full,
    /// The robot stood.
    Stood,
    /// Its data stopped.
    Lost,
    /// The monitor stopped.
    Shutdown,
    /// The civil clock stepped.
    ClockStep,
    /// Somebody tensioned or replaced a rope.
    Command,
    /// It was the motion a baseline needed.
    Baseline,
}

/// Why a baseline waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum BaselineWaits {
    /// Too few distinct poses so far.
    FewPoses,
    /// The estimator refused the data.
    Refused,
}
