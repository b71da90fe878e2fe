//! What an MCAP recording holds, from its start and, where there is one, its summary.

use std::collections::BTreeMap;

use mcap::records::{Record, op};

use super::container::{Container, record_header};
use super::messages::{Fields, Item, Messages, Summary, Topic};
use crate::decode::Cdr;
use crate::decode::{Field, MessageKind, parse};
use crate::files::reader::{Format, Progress};
use crate::health::Health;

/// Bytes of the file looked at for what the summary announces.
const SCAN_BYTES: u64 = 16 << 20;
/// Bytes looked at where no summary says what there is.
const BLIND_SCAN_BYTES: u64 = 2 << 20;
/// Messages per topic looked at for joint names.
const NAMED_MESSAGES: u64 = 256;
/// Most joints and interfaces a topic may have.
const NAME_LIMIT: usize = 4096;
/// Largest summary section read, bytes.
const SUMMARY_LIMIT: u64 = sinew_files::limits::SUMMARY.most;
/// Magic bytes at both ends of the file.
const MAGIC_BYTES: u64 = 8;
/// Footer record and closing magic, bytes.
const TAIL_BYTES: u64 = 9 + 20 + MAGIC_BYTES;

/// What the recording holds.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub(super) topics: BTreeMap<u16, Topic>,
    schemas: BTreeMap<u16, String>,
    pub(super) robot_description: Option<String>,
    /// The recorder's clock at the first message, ns.
    pub(super) starts_ns: Option<i64>,
    /// What was found damaged in the part looked at.
    pub(super) health: Health,
}

/// Looks at the recording; leaves the container at the first record.
pub(super) fn scan(container: &mut impl Messages) -> std::io::Result<Contents> {
    let summary = container.summary()?;
    container.rewind()?;
    let mut contents = Contents::default();
    // Channels are defined where they are first used. The summary repeats them, so
    // that a file whose first chunk is damaged can still be read.
    for (id, topic) in summary.iter().flat_map(|summary| &summary.topics) {
        let seen = Topic {
            messages: 0,
            ..topic.clone()
        };
        contents.topics.insert(*id, seen);
    }
    let mut health = Health::default();
    loop {
        match container.next(&mut health)? {
            Item::End => break,
            Item::Damage => {}
            Item::Schema { id, name } => {
                contents.schemas.insert(id, name);
            }
            Item::Channel(channel) => contents.channel(&channel),
            Item::Message {
                channel,
                log_time_ns,
            } => {
                contents.starts_ns.get_or_insert(log_time_ns as i64);
                contents.message(channel, container.payload());
                let scanned = container.progress().bytes_done;
                let satisfied = match &summary {
                    None => scanned > BLIND_SCAN_BYTES,
                    Some(summary) => scanned > SCAN_BYTES || contents.has_met(&summary.topics),
                };
                if satisfied {
                    break;
                }
            }
        }
    }
    contents.health = health;
    if let Some(summary) = summary
        && contents.robot_description.is_none()
    {
        contents.find_description(container, &summary.chunks)?;
    }
    container.rewind()?;
    Ok(contents)
}

impl Contents {
    fn channel(&mut self, channel: &mcap::records::Channel) {
        let topic = topic_of(channel, &self.schemas);
        let known = self.topics.entry(channel.id).or_default();
        if known.name != topic.name || known.schema.is_empty() {
            *known = topic;
        }
    }

    fn message(&mut self, channel: u16, payload: &[u8]) {
        let Some(topic) = self.topics.get_mut(&channel) else {
            return;
        };
        topic.messages += 1;
        if is_description(topic) && self.robot_description.is_none() {
            self.robot_description = description(payload);
            return;
        }
        if topic.messages > NAMED_MESSAGES || topic.encoding != "cdr" {
            return;
        }
        let Some(kind) = MessageKind::of_schema(&topic.schema) else {
            return;
        };
        // What cannot be decoded is counted when the messages are read for good.
        let Ok(parsed) = parse(kind, payload) else {
            return;
        };
        for entry in &parsed.entries {
            let name = String::from_utf8_lossy(entry.joint);
            let index = match topic.joints.iter().position(|(known, _)| *known == name) {
                Some(index) => index,
                None if topic.joints.len() < NAME_LIMIT => {
                    topic.joints.push((name.into_owned(), Fields::default()));
                    topic.joints.len() - 1
                }
                None => continue,
            };
            let fields = &mut topic.joints[index].1;
            match entry.field {
                Field::Position => fields.position = true,
                Field::Velocity => fields.velocity = true,
                Field::Effort => fields.effort = true,
                Field::Interface(name) => {
                    let name = String::from_utf8_lossy(name);
                    if !fields.interfaces.iter().any(|known| *known == name)
                        && fields.interfaces.len() < NAME_LIMIT
                    {
                        fields.interfaces.push(name.into_owned());
                    }
                }
            }
        }
    }

    /// Whether everything of interest that the summary announces was met.
    fn has_met(&self, announced: &BTreeMap<u16, Topic>) -> bool {
        announced.iter().all(|(id, topic)| {
            let met = self.topics.get(id).map_or(0, |topic| topic.messages);
            if is_description(topic) {
                self.robot_description.is_some()
            } else if MessageKind::of_schema(&topic.schema).is_some() {
                met >= NAMED_MESSAGES.min(topic.messages)
            } else {
                true
            }
        })
    }

