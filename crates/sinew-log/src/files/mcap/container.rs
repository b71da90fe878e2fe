//! MCAP container: reads records and chunks message by message, and continues after damaged parts.
//!
//! The framing is read here rather than by `mcap::sans_io::LinearReader`, because
//! recovery requires the offset of each record, the validity of a chunk *before* its first message is used, and the
//! readable part of a truncated chunk. The linear reader stops with an error instead. Record bodies are parsed by the
//! `mcap` crate.

use mcap::records::{ChunkHeader, Record, op};

use super::chunk::Unpacker;
use super::lengths::parse_mcap_record;
use super::messages::Item;
use super::ros1::Ros1Channels;
use super::source::Source;
use crate::health::Health;
use sinew_files::{Budget, ProcessorTime};

/// Operation code and length of a record, bytes.
const RECORD_HEADER: usize = 1 + 8;
/// Channel, sequence, log time, publish time, bytes.
const MESSAGE_HEADER: usize = 2 + 4 + 8 + 8;
/// Longest header of a chunk record that is looked at: 40 fixed bytes and the
/// name of the compression.
const CHUNK_HEADER_LIMIT: usize = 4 << 10;
const CHUNK_HEADER_FIXED: usize = 8 + 8 + 8 + 4 + 4 + 8;

/// Buffer that contains the current message.
#[derive(Clone, Copy)]
enum Place {
    File,
    Chunk,
}

pub(in crate::files) struct Container {
    source: Source,
    unpacker: Unpacker,
    time: ProcessorTime,
    limit: usize,
    /// The unpacked chunk.
    chunk: Vec<u8>,
    /// Buffer of the records of the current chunk, read position and end: `chunk`, or the file's own buffer
    /// if not compressed.
    chunk_place: Place,
    chunk_at: usize,
    chunk_end: usize,
    /// File offset and compressed size of the current chunk, for messages.
    chunk_offset: u64,
    /// Records of a salvaged chunk end anywhere; of a whole one they do not.
    chunk_is_cut: bool,
    payload: (Place, usize, usize),
    /// Bytes of the file buffer to consume before the next record.
    pending: usize,
    ended: bool,
    last_log_ns: Option<i64>,
    /// Channels of ROS 1, whose payloads are converted.
    pub(super) ros1: Ros1Channels,
}

impl Container {
    pub(super) fn new(source: Source, budget: &Budget) -> Self {
        let limit = budget.memory.length();
        Container {
            time: ProcessorTime::new(budget, source.length()),
            unpacker: Unpacker::new(limit),
            source,
            limit,
            chunk: Vec::new(),
            chunk_place: Place::Chunk,
            chunk_at: 0,
            chunk_end: 0,
            chunk_offset: 0,
            chunk_is_cut: false,
            payload: (Place::File, 0, 0),
            pending: 0,
            ended: false,
            last_log_ns: None,
            ros1: Ros1Channels::default(),
        }
    }

    /// Continues with the record at `offset` of the file.
    pub(super) fn restart(&mut self, offset: u64) -> std::io::Result<()> {
        self.source.seek(offset)?;
        self.chunk_at = 0;
        self.chunk_end = 0;
        self.pending = 0;
        self.ended = false;
        self.last_log_ns = None;
        Ok(())
    }

    pub(super) fn bytes_done(&self) -> u64 {
        if self.ended {
            self.source.length()
        } else {
            self.source.position()
        }
    }

    pub(super) fn bytes_total(&self) -> u64 {
        self.source.length()
    }

    /// Maximum memory of a chunk or record, bytes.
    pub(super) fn limit(&self) -> usize {
        self.limit
    }

    pub(super) fn source_mut(&mut self) -> &mut Source {
        &mut self.source
    }

    /// Payload of the latest message as recorded.
    #[inline]
    pub(super) fn payload(&self) -> &[u8] {
        let (place, start, end) = self.payload;
        match place {
            Place::Chunk => &self.chunk[start..end],
            Place::File => &self.source.unread()[start..end],
        }
    }

