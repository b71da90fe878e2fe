//! Errors that prevent the evaluation of a whole series.

use super::rejection::WrongPitch;
use sinew_files::{Located, OutputError};
use std::path::PathBuf;

/// Error in reading a series of frames.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// A file or folder cannot be read.
    #[error("{path}: {error}", path = path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the file system.
        error: std::io::Error,
    },
    /// The folder contains no frames.
    #[error("{folder}: no PNG or JPEG frames (.png, .jpg, .jpeg) in this folder", folder = folder.display())]
    Empty {
        /// Path of the folder.
        folder: PathBuf,
    },
    /// The times of the frames are not specified.
    #[error(
        "{file}: no time in this file name; name files like frame_12.5s.png, 20261121_143000_250.png or 1795271400250.png, or set --frame-rate HZ or --times FILE.csv"
    )]
    NoTimes {
        /// Name of the first frame without a time.
        file: String,
    },
    /// The table of times is invalid; the error names the location.
    #[error(transparent)]
    File(#[from] Located),
    /// The value of an option is invalid.
    #[error("{0}")]
    Option(String),
    /// The specified or default pitch does not agree with the scale.
    #[error("{frame}: {error}")]
    WrongPitch {
        /// Name of the frame.
        frame: String,
        /// Inconsistency of the pitch.
        error: WrongPitch,
    },
    /// No frame is usable.
    #[error("{input}: none of {count} frames could be used; the first: {name}: {reason}", input = input.display())]
    Nothing {
        /// Path of the folder or video.
        input: PathBuf,
        /// Number of frames tried.
        count: usize,
        /// Name of the first frame.
        name: String,
        /// Reason for the rejection of the first frame.
        reason: String,
    },
    /// The video cannot be decoded.
    #[error("{path}: {reason}", path = path.display())]
    Video {
        /// Path of the video.
        path: PathBuf,
        /// Cause and remedy.
        reason: String,
    },
    /// The overlay cannot be rendered.
    #[error("{path}: cannot render the overlay: {reason}", path = path.display())]
    Overlay {
        /// Path of the overlay.
        path: PathBuf,
        /// Cause of the failure.
        reason: String,
    },
    /// An output file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}
