//! Messages in memory, read by the caller.

use std::collections::HashMap;
use std::io::{Error, Result};
use std::sync::Arc;

use super::BagReader;
use super::messages::{Item, Messages, Summary};
use crate::decode::MessageKind;
use crate::error::LogError;
use crate::files::reader::{Format, Progress};
use crate::health::Health;
use crate::live::survey::{Topic, is_description};
use crate::options::OpenOptions;

/// Most topics there may be.
const TOPIC_LIMIT: usize = u16::MAX as usize;

/// Messages in memory, in the order of their recorder: those of joints and of the robot's description, the
/// others are only counted as topics.
#[derive(Debug, Clone, Default)]
pub struct GivenMessages {
    topics: Vec<Topic>,
    by_name: HashMap<String, u16>,
    /// Topic, time and end of the payload.
    messages: Vec<(u16, u64, usize)>,
    payloads: Vec<u8>,
}

impl GivenMessages {
    /// Keeps a message: `kind` is its type, such as `sensor_msgs/msg/JointState`; `cdr` its bytes as ROS 2
    /// writes them, head and all; `log_time_ns` the recorder's clock.
    ///
    /// # Errors
    /// More topics than a recording has.
    pub fn push(
        &mut self,
        topic: &str,
        kind: &str,
        log_time_ns: u64,
        cdr: &[u8],
    ) -> std::result::Result<(), LogError> {
        let id = match self.by_name.get(topic) {
            Some(id) => *id,
            None if self.topics.len() < TOPIC_LIMIT => {
                let id = self.topics.len() as u16;
                self.by_name.insert(topic.to_owned(), id);
                self.topics.push(Topic {
                    name: topic.to_owned(),
                    schema: kind.to_owned(),
                    encoding: "cdr".to_owned(),
                    ..Topic::default()
                });
                id
            }
            None => {
                let reason = format!("more than {TOPIC_LIMIT} topics");
                return Err(LogError::request(topic, reason));
            }
        };
        let topic = &mut self.topics[usize::from(id)];
        topic.messages += 1;
        if MessageKind::of_schema(kind).is_some() || is_description(topic) {
            self.payloads.extend_from_slice(cdr);
            self.messages.push((id, log_time_ns, self.payloads.len()));
        }
        Ok(())
    }

    /// Number of stored messages.
    pub fn len(&self) -> usize {
        self.messages.len()
    }

    /// Whether no message is stored.
    pub fn is_empty(&self) -> bool {
        self.messages.is_empty()
    }
}

/// Reader of messages in memory.
pub(in crate::files) struct Given {
    of: Arc<GivenMessages>,
    /// Number of messages returned.
    done: usize,
}

/// Messages as a recording.
pub(in crate::files) type GivenReader = BagReader<Given>;

impl GivenReader {
    pub(in crate::files) fn open(
        of: Arc<GivenMessages>,
        file: &str,
        options: &OpenOptions,
    ) -> std::result::Result<Self, LogError> {
        BagReader::of(Given { of, done: 0 }, file, options)
    }
}

impl Given {
    fn end_of(&self, message: usize) -> usize {
        self.of.messages.get(message).map_or(0, |(.., end)| *end)
    }
}

impl Messages for Given {
    const FORMAT: Format = Format::Messages;

    fn next(&mut self, _health: &mut Health) -> Result<Item> {
        let Some((channel, log_time_ns, _)) = self.of.messages.get(self.done) else {
            return Ok(Item::End);
        };
        self.done += 1;
        Ok(Item::Message {
            channel: *channel,
            log_time_ns: *log_time_ns,
        })
    }

    fn payload(&self) -> &[u8] {
        let Some(now) = self.done.checked_sub(1) else {
            return &[];
        };
        let from = now.checked_sub(1).map_or(0, |before| self.end_of(before));
        self.of.payloads.get(from..self.end_of(now)).unwrap_or(&[])
    }

    fn summary(&mut self) -> Result<Option<Summary>> {
        let topics = self.of.topics.iter().enumerate();
        Ok(Some(Summary {
            topics: topics.map(|(id, t)| (id as u16, t.clone())).collect(),
            chunks: Vec::new(),
        }))
    }

    fn rewind(&mut self) -> Result<()> {
        self.done = 0;
        Ok(())
    }

    fn restart(&mut self, _offset: u64) -> Result<()> {
        Err(Error::other("messages in memory have no offsets"))
    }

    fn progress(&self) -> Progress {
        Progress {
            bytes_done: self.done.checked_sub(1).map_or(0, |now| self.end_of(now)) as u64,
            bytes_total: self.of.payloads.len() as u64,
        }
    }
}
