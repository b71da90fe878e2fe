//! Interface to the messages of a recorder's file, for any container.

use crate::files::reader::{Format, Progress};
use crate::health::Health;
use crate::live::survey::Topic;
use mcap::records::Channel;
use std::collections::BTreeMap;

/// Content of a file by its summary.
#[derive(Default)]
pub(in crate::files) struct Summary {
    pub(in crate::files) topics: BTreeMap<u16, Topic>,
    /// Start of a chunk and the channels in it.
    pub(in crate::files) chunks: Vec<(u64, Vec<u16>)>,
}

/// Item read from a file.
pub(in crate::files) enum Item {
    /// A message; its payload is at [`Messages::payload`].
    Message { channel: u16, log_time_ns: u64 },
    /// A channel was defined.
    Channel(Channel),
    /// A schema was defined.
    Schema { id: u16, name: String },
    /// Part of the file was skipped; the following samples begin a new segment.
    Damage,
    /// The end of the data.
    End,
}

/// Messages in the order they were recorded.
pub(in crate::files) trait Messages: Send {
    const FORMAT: Format;

    /// Reads up to the next item that the caller uses.
    fn next(&mut self, health: &mut Health) -> std::io::Result<Item>;

    /// Payload of the latest message.
    fn payload(&self) -> &[u8];

    /// Reads the summary of the file, if it has one.
    fn summary(&mut self) -> std::io::Result<Option<Summary>>;

    /// Restarts from the first message.
    fn rewind(&mut self) -> std::io::Result<()>;

    /// Continues at an offset of the summary.
    fn restart(&mut self, offset: u64) -> std::io::Result<()>;

    fn progress(&self) -> Progress;
}