    /// Looks a robot description up in the chunks the summary says it is in.
    fn find_description(
        &mut self,
        container: &mut impl Messages,
        chunks: &[(u64, Vec<u16>)],
    ) -> std::io::Result<()> {
        let wanted: Vec<u16> = self
            .topics
            .iter()
            .filter(|(_, topic)| is_description(topic))
            .map(|(id, _)| *id)
            .collect();
        let mut health = Health::default();
        let holding = chunks
            .iter()
            .find(|(_, channels)| channels.iter().any(|id| wanted.contains(id)));
        let Some((start, _)) = holding else {
            return Ok(());
        };
        container.restart(*start)?;
        let mut last_position = None;
        loop {
            match container.next(&mut health)? {
                Item::End | Item::Damage => return Ok(()),
                Item::Message { channel, .. } if wanted.contains(&channel) => {
                    self.robot_description = description(container.payload());
                    return Ok(());
                }
                _ => {}
            }
            // One chunk is enough: the summary said so.
            let position = container.progress().bytes_done;
            if *last_position.get_or_insert(position) != position {
                return Ok(());
            }
        }
    }
}

pub(super) fn topic_of(channel: &mcap::records::Channel, schemas: &BTreeMap<u16, String>) -> Topic {
    Topic {
        name: channel.topic.clone(),
        schema: schemas.get(&channel.schema_id).cloned().unwrap_or_default(),
        encoding: channel.message_encoding.clone(),
        messages: 0,
        joints: Vec::new(),
    }
}

pub(super) fn is_description(topic: &Topic) -> bool {
    topic.name.rsplit('/').next() == Some("robot_description")
        && matches!(
            topic.schema.as_str(),
            "std_msgs/msg/String" | "std_msgs/String"
        )
}

fn description(payload: &[u8]) -> Option<String> {
    let text = Cdr::new(payload).and_then(|mut cdr| cdr.string()).ok()?;
    let text = String::from_utf8_lossy(text);
    (!text.trim().is_empty()).then(|| text.into_owned())
}

impl Messages for Container {
    const FORMAT: Format = Format::Mcap;

    fn next(&mut self, health: &mut Health) -> std::io::Result<Item> {
        Container::next(self, health)
    }

    #[inline]
    fn payload(&self) -> &[u8] {
        Container::payload(self)
    }

    fn summary(&mut self) -> std::io::Result<Option<Summary>> {
        read_summary(self)
    }

    fn rewind(&mut self) -> std::io::Result<()> {
        Container::restart(self, MAGIC_BYTES)
    }

    fn restart(&mut self, offset: u64) -> std::io::Result<()> {
        Container::restart(self, offset)
    }

    fn progress(&self) -> Progress {
        Progress {
            bytes_done: self.bytes_done(),
            bytes_total: self.bytes_total(),
        }
    }
}

/// The summary section, if the file has a readable one; never an error of its own.
fn read_summary(container: &mut Container) -> std::io::Result<Option<Summary>> {
    let length = container.bytes_total();
    if length < TAIL_BYTES + MAGIC_BYTES {
        return Ok(None);
    }
    let tail_at = length - TAIL_BYTES;
    let source = container.source_mut();
    source.seek(tail_at)?;
    source.fill(TAIL_BYTES as usize)?;
    let tail = source.unread();
    if !tail.ends_with(mcap::MAGIC) || tail.len() != TAIL_BYTES as usize {
        return Ok(None);
    }
    let Some((op::FOOTER, 20)) = record_header(tail) else {
        return Ok(None);
    };
    let start = match tail.get(9..).and_then(|bytes| bytes.first_chunk::<8>()) {
        Some(bytes) => u64::from_le_bytes(*bytes),
        None => 0,
    };
    if start == 0 || start >= tail_at || tail_at - start > SUMMARY_LIMIT {
        return Ok(None);
    }
    let size = (tail_at - start) as usize;
    source.seek(start)?;
    if source.fill(size)? < size {
        return Ok(None);
    }
    Ok(parse_summary(&source.unread()[..size]))
}

fn parse_summary(mut bytes: &[u8]) -> Option<Summary> {
    let mut summary = Summary::default();
    let mut schemas = BTreeMap::new();
    let mut channels = Vec::new();
    let mut counts = BTreeMap::new();
    while let Some((opcode, length)) = record_header(bytes) {
        let rest = &bytes[9..];
        let length = usize::try_from(length).ok().filter(|n| *n <= rest.len())?;
        let (body, next) = rest.split_at(length);
        bytes = next;
        if !matches!(
            opcode,
            op::SCHEMA | op::CHANNEL | op::STATISTICS | op::CHUNK_INDEX
        ) {
            continue;
        }
        match mcap::parse_record(opcode, body).ok()? {
            Record::Schema { header, .. } => {
                schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => channels.push(channel),
            Record::Statistics(statistics) => counts = statistics.channel_message_counts,
            Record::ChunkIndex(index) => summary.chunks.push((
                index.chunk_start_offset,
                index.message_index_offsets.into_keys().collect(),
            )),
            _ => {}
        }
    }
    for channel in channels {
        let mut topic = topic_of(&channel, &schemas);
        topic.messages = counts.get(&channel.id).copied().unwrap_or(1);
        summary.topics.insert(channel.id, topic);
    }
    Some(summary)
}