    /// Reads up to the next item that the caller uses.
    pub(super) fn next(&mut self, health: &mut Health) -> std::io::Result<Item> {
        loop {
            if self.chunk_at < self.chunk_end {
                if let Some(item) = self.next_in_chunk(health) {
                    return Ok(item);
                }
                continue;
            }
            if self.ended {
                return Ok(Item::End);
            }
            self.source.consume(std::mem::take(&mut self.pending));
            if let Some(item) = self.next_in_file(health)? {
                return Ok(item);
            }
        }
    }

    #[inline]
    fn next_in_chunk(&mut self, health: &mut Health) -> Option<Item> {
        let records = match self.chunk_place {
            Place::Chunk => &self.chunk[..self.chunk_end],
            Place::File => &self.source.unread()[..self.chunk_end],
        };
        let rest = &records[self.chunk_at..];
        let Some((opcode, length)) = record_header(rest) else {
            self.end_broken_chunk(health);
            return None;
        };
        let body = &rest[RECORD_HEADER..];
        if length > body.len() as u64 {
            self.end_broken_chunk(health);
            return None;
        }
        let length = length as usize;
        let start = self.chunk_at + RECORD_HEADER;
        self.chunk_at = start + length;
        if opcode == op::MESSAGE {
            return self.message(self.chunk_place, start, length, health);
        }
        // Chunks do not nest; everything but schemas and channels is of no use here.
        definition(opcode, &records[start..start + length], health)
    }

    /// Error of a chunk whose records do not end with it.
    #[cold]
    fn end_broken_chunk(&mut self, health: &mut Health) {
        if !self.chunk_is_cut {
            let rest = self.chunk_end - self.chunk_at;
            let (offset, after) = (self.chunk_offset, self.last_log_ns);
            health.damaged(
                offset,
                rest as u64,
                after,
                "records inside the chunk do not end with it".to_owned(),
            );
        }
        self.chunk_at = self.chunk_end;
    }

    #[inline]
    fn message(
        &mut self,
        place: Place,
        start: usize,
        length: usize,
        health: &mut Health,
    ) -> Option<Item> {
        let bytes = match place {
            Place::Chunk => &self.chunk[start..start + length],
            Place::File => &self.source.unread()[start..start + length],
        };
        let Some(mut header) = bytes.get(..MESSAGE_HEADER) else {
            health.undecodable(0, || format!("message record of {length} bytes"));
            return None;
        };
        let channel = u16::from_le_bytes(take(&mut header)?);
        let _sequence: [u8; 4] = take(&mut header)?;
        let log_time_ns = u64::from_le_bytes(take(&mut header)?);
        self.last_log_ns = Some(log_time_ns as i64);
        self.payload = (place, start + MESSAGE_HEADER, start + length);
        Some(Item::Message {
            channel,
            log_time_ns,
        })
    }

