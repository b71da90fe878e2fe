//! Why there is no estimate.

use crate::robot_dir::RobotDirError;
use sinew_files::OutputError;
use sinew_log::LogError;
use sinew_model::offset::{MapError, OffsetConfigError};

/// Why there is no estimate. Nothing has been written then.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// The recording can't be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The robot can't be loaded.
    #[error(transparent)]
    Robot(#[from] RobotDirError),
    /// The catalogue of ropes can't be read.
    #[error(transparent)]
    Ropes(#[from] sinew_rope::CatalogueError),
    /// The settings don't make an estimator.
    #[error(transparent)]
    Config(#[from] OffsetConfigError),
    /// An output file can't be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Recording and robot (or settings) don't go together.
    #[error("{file}: {why}")]
    Mismatch {
        /// The recording.
        file: String,
        /// What doesn't fit and what to do.
        why: String,
    },
    /// `--inject` with a joint or value nobody has.
    #[error("can't inject an offset: {0}")]
    Injection(String),
    /// A mark is said to be passed where none is, or when nothing was recorded.
    #[error("no mark is read: {0}")]
    Touch(String),
}

/// Why there is no session estimate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// Recording or robot can't be used.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// The estimator refused.
    #[error("{file}: {error}")]
    Map {
        /// The recording.
        file: String,
        /// Why.
        error: MapError,
    },
    /// The recursive form can't be saved.
    #[error(
        "{recording}: the offsets are in doubt (the first half minute, a contact, a slip not settled yet); save when they are not, or keep the file from before"
    )]
    Provisional {
        /// The recording, or what stands for it.
        recording: String,
    },
    /// The baseline file can't be used.
    #[error("{file}: {why}")]
    Baseline {
        /// The file.
        file: String,
        /// Why, and what to do.
        why: String,
    },
}
