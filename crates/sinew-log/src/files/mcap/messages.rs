//! What a recorder's file hands out, whatever holds it.

use crate::files::reader::{Format, Progress};
use crate::health::Health;
use crate::live::survey::Topic;
use mcap::records::Channel;
use std::collections::BTreeMap;

/// What the file says it holds.
#[derive(Default)]
pub(in crate::files) struct Summary {
    pub(in crate::files) topics: BTreeMap<u16, Topic>,
    /// Start of a chunk and the channels in it.
    pub(in crate::files) chunks: Vec<(u64, Vec<u16>)>,
}

/// What was met.
pub(in crate::files) enum Item {
    /// A message; its payload is at [`Messages::payload`].
    Message { channel: u16, log_time_ns: u64 },
    /// A channel was defined.
    Channel(Channel),
    /// A schema was defined.
    Schema { id: u16, name: String },
    /// Part of the file was skipped; what follows does not connect to what came before.
    Damage,
    /// The end of the data.
    End,
}

/// Messages in the order they were recorded.
pub(in crate::files) trait Messages: Send {
    const FORMAT: Format;

    /// Reads on to the next thing of interest.
    fn next(&mut self, health: &mut Health) -> std::io::Result<Item>;

    /// The payload of the message just met.
    fn payload(&self) -> &[u8];

    /// What the file says it holds, where it says so.
    fn summary(&mut self) -> std::io::Result<Option<Summary>>;

    /// Starts anew from the first message.
    fn rewind(&mut self) -> std::io::Result<()>;

    /// Goes on at a place that the summary named.
    fn restart(&mut self, offset: u64) -> std::io::Result<()>;

    fn progress(&self) -> Progress;
}
