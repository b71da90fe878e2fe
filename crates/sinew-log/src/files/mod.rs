//! Recordings as files: containers, tables, writers.

mod ahead;
mod mcap;
mod read_seek;
mod reader;
mod recording;
pub(crate) mod table;
mod write;

pub use read_seek::ReadSeek;
pub use recording::{Format, Progress, Recording, open};
pub use write::{Compression, CsvWriter, FrameWriter, McapOptions, McapWriter};