    fn next_in_file(&mut self, health: &mut Health) -> std::io::Result<Option<Item>> {
        let ready = self.source.fill(RECORD_HEADER)?;
        let offset = self.source.position();
        let Some((opcode, length)) = record_header(self.source.unread()) else {
            let reason = if ready == 0 {
                "the file ends without a footer: the recording was not closed".to_owned()
            } else {
                "the file ends inside the head of a record".to_owned()
            };
            return Ok(Some(self.cut(offset, reason, health)));
        };
        let remaining = self
            .source
            .length()
            .saturating_sub(offset + RECORD_HEADER as u64);
        if opcode == 0 || (length > remaining && opcode != op::CHUNK) {
            let reason = if opcode == 0 {
                "no record starts here".to_owned()
            } else {
                format!("record {opcode:#04x} of {length} bytes, but only {remaining} follow")
            };
            return Ok(Some(self.cut(offset, reason, health)));
        }
        match opcode {
            op::DATA_END | op::FOOTER => {
                self.ended = true;
                Ok(Some(Item::End))
            }
            op::CHUNK => self.open_chunk(offset, length, remaining, health),
            op::MESSAGE | op::SCHEMA | op::CHANNEL => {
                if length > self.limit as u64 {
                    health.damaged(
                        offset,
                        length,
                        self.last_log_ns,
                        format!(
                            "record of {length} bytes is over the limit of {} bytes",
                            self.limit
                        ),
                    );
                    self.source.skip(RECORD_HEADER as u64 + length)?;
                    return Ok(Some(Item::Damage));
                }
                let length = length as usize;
                if self.source.fill(RECORD_HEADER + length)? < RECORD_HEADER + length {
                    let reason = "the file ends inside a record".to_owned();
                    return Ok(Some(self.cut(offset, reason, health)));
                }
                self.pending = RECORD_HEADER + length;
                if opcode == op::MESSAGE {
                    return Ok(self.message(Place::File, RECORD_HEADER, length, health));
                }
                let body = &self.source.unread()[RECORD_HEADER..RECORD_HEADER + length];
                Ok(definition(opcode, body, health))
            }
            _ => {
                self.source.skip(RECORD_HEADER as u64 + length)?;
                Ok(None)
            }
        }
    }

    /// Everything from `offset` on is lost.
    #[cold]
    fn cut(&mut self, offset: u64, reason: String, health: &mut Health) -> Item {
        let lost = self.source.length().saturating_sub(offset);
        health.damaged(offset, lost, self.last_log_ns, reason);
        self.ended = true;
        Item::End
    }

    fn open_chunk(
        &mut self,
        offset: u64,
        length: u64,
        remaining: u64,
        health: &mut Health,
    ) -> std::io::Result<Option<Item>> {
        let whole = length <= remaining;
        let there = length.min(remaining);
        if there > (self.limit as u64).saturating_mul(2) {
            health.damaged(
                offset,
                there,
                self.last_log_ns,
                format!(
                    "chunk record of {length} bytes is over the limit of {} bytes",
                    self.limit
                ),
            );
            self.source.skip(RECORD_HEADER as u64 + there)?;
            return Ok(Some(Item::Damage));
        }
        let there = there as usize;
        let filled = self.source.fill(RECORD_HEADER + there)?;
        let body = &self.source.unread()[RECORD_HEADER.min(filled)..filled];
        let Some((header, packed)) = chunk_header(body) else {
            if whole {
                let reason = "the head of the chunk cannot be read".to_owned();
                health.damaged(offset, length, self.last_log_ns, reason);
                self.pending = RECORD_HEADER + there;
                return Ok(Some(Item::Damage));
            }
            let reason = "the file ends inside the head of a chunk".to_owned();
            return Ok(Some(self.cut(offset, reason, health)));
        };
        self.chunk_offset = offset;
        let complete = header.compressed_size <= packed.len() as u64;
        if whole && complete {
            let packed = &packed[..header.compressed_size as usize];
            self.chunk_is_cut = false;
            let verdict = if header.compression.is_empty() {
                let from = RECORD_HEADER + CHUNK_HEADER_FIXED;
                self.chunk_place = Place::File;
                self.chunk_at = from;
                self.chunk_end = from + packed.len();
                self.unpacker.check_plain(&header, packed)
            } else {
                let unpacker = &mut self.unpacker;
                let chunk = &mut self.chunk;
                let spent = (self.time).spend(|| unpacker.unpack(&header, packed, chunk));
                let verdict = match spent {
                    Ok(verdict) => verdict,
                    Err(reason) => return Ok(Some(self.cut(offset, reason, health))),
                };
                self.chunk_place = Place::Chunk;
                self.chunk_at = 0;
                self.chunk_end = self.chunk.len();
                verdict
            };
            self.pending = RECORD_HEADER + there;
            if let Err(reason) = verdict {
                self.chunk_at = 0;
                self.chunk_end = 0;
                health.damaged(
                    offset,
                    RECORD_HEADER as u64 + length,
                    self.last_log_ns,
                    format!(
                        "{reason}; the chunk with log times {:.3} s to {:.3} s is skipped",
                        header.message_start_time as f64 * 1e-9,
                        header.message_end_time as f64 * 1e-9
                    ),
                );
                return Ok(Some(Item::Damage));
            }
            return Ok(None);
        }
        // Cut off inside the chunk: what unpacks before the cut is used.
        self.chunk_is_cut = true;
        self.unpacker.salvage(&header, packed, &mut self.chunk);
        let usable = complete_records(&self.chunk);
        self.chunk_place = Place::Chunk;
        self.chunk_at = 0;
        self.chunk_end = usable;
        let lost = header
            .compressed_size
            .min(self.source.length().saturating_sub(offset));
        health.damaged(
            offset,
            lost,
            self.last_log_ns,
            format!(
                "the file ends inside a chunk of {} bytes: {usable} of its {} unpacked bytes are saved, \
                 the rest up to log time {:.3} s is lost",
                header.compressed_size,
                header.uncompressed_size,
                header.message_end_time as f64 * 1e-9
            ),
        );
        self.ended = true;
        Ok(None)
    }
}

