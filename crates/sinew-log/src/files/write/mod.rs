//! Writing recordings: to a temporary file beside the target, renamed when finished.

mod cell;
mod csv_table;
mod mcap_write;
#[cfg(feature = "parquet")]
mod parquet_table;
mod row_write;
mod table_write;
mod topic_write;

pub use cell::{Cell, CellKind, Column};
pub use mcap_write::{McapOptions, McapWriter};
pub use row_write::{RecordedNames, RowWriter};
pub use table_write::{Table, TableWriter};
pub use topic_write::{Compression, Packing, Topic, TopicWriter};

use crate::error::LogError;
use crate::frame::Frame;
use std::path::Path;

/// A recording being written.
///
/// Frames are written to a temporary file beside the target, renamed by `finish`;
/// a writer dropped before that removes what it wrote.
pub trait FrameWriter {
    /// Appends a frame.
    ///
    /// # Errors
    /// The frame has another number of joints, its time cannot be stored, or the system refuses.
    fn write(&mut self, frame: &Frame) -> Result<(), LogError>;

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// The system refuses; no file is left.
    fn finish(self: Box<Self>) -> Result<(), LogError>;
}

/// An error of a file being written.
fn refuse(path: &Path, reason: String) -> LogError {
    LogError::Write {
        file: path.display().to_string(),
        reason,
    }
}

fn is_parquet(path: &Path) -> bool {
    let ending = path.extension();
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"))
}
