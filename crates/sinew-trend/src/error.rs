//! Errors of invalid records and of a trend analysis.

use crate::filter::TrendError;
use sinew_files::Located;
use sinew_rope::CatalogueError;

/// Error of a trend analysis.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnalyzeError {
    /// Invalid rope of the robot description.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// Error of the trend estimator.
    #[error(transparent)]
    Trend(#[from] TrendError),
    /// Specified action of a joint without records.
    #[error(
        "no records of joint '{joint}', specified as tensioned or replaced; records contain {available}"
    )]
    Joint {
        /// Name of the joint.
        joint: String,
        /// Names of the joints with records.
        available: String,
    },
    /// Specified action later than the last session.
    #[error(
        "joint '{joint}': specified as tensioned or replaced on {day}, after its last session on {last}; add the session that follows, correct the date, or remove the entry"
    )]
    Later {
        /// Name of the joint.
        joint: String,
        /// Specified day of the action.
        day: String,
        /// Day of the last session.
        last: String,
    },
    /// Table of lifetimes without information on a tendon.
    #[error("{source_name}: {reason}")]
    Lifetimes {
        /// Name of the file.
        source_name: String,
        /// Reason of the rejection.
        reason: &'static str,
    },
    /// Replacement later than all records.
    #[error("all records of '{joint}' are older than its replacement on {day}")]
    Replaced {
        /// Name of the joint.
        joint: String,
        /// Day of the replacement.
        day: String,
    },
}

/// Error of invalid records.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// Unreadable file, or invalid table with its location.
    #[error(transparent)]
    File(#[from] Located),
    /// Invalid value in a document.
    #[error("{place}: {reason}")]
    Value {
        /// File and line or entry.
        place: String,
        /// Cause and remedy.
        reason: String,
    },
    /// Records of several robots.
    #[error("{place} is of robot '{found}', not of '{expected}'; a trend is of one robot")]
    Robot {
        /// File and location of the record.
        place: String,
        /// Robot of this record.
        found: String,
        /// Robot of the other records.
        expected: String,
    },
    /// Cycle counts without a cycle duration.
    #[error(
        "{place}: cycle counts without time; set the cycle duration with --cycle TIME, e.g. 12s"
    )]
    CycleLength {
        /// File and location of the record.
        place: String,
    },
    /// Two sessions of the same time with different offsets.
    #[error(
        "{first} and {second}: two different offsets of '{joint}' at the same time ({date}) and of one recording; keep one"
    )]
    Conflict {
        /// File and location of the first record.
        first: String,
        /// File and location of the second record.
        second: String,
        /// Name of the joint.
        joint: String,
        /// Day of both sessions.
        date: String,
    },
    /// Joint that the robot description lacks.
    #[error(
        "{place}: joint '{joint}' has no elastic transmission in the robot's description{hint} it has {available}"
    )]
    Joint {
        /// File and location of the record.
        place: String,
        /// Name of the joint.
        joint: String,
        /// Suggestion, as `; did you mean …?`.
        hint: String,
        /// Names of the joints in the description.
        available: String,
    },
    /// Table of ropes or events without a complete lifetime.
    #[error(
        "{file}: no rope lifetime found: every location has at most one event, or none that ends a lifetime (broken, replaced, retired); add 'installed' events, or use one row per rope with age_days and end"
    )]
    NoLives {
        /// Name of the file.
        file: String,
    },
    /// No records at all.
    #[error(
        "no records; give files written by sinew estimate LOG --baseline FILE --json, or a CSV (sinew trend --help)"
    )]
    Empty,
}
