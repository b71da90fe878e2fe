//! Messages of an MCAP file, one record of it after the other.
//!
//! A record is taken when it is there as a whole. Some recorders write a chunk's head last, over what held its
//! place: such a chunk isn't there yet.

use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::BTreeMap;
use std::io::Read;

/// Longest record, and longest chunk packed or not, bytes.
const RECORD_MOST: usize = sinew_files::limits::CHUNK.length();
/// Operation code and length of a record, bytes.
const RECORD_HEAD: usize = 1 + 8;
/// Shortest chunk: its fixed fields, bytes.
const CHUNK_LEAST: u64 = 8 + 8 + 8 + 4 + 4 + 8;

/// A message of a recording.
pub(crate) struct Recorded<'a> {
    /// The file's number of the topic.
    pub(crate) channel: u16,
    pub(crate) topic: &'a str,
    pub(crate) schema: &'a str,
    /// The recorder's clock, ns.
    pub(crate) logged_ns: i64,
    pub(crate) cdr: &'a [u8],
}

/// What the next bytes of a file are.
#[derive(Debug, PartialEq)]
enum Piece {
    /// Not there yet as a whole.
    Torn,
    /// So many bytes, which belong together.
    Whole(usize),
    /// Nothing that could be read.
    Broken(String),
}

/// What follows a piece.
#[derive(Debug, PartialEq)]
pub(crate) enum State {
    /// The next one.
    Wants,
    /// Nothing: the recording was closed.
    Ended,
    /// The piece can't be read; it may be given once more.
    Broken(String),
}

/// Reads an MCAP file from its start, as far as its bytes go.
pub(crate) struct Records {
    reader: LinearReader,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// Bytes of the pieces read.
    pub(crate) read: u64,
}

struct Channel {
    topic: String,
    schema: String,
    is_cdr: bool,
}

fn reader(skips_magic: bool) -> LinearReader {
    // A chunk is checked before its first message is used, so a torn one gives nothing wrong.
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(skips_magic)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(RECORD_MOST);
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

    /// What comes next in a file that holds `available` bytes more, the first of which are `bytes`.
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
        let no_chunk = !(CHUNK_LEAST..u64::MAX).contains(&length);
        let holds_a_place = opcode == 0 || opcode == op::CHUNK && no_chunk;
        if holds_a_place {
            return Piece::Torn;
        }
        if length > RECORD_MOST as u64 {
            return Piece::Broken(format!(
                "record {opcode:#04x} of {length} bytes; at most {RECORD_MOST} are read"
            ));
        }
        let whole = RECORD_HEAD as u64 + length;
        match whole > available {
            true => Piece::Torn,
            false => Piece::Whole(whole as usize),
        }
    }

    /// Reads the next piece of a file that holds `available` bytes more into `record`, as a whole; `false`: it isn't
    /// there yet, or there is none.
    ///
    /// # Errors
    /// Nothing that could be read, or the system refuses.
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
                Piece::Broken(why) => return Err(why),
            };
            let missing = (wanted - record.len()) as u64;
            let read = source.take(missing).read_to_end(record);
            if (read.map_err(|e| e.to_string())? as u64) < missing {
                return Ok(false);
            }
        }
    }

    /// A whole piece; `on` gets its messages, `false` of it stops.
    pub(crate) fn feed(&mut self, piece: &[u8], on: impl FnMut(Recorded<'_>) -> bool) -> State {
        let state = self.take(piece, on);
        match state {
            // What is left of it in the reader is of no use.
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
            match mcap::parse_record(opcode, data) {
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
                Err(error) => return State::Broken(error.to_string()),
            }
        }
    }
}
