//! Why records were refused, and why there is no trend.

use crate::filter::TrendError;
use sinew_files::Located;
use sinew_rope::CatalogueError;

/// Why there is no trend.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnalyzeError {
    /// A rope of the robot file.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The estimator.
    #[error(transparent)]
    Trend(#[from] TrendError),
    /// A stated day for a joint without records.
    #[error(
        "no records of joint '{joint}', which was stated as tensioned or replaced; records have {known}"
    )]
    Joint {
        /// Joint.
        joint: String,
        /// Joints there are.
        known: String,
    },
    /// A stated day after the last session: nothing is known of the tendon since.
    #[error(
        "joint '{joint}': stated as tensioned or replaced on {day}, after its last session on {last}; nothing is known of it since: add the session that follows, correct the date, or leave it out"
    )]
    Later {
        /// Joint.
        joint: String,
        /// Day stated.
        day: String,
        /// Day of the last session.
        last: String,
    },
    /// A table of lives that says nothing of a tendon.
    #[error("{source_name}: {why}")]
    Lives {
        /// File.
        source_name: String,
        /// Why.
        why: &'static str,
    },
    /// Everything is older than the replacement.
    #[error("all records of '{joint}' are older than its replacement on {day}")]
    Replaced {
        /// Joint.
        joint: String,
        /// Day.
        day: String,
    },
}

/// Why records were refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A file that can't be read, or a table with the place of what is wrong.
    #[error(transparent)]
    File(#[from] Located),
    /// A document that can't be.
    #[error("{place}: {why}")]
    Value {
        /// File and line or entry.
        place: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// Records of several robots.
    #[error("{place} is of robot '{found}', not of '{expected}'; a trend is of one robot")]
    Robot {
        /// File and place.
        place: String,
        /// Its robot.
        found: String,
        /// The others'.
        expected: String,
    },
    /// Cycles, and nobody says how long one takes.
    #[error(
        "{place}: counts cycles and has no time; say how long a cycle lasts, with --cycle-s SECONDS"
    )]
    CycleLength {
        /// File and place.
        place: String,
    },
    /// Two sessions at one time that differ.
    #[error(
        "{first} and {second}: two different offsets of '{joint}' at the same time ({date}) and of one recording; keep one"
    )]
    Conflict {
        /// File and place.
        first: String,
        /// File and place.
        second: String,
        /// Joint.
        joint: String,
        /// Day.
        date: String,
    },
    /// A joint the robot doesn't have.
    #[error(
        "{place}: joint '{joint}' has no elastic transmission in the robot's description{hint} it has {known}"
    )]
    Joint {
        /// File and place.
        place: String,
        /// Joint.
        joint: String,
        /// The one that may have been meant, as `; did you mean …?`.
        hint: String,
        /// Joints there are.
        known: String,
    },
    /// A table of ropes or events in which no life begins and ends.
    #[error(
        "{file}: no rope's life in it: every place has one event at most, or none that ends a life (broken, replaced, retired); say since when with 'installed' events, or give a row a rope with age_days and end"
    )]
    NoLives {
        /// File.
        file: String,
    },
    /// Nothing at all.
    #[error(
        "no records; give files written by sinew estimate LOG --baseline FILE --json, or a CSV (sinew trend --help)"
    )]
    Empty,
}
