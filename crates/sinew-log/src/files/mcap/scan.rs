//! Content of an MCAP recording, from its start and from its summary, if there is one.

use std::collections::BTreeMap;

use mcap::records::{Record, op};

use super::container::{Container, record_header};
use super::lengths::parse_mcap_record;
use super::messages::{Item, Messages, Summary};
use crate::decode::MessageKind;
use crate::files::reader::{Format, Progress};
use crate::health::Health;
use crate::live::survey::{RECORDED_MESSAGES, Survey, Topic, description, is_description};

/// Number of bytes that are scanned for topics of the summary.
const SCAN_BYTES: u64 = 16 << 20;
/// Bytes scanned in a file without a summary.
const BLIND_SCAN_BYTES: u64 = 2 << 20;
/// Length of the magic bytes at both ends of the file.
const MAGIC_BYTES: u64 = 8;
/// Footer record and closing magic, bytes.
const TAIL_BYTES: u64 = 9 + 20 + MAGIC_BYTES;

/// Looks at the recording; leaves the container at the first record.
pub(super) fn scan(container: &mut impl Messages) -> std::io::Result<Survey> {
    let summary = container.summary()?;
    container.rewind()?;
    let mut survey = Survey::default();
    // Channels are defined where they are first used. The summary repeats them, so
    // that a file whose first chunk is damaged can still be read.
    for (id, topic) in summary.iter().flat_map(|summary| &summary.topics) {
        let seen = Topic {
            messages: 0,
            ..topic.clone()
        };
        survey.topics.insert(*id, seen);
    }
    let mut health = Health::default();
    loop {
        match container.next(&mut health)? {
            Item::End => break,
            Item::Damage => {}
            Item::Schema { id, name } => {
                survey.schemas.insert(id, name);
            }
            Item::Channel(channel) => note_channel(&mut survey, &channel),
            Item::Message {
                channel,
                log_time_ns,
            } => {
                survey.starts_ns.get_or_insert(log_time_ns as i64);
                let received_ns = i64::try_from(log_time_ns).unwrap_or(i64::MAX);
                survey.message(channel, received_ns, container.payload());
                let scanned = container.progress().bytes_done;
                let satisfied = match &summary {
                    None => scanned > BLIND_SCAN_BYTES,
                    Some(summary) => scanned > SCAN_BYTES || has_met(&survey, &summary.topics),
                };
                if satisfied {
                    break;
                }
            }
        }
    }
    survey.health = health;
    if let Some(summary) = summary
        && survey.robot_description.is_none()
    {
        survey.robot_description = find_description(container, &survey, &summary.chunks)?;
    }
    container.rewind()?;
    Ok(survey)
}

fn note_channel(survey: &mut Survey, channel: &mcap::records::Channel) {
    let topic = topic_of(channel, &survey.schemas);
    let entry = survey.topics.entry(channel.id).or_default();
    if entry.name != topic.name || entry.schema.is_empty() {
        *entry = topic;
    }
}

/// Whether all relevant topics of the summary have been read.
fn has_met(survey: &Survey, announced: &BTreeMap<u16, Topic>) -> bool {
    announced.iter().all(|(id, topic)| {
        let met = survey.topics.get(id).map_or(0, |topic| topic.messages);
        if is_description(topic) {
            survey.robot_description.is_some()
        } else if MessageKind::of_schema(&topic.schema).is_some() {
            met >= RECORDED_MESSAGES.min(topic.messages)
        } else {
            true
        }
    })
}

/// Finds a robot description in the chunks that the summary lists for it.
fn find_description(
    container: &mut impl Messages,
    survey: &Survey,
    chunks: &[(u64, Vec<u16>)],
) -> std::io::Result<Option<String>> {
    let wanted: Vec<u16> = survey
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
        return Ok(None);
    };
    container.restart(*start)?;
    let mut last_position = None;
    loop {
        match container.next(&mut health)? {
            Item::End | Item::Damage => return Ok(None),
            Item::Message { channel, .. } if wanted.contains(&channel) => {
                return Ok(description(container.payload()));
            }
            _ => {}
        }
        // One chunk is sufficient by the summary.
        let position = container.progress().bytes_done;
        if *last_position.get_or_insert(position) != position {
            return Ok(None);
        }
    }
}

pub(super) fn topic_of(channel: &mcap::records::Channel, schemas: &BTreeMap<u16, String>) -> Topic {
    Topic {
        name: channel.topic.clone(),
        schema: schemas.get(&channel.schema_id).cloned().unwrap_or_default(),
        encoding: channel.message_encoding.clone(),
        ..Topic::default()
    }
}

impl Messages for Container {
    const FORMAT: Format = Format::Mcap;

    fn next(&mut self, health: &mut Health) -> std::io::Result<Item> {
        let item = Container::next(self, health)?;
        if matches!(item, Item::Message { .. }) && self.ros1.is_empty() {
            return Ok(item);
        }
        let mut ros1 = std::mem::take(&mut self.ros1);
        let payload = match item {
            Item::Message { .. } => Container::payload(self),
            _ => &[],
        };
        ros1.see(&item, payload);
        self.ros1 = ros1;
        Ok(item)
    }

    #[inline]
    fn payload(&self) -> &[u8] {
        let converted = self.ros1.converted();
        converted.unwrap_or_else(|| Container::payload(self))
    }

    fn summary(&mut self) -> std::io::Result<Option<Summary>> {
        let summary = read_summary(self)?;
        if let Some(summary) = &summary {
            self.ros1.announce(summary);
        }
        Ok(summary)
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

/// Reads the summary section, if the file has a valid one; never an error.
fn read_summary(container: &mut Container) -> std::io::Result<Option<Summary>> {
    // The records of a summary take some four times its size.
    let most = container.limit() as u64 / 4;
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
    if start == 0 || start >= tail_at || tail_at - start > most {
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
        match parse_mcap_record(opcode, body).ok()? {
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
