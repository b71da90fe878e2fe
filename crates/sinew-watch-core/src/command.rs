//! What people tell the monitor. Nothing of it reaches the robot.

use crate::condition::AlarmKey;
use serde::{Deserialize, Serialize};

/// What somebody tells the monitor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Command {
    /// Name of who says it.
    pub who: String,
    /// What they add, in their words.
    #[serde(default)]
    pub note: String,
    /// What is said.
    pub what: What,
}

/// Bytes of a name, and of a note, at most.
const NAME_MOST: usize = 200;
const NOTE_MOST: usize = 4000;

impl Command {
    /// Refuses a command that can't be, of a robot with tendons at these joints.
    pub(crate) fn check(&self, names: &[String]) -> Result<(), CommandError> {
        let Self { who, note, what } = self;
        if who.trim().is_empty() {
            return Err(CommandError::NoName);
        }
        for (field, text, most) in [("who", who, NAME_MOST), ("note", note, NOTE_MOST)] {
            if text.len() > most {
                let length = text.len();
                return Err(CommandError::TooLong {
                    field,
                    length,
                    most,
                });
            }
        }
        if *what == What::Note && note.trim().is_empty() {
            return Err(CommandError::NoNote);
        }
        if let What::Tensioned { joints } | What::Replaced { joints } = what
            && let Some(joint) = joints.iter().find(|joint| !names.contains(joint))
        {
            return Err(CommandError::Joint {
                joint: joint.clone(),
                known: names.join(", "),
            });
        }
        Ok(())
    }
}

/// What is told.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum What {
    /// Ropes were tensioned: what follows, with nothing in the gripper, is their new baseline.
    Tensioned {
        /// Of these joints; none: of all.
        joints: Vec<String>,
    },
    /// Ropes were replaced by new ones, and tensioned.
    Replaced {
        /// Of these joints; none: of all.
        joints: Vec<String>,
    },
    /// An alarm was seen.
    Acknowledge {
        /// The alarm's joint and condition.
        alarm: AlarmKey,
    },
    /// An alarm is silenced for a while.
    Shelve {
        /// The alarm's joint and condition.
        alarm: AlarmKey,
        /// For so long, s; at most [`LONGEST_SHELF_S`].
        for_s: f64,
    },
    /// It is no longer.
    Unshelve {
        /// The alarm's joint and condition.
        alarm: AlarmKey,
    },
    /// A latched alarm whose condition is over is cleared; the note says why.
    Reset {
        /// The alarm's joint and condition.
        alarm: AlarmKey,
    },
    /// A note for the journal.
    Note,
}

/// An alarm is shelved for at most a week.
pub const LONGEST_SHELF_S: f64 = 7.0 * 86_400.0;

/// Why a command was refused; nothing has changed then.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// A joint without a tendon.
    #[error("the robot has no tendon at '{joint}'; it has {known}")]
    Joint {
        /// The joint that was named.
        joint: String,
        /// Those there are.
        known: String,
    },
    /// There is no such alarm now.
    #[error("there is no such alarm now; it may have cleared")]
    NoAlarm,
    /// A shelf of no, or of too long a time.
    #[error(
        "for_s = {for_s} s: an alarm is shelved for more than 0 s and at most 604800 s (7 days)"
    )]
    Shelf {
        /// Time asked for, s.
        for_s: f64,
    },
    /// Its condition holds still.
    #[error(
        "the condition still holds; acknowledge or shelve the alarm, or say that the tendon was tensioned or replaced"
    )]
    StillActive,
    /// A reset or a note without a word.
    #[error("say why, in the note")]
    NoNote,
    /// A command without the name of who gives it.
    #[error("say who you are, in who")]
    NoName,
    /// Longer than a note is.
    #[error("{field} has {length} bytes; at most {most}")]
    TooLong {
        /// Name of the field.
        field: &'static str,
        /// The length that it has, bytes.
        length: usize,
        /// The most there may be.
        most: usize,
    },
}
