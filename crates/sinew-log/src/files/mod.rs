//! Recordings as files: containers, tables, writers.

mod ahead;
mod chain;
#[cfg(feature = "db3")]
mod db3;
mod lerobot;
mod mcap;
mod opener;
mod parts;
mod read_seek;
mod reader;
mod recording;
mod spool;
pub(crate) mod table;
mod write;

pub use mcap::{GivenMessages, parse_mcap_record};
pub use parts::recordings_of;
pub use read_seek::ReadSeek;
pub use reader::{Format, Progress};
pub use recording::{Recording, open, open_parts};
pub use table::{
    Arrays, MappingProposal, ProposedJoint, ProposedSource, ProposedTime, TableColumn,
};
pub use write::{
    Cell, CellKind, Column, Compression, FrameWriter, McapOptions, McapWriter, Packing,
    RecordedNames, RowWriter, RowWriter as CsvWriter, SchemaColumn, Table, TableSchema,
    TableWriter, Topic, TopicWriter,
};
