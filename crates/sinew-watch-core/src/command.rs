//! Operator commands to the monitor; none of them reaches the robot.

use crate::condition::AlarmKey;
use crate::incident::Finding;
use serde::{Deserialize, Serialize};
use sinew_files::date::utc_text;

/// Operator command to the monitor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Command {
    /// Name of the operator.
    pub who: String,
    /// Free text of the operator.
    #[serde(default)]
    pub note: String,
    /// Kind of command with its arguments.
    pub what: CommandKind,
}

/// Maximum length of an operator name and of a note, bytes.
const MAX_NAME_BYTES: usize = 200;
const MAX_NOTE_BYTES: usize = 4000;

impl Command {
    /// Rejects an invalid command; `names` are the joints with a tendon.
    pub(crate) fn check(&self, names: &[String]) -> Result<(), CommandError> {
        let Self { who, note, what } = self;
        if who.trim().is_empty() {
            return Err(CommandError::NoName);
        }
        for (field, text, most) in [("who", who, MAX_NAME_BYTES), ("note", note, MAX_NOTE_BYTES)] {
            if text.len() > most {
                let length = text.len();
                return Err(CommandError::TooLong {
                    field,
                    length,
                    most,
                });
            }
        }
        if *what == CommandKind::Note && note.trim().is_empty() {
            return Err(CommandError::NoNote);
        }
        let available = || names.join(", ");
        let unknown = |joint: &&String| !names.contains(joint);
        let joint = match what {
            CommandKind::Tensioned { joints }
            | CommandKind::Replaced { joints }
            | CommandKind::Correct { joints, .. } => {
                if joints.is_empty() {
                    let available = available();
                    return Err(CommandError::NoJoints { available });
                }
                joints.iter().find(unknown)
            }
            CommandKind::Finding { joint, .. } => Some(joint).filter(unknown),
            _ => None,
        };
        if let Some(joint) = joint {
            return Err(CommandError::Joint {
                joint: joint.clone(),
                available: available(),
            });
        }
        if let CommandKind::Finding {
            finding: Finding::Other,
            ..
        } = what
            && note.trim().is_empty()
        {
            return Err(CommandError::NoNote);
        }
        Ok(())
    }
}

/// Kind of an operator command.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum CommandKind {
    /// Ropes were re-tensioned: the motion that follows, with an empty gripper, is their new baseline.
    Tensioned {
        /// Names of the affected joints, at least one.
        joints: Vec<String>,
    },
    /// Ropes were replaced by new ones, and tensioned.
    Replaced {
        /// Names of the affected joints, at least one.
        joints: Vec<String>,
    },
    /// Withdraws a recorded re-tensioning or replacement: estimates, trend and alarms continue as if it had not been
    /// recorded. Its entry remains in the journal.
    Withdraw {
        /// Number of the entry.
        entry: u64,
    },
    /// Corrects the joints or the date of a recorded re-tensioning or replacement. With other joints, a new baseline is
    /// acquired.
    Correct {
        /// Number of the entry.
        entry: u64,
        /// Names of the affected joints, at least one.
        joints: Vec<String>,
        /// Time of the work, s since 1970 UTC: after the last session before the entry, and not later than the entry.
        time_utc_s: f64,
    },
    /// Acknowledges an alarm.
    Acknowledge {
        /// Joint and condition of the alarm.
        alarm: AlarmKey,
    },
    /// Shelves an alarm for a limited time.
    Shelve {
        /// Joint and condition of the alarm.
        alarm: AlarmKey,
        /// Duration, s; greater than 0 and at most [`MAX_SHELF_S`].
        for_s: f64,
    },
    /// Ends the shelving of an alarm.
    Unshelve {
        /// Joint and condition of the alarm.
        alarm: AlarmKey,
    },
    /// Resets a latched alarm whose condition has cleared; the note gives the reason.
    Reset {
        /// Joint and condition of the alarm.
        alarm: AlarmKey,
    },
    /// Records what the inspection of a tendon found; the note has the details. A finding that needs no repair, or that
    /// follows the repair, closes the incident of the tendon.
    Finding {
        /// Name of the joint.
        joint: String,
        /// Finding of the inspection.
        finding: Finding,
    },
    /// Adds a note to the journal.
    Note,
}

/// Maximum duration for which an alarm can be shelved: 7 days, s.
pub const MAX_SHELF_S: f64 = 7.0 * 86_400.0;

/// Formats a time, s since 1970 UTC.
fn utc(utc_s: f64) -> String {
    utc_text((1e9 * utc_s) as i64).unwrap_or_else(|| "any time".into())
}

/// Reason for which a command was rejected. A rejected command changes nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// The named joint has no tendon.
    #[error("no tendon at '{joint}'; tendons of this robot: {available}")]
    Joint {
        /// Joint named in the command.
        joint: String,
        /// Comma-separated names of the joints with a tendon.
        available: String,
    },
    /// The command names no joint.
    #[error("joints is empty; name the affected ropes: {available}")]
    NoJoints {
        /// Comma-separated names of the joints with a tendon.
        available: String,
    },
    /// The tendon has no open incident.
    #[error("'{joint}' has no open incident")]
    NoIncident {
        /// Joint named in the command.
        joint: String,
    },
    /// The robot has no such entry, or it was withdrawn.
    #[error("entry {entry} not found; it may have been withdrawn")]
    NoEntry {
        /// Number of the entry.
        entry: u64,
    },
    /// The state without the entry is not available any more.
    #[error(
        "entry {entry} can only be dated: a later entry or more than {most} records of sessions follow; add a note"
    )]
    TooLate {
        /// Number of the entry.
        entry: u64,
        /// Maximum number of records after the entry.
        most: usize,
    },
    /// The date of the work is not between the last session before the entry and the entry.
    #[error(
        "time_utc_s = {time_utc_s} is invalid; expected {after} to {recorded}, between the last session before the entry and the entry",
        after = utc(*after_utc_s),
        recorded = utc(*recorded_utc_s)
    )]
    Date {
        /// Requested time, s since 1970 UTC.
        time_utc_s: f64,
        /// End of the last session before the entry, s since 1970 UTC.
        after_utc_s: f64,
        /// Time of the entry, s since 1970 UTC.
        recorded_utc_s: f64,
    },
    /// The alarm does not exist.
    #[error("alarm not found; the alarm may have cleared")]
    NoAlarm,
    /// The duration of the shelving is outside the permitted range.
    #[error("for_s = {for_s} s is invalid; expected more than 0 s and at most 604800 s (7 days)")]
    Shelf {
        /// Requested duration, s.
        for_s: f64,
    },
    /// The condition of the alarm is still active.
    #[error(
        "the condition is still active; acknowledge or shelve the alarm, or record a re-tensioning or replacement"
    )]
    StillActive,
    /// A reset or a note has no text.
    #[error("note is missing: state the reason in `note`")]
    NoNote,
    /// The name of the operator is missing.
    #[error("name is missing: state your name in `who`")]
    NoName,
    /// A text field is too long.
    #[error("{field} has {length} bytes; expected at most {most} bytes")]
    TooLong {
        /// Name of the field.
        field: &'static str,
        /// Length of the text, bytes.
        length: usize,
        /// Maximum length, bytes.
        most: usize,
    },
}
