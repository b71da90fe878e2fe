//! Writers of recordings: to a temporary file next to the target, renamed when finished.

mod cell;
mod csv_table;
mod mcap_write;
#[cfg(feature = "parquet")]
mod parquet_table;
mod row_write;
mod table_write;
mod topic_write;

pub use cell::{Cell, CellKind, Column, SchemaColumn, TableSchema};
pub use mcap_write::{McapOptions, McapWriter};
pub use row_write::{RecordedNames, RowWriter};
pub use table_write::{Table, TableWriter};
pub use topic_write::{Compression, Packing, Topic, TopicWriter};

use crate::error::LogError;
use crate::frame::Frame;
use std::path::Path;

/// Recording that is being written.
///
/// Frames are written to a temporary file next to the target, renamed by `finish`; a writer dropped before
/// that removes its file.
pub trait FrameWriter {
    /// Appends a frame.
    ///
    /// # Errors
    /// Returns [`LogError`] for another number of joints, a time that cannot be stored, or an error of the
    /// system.
    fn write(&mut self, frame: &Frame) -> Result<(), LogError>;

    /// Completes the file and renames it to its final name.
    ///
    /// # Errors
    /// Returns [`LogError`] if the system fails to write; no file remains.
    fn finish(self: Box<Self>) -> Result<(), LogError>;
}

/// Error of a file that is being written.
fn write_error(path: &Path, reason: String) -> LogError {
    LogError::Write {
        file: path.display().to_string(),
        reason,
    }
}

fn is_parquet(path: &Path) -> bool {
    let ending = path.extension();
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"))
}
