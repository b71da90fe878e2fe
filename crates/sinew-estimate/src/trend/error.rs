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
    /// Everything is older than the replacement.
    #[error("all records of '{joint}' are older than its replacement on {day}")]
    Replaced {
        /// Joint.
        joint: String,
        /// Day.
        day: String,
    },
}