/// Splits the next bytes off.
#[inline]
fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (head, rest) = bytes.split_first_chunk::<N>()?;
    *bytes = rest;
    Some(*head)
}

/// Operation code and body length of the record at the start of `bytes`.
#[inline]
pub(super) fn record_header(mut bytes: &[u8]) -> Option<(u8, u64)> {
    let [opcode] = take(&mut bytes)?;
    Some((opcode, u64::from_le_bytes(take(&mut bytes)?)))
}

/// Length of the prefix that consists of complete records.
fn complete_records(bytes: &[u8]) -> usize {
    let mut at = 0;
    while let Some((_, length)) = record_header(&bytes[at..]) {
        let body = (bytes.len() - at - RECORD_HEADER) as u64;
        if length > body {
            break;
        }
        at += RECORD_HEADER + length as usize;
    }
    at
}

/// Splits the body of a chunk record into its header and the compressed records; `None`: it is invalid.
fn chunk_header(mut body: &[u8]) -> Option<(ChunkHeader, &[u8])> {
    let body = &mut body;
    let message_start_time = u64::from_le_bytes(take(body)?);
    let message_end_time = u64::from_le_bytes(take(body)?);
    let uncompressed_size = u64::from_le_bytes(take(body)?);
    let uncompressed_crc = u32::from_le_bytes(take(body)?);
    let name_length = u32::from_le_bytes(take(body)?) as usize;
    let (name, rest) = body
        .split_at_checked(name_length)
        .filter(|_| name_length <= CHUNK_HEADER_LIMIT)?;
    *body = rest;
    let header = ChunkHeader {
        message_start_time,
        message_end_time,
        uncompressed_size,
        uncompressed_crc,
        compression: String::from_utf8_lossy(name).into_owned(),
        compressed_size: u64::from_le_bytes(take(body)?),
    };
    Some((header, body))
}

/// Parses a schema or channel definition; `None` for other records.
fn definition(opcode: u8, body: &[u8], health: &mut Health) -> Option<Item> {
    if !matches!(opcode, op::SCHEMA | op::CHANNEL) {
        return None;
    }
    match parse_mcap_record(opcode, body) {
        Ok(Record::Schema { header, .. }) => Some(Item::Schema {
            id: header.id,
            name: header.name,
        }),
        Ok(Record::Channel(channel)) => Some(Item::Channel(channel)),
        Ok(_) => None,
        Err(error) => {
            health.undecodable(0, || format!("record {opcode:#04x}: {error}"));
            None
        }
    }
}
