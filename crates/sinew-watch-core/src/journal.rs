//! Journal of a robot: events and operator entries.

use crate::alarm::Transition;
use crate::command::Command;
use crate::incident::Incident;
use serde::{Deserialize, Serialize};

/// Entry of the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Entry {
    /// Time of the event by the monitor's civil clock, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Event of this entry.
    pub event: Event,
}

/// Recorded re-tensioning or replacement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Maintenance {
    /// Number of the entry, counted from the robot's first.
    pub number: u64,
    /// Names of the affected joints.
    pub joints: Vec<String>,
    /// Whether the ropes were replaced by new ones; otherwise re-tensioned.
    pub replaced: bool,
    /// Time of the work, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Time of the entry in the journal, s since 1970 UTC.
    pub recorded_utc_s: f64,
    /// End of the last session before the entry, s since 1970 UTC; the work is not earlier. `None`: no session.
    pub after_utc_s: Option<f64>,
    /// Name of the operator who recorded it.
    pub who: String,
    /// Last correction or withdrawal; `None`: as recorded.
    pub correction: Option<Correction>,
}

/// Correction or withdrawal of a recorded re-tensioning or replacement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Correction {
    /// Name of the operator who made it.
    pub who: String,
    /// Time of the correction, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Whether the entry was withdrawn; otherwise it has other joints, or another date.
    pub withdrawn: bool,
}

impl Maintenance {
    /// Whether the entry was withdrawn.
    pub fn is_withdrawn(&self) -> bool {
        self.correction.as_ref().is_some_and(|by| by.withdrawn)
    }
}

/// Event of a robot, its alarms or its monitor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The monitor started.
    Started {
        /// Whether the monitor restarted from stored state.
        restored: bool,
    },
    /// Data are received again after an interruption.
    Back {
        /// Duration of the interruption, s; `None`: first data since the start.
        after_s: Option<f64>,
    },
    /// No more data are received.
    Silent,
    /// A session ended and was recorded.
    Session {
        /// Duration of motion in the session, s.
        duration_s: f64,
        /// Reason for the end of the session.
        end: SessionEnd,
    },
    /// A new baseline was acquired.
    Baseline {
        /// Number of distinct poses of the baseline.
        poses: u64,
    },
    /// A baseline could not be acquired yet.
    #[serde(alias = "baseline-waits")]
    BaselinePending {
        /// Reason for which the baseline is pending.
        #[serde(alias = "why")]
        reason: BaselineWaits,
    },
    /// The civil clock stepped relative to the monotonic clock.
    ClockStep {
        /// Size of the step, s.
        by_s: f64,
    },
    /// The robot's time stamps do not advance in real time.
    StampsNotTime {
        /// Rate of the time stamps relative to real time, s/s.
        rate: f64,
    },
    /// Messages were dropped before the estimator because a queue was full.
    Dropped {
        /// Number of dropped messages.
        messages: u64,
    },
    /// Motion was not estimated because the estimator is slower than real time.
    Behind {
        /// Duration of the motion, s.
        motion_s: f64,
    },
    /// The stored state does not belong to this robot and is ignored.
    #[serde(alias = "belief-left")]
    StoredStateIgnored {
        /// Reason for which the stored state is ignored.
        #[serde(alias = "why")]
        reason: String,
    },
    /// Old entries or records were discarded because they could not be stored for too long.
    GivenUp {
        /// Number of discarded journal entries.
        entries: u64,
        /// Number of discarded records.
        records: u64,
    },
    /// An alarm changed its state.
    Alarm {
        /// State transition of the alarm.
        #[serde(flatten)]
        transition: Transition,
    },
    /// An incident of a tendon was opened, or changed its phase.
    Incident {
        /// Incident with its evidence.
        incident: Incident,
    },
    /// An operator gave a command.
    Command {
        /// Command of the operator.
        #[serde(flatten)]
        command: Command,
    },
    /// A recorded re-tensioning or replacement was corrected or withdrawn.
    Maintenance {
        /// Entry with its corrected joints and time of the work, s since 1970 UTC, or marked as withdrawn.
        maintenance: Maintenance,
    },
    /// The configuration was reloaded.
    Reloaded,
}

/// Reason for which the stored state is ignored if it belongs to another robot or another version of the program.
pub(crate) const STATE_OF_ANOTHER_ROBOT: &str =
    "its tendons or its format version differ from those of this robot and program";

/// Reason for the end of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SessionEnd {
    /// The session reached its maximum duration of motion.
    Full,
    /// The robot was at rest.
    Stood,
    /// No more data were received.
    Lost,
    /// The monitor stopped.
    Shutdown,
    /// The civil clock stepped.
    ClockStep,
    /// An operator recorded a re-tensioning or a replacement.
    Command,
    /// The baseline has the motion that it needs.
    Baseline,
}

/// Reason for which a baseline is pending.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum BaselineWaits {
    /// The number of distinct poses is too low so far.
    FewPoses,
    /// The estimator rejected the data.
    #[serde(alias = "refused")]
    Rejected,
}
