//! Why there is no trend.

use sinew_model::trend::TrendError;
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
