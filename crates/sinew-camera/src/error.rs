//! What stops the reading of a whole series.

use super::rejection::WrongPitch;
use sinew_files::{Located, OutputError};
use std::path::PathBuf;

/// Why a series of frames can't be read.
#[derive(Debug, thiserror::Error)]
pub enum CameraError {
    /// The file system says no.
    #[error("{path}: {error}", path = path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What it says.
        error: std::io::Error,
    },
    /// A folder without frames.
    #[error("{folder}: no PNG or JPEG frames (.png, .jpg, .jpeg) in this folder", folder = folder.display())]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
    /// Nothing says when the frames were taken.
    #[error(
        "{file}: no time in this file name; name files like frame_12.5s.png, 20261121_143000_250.png or 1795271400250.png, or say --frame-rate HZ or --times FILE.csv"
    )]
    NoTimes {
        /// First frame without a time.
        file: String,
    },
    /// The table of times, with the place of what is wrong.
    #[error(transparent)]
    File(#[from] Located),
    /// An option that can't be.
    #[error("{0}")]
    Option(String),
    /// The lines aren't half a millimetre apart.
    #[error("{frame}: {error}")]
    WrongPitch {
        /// Frame that shows it.
        frame: String,
        /// What it shows.
        error: WrongPitch,
    },
    /// No frame could be used.
    #[error("{input}: none of {count} frames could be used; the first: {name}: {reason}", input = input.display())]
    Nothing {
        /// Folder or video.
        input: PathBuf,
        /// Frames tried.
        count: usize,
        /// First frame.
        name: String,
        /// Why not.
        reason: String,
    },
    /// The video can't be decoded.
    #[error("{path}: {reason}", path = path.display())]
    Video {
        /// The video.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// A picture can't be written.
    #[error("{path}: can't draw the overlay: {reason}", path = path.display())]
    Overlay {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A file can't be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}
