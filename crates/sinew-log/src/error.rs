//! Error type of the crate: cause, location, value and remedy.

use crate::sources::TopicUse;
use serde::{Deserialize, Serialize};
use sinew_files::names::list;
use sinew_files::{Located, OutputError};

/// Error of a recording, a mapping or an output.
///
/// A damaged recording is *not* an error: it is read up to the damage and described by
/// [`Health`](crate::Health). Errors are for unreadable input, for an invalid request, and for the operating
/// system.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system failed to open or read a file.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        /// File as the user named it.
        file: String,
        /// Failed action: `open`, `read`.
        action: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// File that is not a supported recording.
    #[error("{file}: not a recording: {reason}")]
    NotARecording {
        /// File as the user named it.
        file: String,
        /// Description of the content found and expected.
        reason: String,
        /// Columns of a table without a time or a joint; otherwise empty.
        columns: Vec<String>,
    },
    /// Several topics could be one side, and none is specified.
    #[error("{}: several topics could be the {}: {}; choose one as {} ({})", .0.file, .0.words().0, list(&.0.candidates), .0.words().1, .0.words().2)]
    Ambiguous(Ambiguity),
    /// Invalid mapping, or invalid cell or header of a table, with its location.
    #[error(transparent)]
    File(#[from] Located),
    /// Requested topic, joint, column or option that is not in the recording.
    #[error("{file}: {reason}")]
    Request {
        /// File as the user named it.
        file: String,
        /// Request, available names and the nearest match.
        reason: String,
    },
    /// The operating system failed to write a file.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A writer was used wrongly (frame of the wrong length, no joints).
    #[error("{file}: cannot write: {reason}")]
    Write {
        /// File as the user named it.
        file: String,
        /// Expected and found.
        reason: String,
    },
}

/// Ambiguous topics; the user has to select one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ambiguity {
    /// File as the user named it.
    pub file: String,
    /// Ambiguous side of the robot.
    pub side: TopicUse,
    /// Candidate topics of the side.
    pub candidates: Vec<String>,
}

impl Ambiguity {
    /// The side, the key of a mapping that chooses, and the option that does.
    pub fn words(&self) -> (&'static str, &'static str, &'static str) {
        match self.side {
            TopicUse::MotorSide => ("motor side", "motor_topic", "--motor-topic"),
            _ => ("joint side", "joint_state_topic", "--joint-topic"),
        }
    }
}

impl LogError {
    pub(crate) fn io(file: &str, action: &'static str, source: std::io::Error) -> Self {
        let file = file.to_owned();
        Self::Io {
            file,
            action,
            source,
        }
    }

    pub(crate) fn not_a_recording(file: &str, reason: impl Into<String>) -> Self {
        let (file, reason) = (file.to_owned(), reason.into());
        let columns = Vec::new();
        Self::NotARecording {
            file,
            reason,
            columns,
        }
    }

    /// A table without columns for time or joints.
    pub(crate) fn columns(file: &str, reason: &str, columns: &[String]) -> Self {
        Self::NotARecording {
            file: file.to_owned(),
            reason: format!("{reason}; columns are {}", list(columns)),
            columns: columns.to_vec(),
        }
    }

    pub(crate) fn request(file: &str, reason: impl Into<String>) -> Self {
        let (file, reason) = (file.to_owned(), reason.into());
        Self::Request { file, reason }
    }
}
