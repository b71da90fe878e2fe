//! Operator commands to the monitor; none of them reaches the robot.

use crate::condition::AlarmKey;
use crate::incident::Finding;
use serde::{Deserialize, Serialize};

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
            CommandKind::Tensioned { joints } | CommandKind::Replaced { joints } => {
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
