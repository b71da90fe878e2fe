//! The one error type of the crate: what, where, which value, and what to do.

use crate::sources::TopicUse;
use serde::{Deserialize, Serialize};
use sinew_files::names::list;
use sinew_files::{Located, OutputError};

/// Why a recording, mapping or output was refused.
///
/// A damaged recording is *not* an error: it is read up to the damage and
/// described by [`Health`](crate::Health). Errors are for input that cannot be
/// understood at all, for a wrong request, and for the operating system.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system refused to open or read a file.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        /// File as the user named it.
        file: String,
        /// What was tried: `open`, `read`.
        action: &'static str,
        /// The system's own reason.
        source: std::io::Error,
    },
    /// The file is not a recording Sinew can read.
    #[error("{file}: not a recording: {reason}")]
    NotARecording {
        /// File as the user named it.
        file: String,
        /// What was found, and what was expected.
        reason: String,
        /// Columns of a table in which no time or no joint was found; else none.
        columns: Vec<String>,
    },
    /// Several topics could be one side, and nobody said which.
    #[error("{}: several topics could be the {}: {}; choose one as {} ({})", .0.file, .0.words().0, list(&.0.candidates), .0.words().1, .0.words().2)]
    Ambiguous(Ambiguity),
    /// A mapping, or a cell or header of a table, with the place of what is wrong.
    #[error(transparent)]
    File(#[from] Located),
    /// A topic, joint, column or option asked for is not in the recording.
    #[error("{file}: {reason}")]
    Request {
        /// File as the user named it.
        file: String,
        /// What was asked for, what there is, and the nearest match.
        reason: String,
    },
    /// The operating system refused to write a file.
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

/// Topics of which one must be chosen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ambiguity {
    /// File as the user named it.
    pub file: String,
    /// The side asked for.
    pub side: TopicUse,
    /// Topics that could be it.
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

    pub(crate) fn refused(file: &str, reason: impl Into<String>) -> Self {
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
