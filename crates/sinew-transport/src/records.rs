//! Messages of an MCAP file, record by record.
//!
//! A record is read when it is complete. Some recorders write the header of a chunk last, over a placeholder: such a
//! chunk counts as incomplete.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::BTreeMap;
use std::io::Read;

/// Length of operation code and length field of a record, bytes.
const RECORD_HEAD: usize = 1 + 8;
/// Minimum length of a chunk: its fixed fields, bytes.
const MIN_CHUNK_BYTES: u64 = 8 + 8 + 8 + 4 + 4 + 8;

/// Message of a recording.
pub(crate) struct Recorded<'a> {
    /// Channel number of the topic in the file.
    pub(crate) channel: u16,
    pub(crate) topic: &'a str,
    pub(crate) schema: &'a str,
    /// Log time by the clock of the recorder, ns.
    pub(crate) logged_ns: i64,
    pub(crate) cdr: &'a [u8],
}

/// State of the next bytes of a file.
#[derive(Debug, PartialEq)]
enum Piece {
    /// Incomplete: more bytes are needed.
    Torn,
    /// Complete piece of this length, bytes.
    Whole(usize),
    /// Unreadable, with the reason.
    Broken(String),
}

/// State after a piece.
#[derive(Debug, PartialEq)]
pub(crate) enum State {
    /// The reader expects the next piece.
    Wants,
    /// The recording was closed.
    Ended,
    /// The piece is unreadable; it may be passed again.
    Broken(String),
}

/// Reader of an MCAP file from its start to the last complete record.
pub(crate) struct Records {
    reader: LinearReader,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// Length of the pieces read so far, bytes.
    pub(crate) read: u64,
}

struct Channel {
    topic: String,
    schema: String,
    is_cdr: bool,
}

/// Maximum length of a record, and of a chunk, compressed or not, bytes.
fn max_record_bytes() -> usize {
    sinew_files::Budget::RECORDING.memory.length()
}

fn reader(skips_magic: bool) -> LinearReader {
    // A chunk is checked before its first message is used, so that an incomplete one yields no wrong data.
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(skips_magic)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(max_record_bytes());
    LinearReader::new_with_options(options)
}

impl Records {
    pub(crate) fn new() -> Self {
        Records {
            reader: reader(false),
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            read: 0,
        }
    }

    /// Determines the next piece of a file with `available` further bytes, the first of which are `bytes`.
    fn piece(&self, bytes: &[u8], available: u64) -> Piece {
        if self.read == 0 {
            return match available < mcap::MAGIC.len() as u64 {
                true => Piece::Torn,
                false => Piece::Whole(mcap::MAGIC.len()),
            };
        }
        let Some(head) = bytes.first_chunk::<RECORD_HEAD>() else {
            return Piece::Torn;
        };
        let [opcode, length @ ..] = *head;
        let length = u64::from_le_bytes(length);
        let no_chunk = !(MIN_CHUNK_BYTES..u64::MAX).contains(&length);
        let holds_a_place = opcode == 0 || opcode == op::CHUNK && no_chunk;
        if holds_a_place {
            return Piece::Torn;
        }
        let most = max_record_bytes();
        if length > most as u64 {
            return Piece::Broken(format!(
                "record {opcode:#04x} has {length} bytes, limit {most} bytes"
            ));
        }
        let whole = RECORD_HEAD as u64 + length;
        match whole > available {
            true => Piece::Torn,
            false => Piece::Whole(whole as usize),
        }
    }

    /// Reads the next piece of a file with `available` further bytes into `record`, as a whole; returns `false` if it
    /// is incomplete or missing.
    ///
    /// # Errors
    /// Returns the reason if the record is unreadable or the system reports an error.
    pub(crate) fn next(
        &self,
        source: &mut impl Read,
        available: u64,
        record: &mut Vec<u8>,
    ) -> Result<bool, String> {
        record.clear();
        loop {
            let wanted = match self.piece(record, available) {
                Piece::Whole(whole) if record.len() >= whole => return Ok(true),
                Piece::Whole(whole) => whole,
                Piece::Torn if record.len() < RECORD_HEAD => RECORD_HEAD,
                Piece::Torn => return Ok(false),
                Piece::Broken(reason) => return Err(reason),
            };
            let missing = (wanted - record.len()) as u64;
            let read = source.take(missing).read_to_end(record);
            if (read.map_err(|e| e.to_string())? as u64) < missing {
                return Ok(false);
            }
        }
    }

    /// Processes a complete piece; `on` receives its messages and returns `false` to stop.
    pub(crate) fn feed(&mut self, piece: &[u8], on: impl FnMut(Recorded<'_>) -> bool) -> State {
        let state = self.take(piece, on);
        match state {
            // The remaining bytes in the reader are of no use.
            State::Broken(_) => self.reader = reader(self.read > 0),
            State::Wants | State::Ended => self.read += piece.len() as u64,
        }
        state
    }

    fn take(&mut self, piece: &[u8], mut on: impl FnMut(Recorded<'_>) -> bool) -> State {
        if piece.is_empty() {
            return State::Wants;
        }
        self.reader.insert(piece.len())[..piece.len()].copy_from_slice(piece);
        self.reader.notify_read(piece.len());
        loop {
            let (opcode, data) = match self.reader.next_event() {
                None => return State::Ended,
                Some(Err(error)) => return State::Broken(error.to_string()),
                Some(Ok(LinearReadEvent::ReadRequest(_))) => return State::Wants,
                Some(Ok(LinearReadEvent::Record { data, opcode })) => (opcode, data),
            };
            match sinew_log::parse_mcap_record(opcode, data) {
                Ok(Record::Schema { header, .. }) => {
                    self.schemas.insert(header.id, header.name);
                }
                Ok(Record::Channel(channel)) => {
                    let schema = self.schemas.get(&channel.schema_id);
                    let described = Channel {
                        topic: channel.topic,
                        schema: schema.cloned().unwrap_or_default(),
                        is_cdr: channel.message_encoding == "cdr",
                    };
                    self.channels.insert(channel.id, described);
                }
                Ok(Record::Message { header, data }) => {
                    let channel = self.channels.get(&header.channel_id);
                    let Some(channel) = channel.filter(|channel| channel.is_cdr) else {
                        continue;
                    };
                    let recorded = Recorded {
                        channel: header.channel_id,
                        topic: &channel.topic,
                        schema: &channel.schema,
                        logged_ns: i64::try_from(header.log_time).unwrap_or(i64::MAX),
                        cdr: &data,
                    };
                    if !on(recorded) {
                        return State::Wants;
                    }
                }
                Ok(Record::Footer(_)) => return State::Ended,
                Ok(_) => {}
                Err(reason) => return State::Broken(reason),
            }
        }
    }
}
