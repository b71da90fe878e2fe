//! Topics of ROS 2 in an MCAP.

use super::write_error;
use crate::encode::{Message, Stamp};
use crate::error::LogError;
use mcap::records::MessageHeader;
use sinew_files::{AtomicFile, OutputError};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Quality of service rosbag2 notes for a latched topic, so that players latch it again.
const LATCHED: &str = "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false";

/// Compression of the chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// Chunks without compression.
    None,
    /// Zstandard, the default of ROS 2 recorders.
    #[default]
    Zstd,
    /// LZ4 frames: larger, faster.
    Lz4,
}

/// Compression and layout of an MCAP file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Packing {
    /// Compression of the chunks.
    pub compression: Compression,
    /// Size of a chunk before compression, bytes.
    pub chunk_size: u64,
    /// Whether records are put into chunks at all.
    pub chunked: bool,
    /// Whether index and summary are written.
    pub indexed: bool,
}

impl Default for Packing {
    fn default() -> Self {
        Self {
            compression: Compression::default(),
            chunk_size: 768 << 10,
            chunked: true,
            indexed: true,
        }
    }
}

/// A topic of a [`TopicWriter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Topic(u16);

/// Writer of ROS 2 messages to an MCAP file; equal messages give equal bytes.
pub struct TopicWriter {
    out: mcap::Writer<AtomicFile>,
    path: PathBuf,
    payload: Vec<u8>,
}

impl TopicWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// Returns an error if the operating system reports one.
    pub fn create(path: &Path, packing: Packing) -> Result<Self, LogError> {
        let file = AtomicFile::create(path)?;
        let out = mcap::WriteOptions::new()
            .profile("ros2")
            .library("sinew")
            .compression(match packing.compression {
                Compression::None => None,
                Compression::Zstd => Some(mcap::Compression::Zstd),
                Compression::Lz4 => Some(mcap::Compression::Lz4),
            })
            // One thread: the split between threads would show in the bytes.
            .compression_threads(0)
            .chunk_size(Some(packing.chunk_size.max(1)))
            .use_chunks(packing.chunked)
            .disable_seeking(!file.can_seek())
            .emit_summary_records(packing.indexed)
            .emit_summary_offsets(packing.indexed)
            .emit_message_indexes(packing.indexed && packing.chunked)
            .create(file)
            .map_err(|error| to_error(path, error))?;
        Ok(Self {
            out,
            path: path.to_path_buf(),
            payload: Vec::new(),
        })
    }

    /// Adds a topic for messages of one type.
    ///
    /// # Errors
    /// Returns an error if the operating system reports one.
    pub fn topic<M: Message>(&mut self, name: &str) -> Result<Topic, LogError> {
        self.add::<M>(name, &BTreeMap::new())
    }

    /// Adds a topic whose last message late subscribers receive, too.
    ///
    /// # Errors
    /// Returns an error if the operating system reports one.
    pub fn latched<M: Message>(&mut self, name: &str) -> Result<Topic, LogError> {
        let quality = ("offered_qos_profiles".to_owned(), LATCHED.to_owned());
        self.add::<M>(name, &BTreeMap::from([quality]))
    }

    fn add<M: Message>(
        &mut self,
        name: &str,
        metadata: &BTreeMap<String, String>,
    ) -> Result<Topic, LogError> {
        let text = M::SCHEMA.text.as_bytes();
        let schema = self.out.add_schema(M::SCHEMA.name, "ros2msg", text);
        let channel = schema.and_then(|id| self.out.add_channel(id, name, "cdr", metadata));
        channel.map(Topic).map_err(|e| to_error(&self.path, e))
    }

    /// The stamp of a time.
    ///
    /// # Errors
    /// Returns [`LogError`] if the time does not fit a stamp.
    pub fn stamp(&self, time_ns: i64) -> Result<Stamp, LogError> {
        Stamp::new(time_ns).ok_or_else(|| {
            let reason = format!("time {time_ns} ns does not fit a ROS 2 stamp (1901 to 2038)");
            write_error(&self.path, reason)
        })
    }

    /// Writes a message, logged and published at `time_ns`.
    ///
    /// # Errors
    /// Returns [`LogError`] if the message cannot be encoded, or the system fails to write.
    pub fn send<M: Message>(
        &mut self,
        Topic(channel_id): Topic,
        time_ns: i64,
        sequence: u32,
        message: &M,
    ) -> Result<(), LogError> {
        let encoded = message.encode(&mut self.payload);
        encoded.map_err(|error| write_error(&self.path, error.to_string()))?;
        // Before 1970 only the stamp gives the time: log times have no sign.
        let log_time = u64::try_from(time_ns).unwrap_or(0);
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time,
            publish_time: log_time,
        };
        let written = self.out.write_to_known_channel(&header, &self.payload);
        written.map_err(|error| to_error(&self.path, error))
    }

    /// Completes the file and renames it to its final name.
    ///
    /// # Errors
    /// Returns [`LogError`] if the system fails to write; no file remains.
    pub fn finish(mut self) -> Result<(), LogError> {
        self.out.finish().map_err(|e| to_error(&self.path, e))?;
        Ok(self.out.into_inner().finish()?)
    }
}

fn to_error(path: &Path, error: mcap::McapError) -> LogError {
    match error {
        mcap::McapError::Io(source) => OutputError {
            path: path.to_path_buf(),
            source,
        }
        .into(),
        other => write_error(path, other.to_string()),
    }
}
