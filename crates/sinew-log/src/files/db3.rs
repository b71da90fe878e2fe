//! ROS 2 bags that are SQLite files: a table of topics, a table of messages.

use std::collections::BTreeMap;
use std::io::{Error, Read as _, Result};
use std::path::Path;

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, params};

use super::mcap::BagReader;
use super::mcap::messages::{Item, Messages, Summary};
use super::read_seek::ReadSeek;
use super::reader::{Format, Progress};
use super::spool::ZSTD_MAGIC;
use crate::error::LogError;
use crate::health::Health;
use crate::live::survey::Topic;
use crate::options::OpenOptions;
use sinew_files::{Budget, ProcessorTime};

/// Messages fetched at a time.
const BATCH: i64 = 256;

/// The messages of a bag, in the order of their times.
pub(super) struct Db3 {
    bag: Connection,
    /// File that contains the bag, if it was unpacked.
    _kept: Box<dyn ReadSeek>,
    bytes: u64,
    limit: usize,
    time: ProcessorTime,
    topics: BTreeMap<u16, Topic>,
    first_ns: i64,
    last_ns: i64,
    batch: Vec<Row>,
    at: usize,
    /// Time and number of the last message fetched.
    fetched: (i64, i64),
    ended: bool,
}

struct Row {
    topic: u16,
    time_ns: i64,
    data: Vec<u8>,
}

/// A bag as a recording.
pub(super) type Db3Reader = BagReader<Db3>;

/// Opens the bag at `path`, which `kept` reads from.
pub(super) fn open(
    kept: Box<dyn ReadSeek>,
    path: &Path,
    file: &str,
    options: &OpenOptions,
) -> std::result::Result<Db3Reader, LogError> {
    let to_error =
        |e: rusqlite::Error| LogError::not_a_recording(file, format!("not a ROS 2 bag: {e}"));
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let bag = Connection::open_with_flags(path, flags).map_err(to_error)?;
    if let Some(computed) = computed_table(&bag).map_err(to_error)? {
        return Err(LogError::not_a_recording(
            file,
            format!(
                "not a ROS 2 bag: '{computed}' is a view, a virtual table or has generated columns; \
                 rosbag2 writes plain tables"
            ),
        ));
    }
    let bag = Db3::of(bag, kept, path, &options.budget).map_err(to_error)?;
    BagReader::of(bag, file, options)
}

/// Table of a bag whose rows SQLite would compute: a hostile file computes without end, or without bound.
fn computed_table(bag: &Connection) -> rusqlite::Result<Option<String>> {
    bag.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
    let other = "SELECT name FROM sqlite_schema WHERE lower(name) IN ('topics', 'messages') \
                 AND (type <> 'table' OR sql LIKE 'create virtual%')";
    let generated = "SELECT t.name FROM (SELECT 'topics' AS name UNION SELECT 'messages') AS t, \
                     pragma_table_xinfo(t.name) AS c WHERE c.hidden <> 0";
    for text in [other, generated] {
        let found = bag.query_row(text, [], |row| row.get(0)).optional()?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

impl Db3 {
    fn of(
        bag: Connection,
        kept: Box<dyn ReadSeek>,
        path: &Path,
        budget: &Budget,
    ) -> rusqlite::Result<Self> {
        let bytes = std::fs::metadata(path).map_or(0, |file| file.len());
        let mut topics = BTreeMap::new();
        let text = "SELECT id, name, type, serialization_format FROM topics ORDER BY id";
        let mut statement = bag.prepare(text)?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let topic = Topic {
                name: row.get(1)?,
                schema: row.get(2)?,
                encoding: row.get(3)?,
                // Not counted: that would read the whole file.
                messages: u64::MAX,
                ..Topic::default()
            };
            topics.insert(row.get(0)?, topic);
        }
        drop(rows);
        drop(statement);
        let ends = "SELECT coalesce(min(timestamp), 0), coalesce(max(timestamp), 0) FROM messages";
        let ends = bag.query_row(ends, [], |row| Ok((row.get(0)?, row.get(1)?)));
        // A damaged index costs the progress, not the messages.
        let (first_ns, last_ns) = ends.unwrap_or((0, 0));
        Ok(Db3 {
            bag,
            _kept: kept,
            bytes,
            limit: budget.memory.length(),
            time: ProcessorTime::new(budget, bytes),
            topics,
            first_ns,
            last_ns,
            batch: Vec::new(),
            at: 0,
            fetched: (i64::MIN, i64::MIN),
            ended: false,
        })
    }

    fn fetch(&mut self) -> rusqlite::Result<()> {
        self.batch.clear();
        self.at = 0;
        // A message beyond the limit becomes an empty one, which its decoder rejects.
        let text = "SELECT id, topic_id, timestamp, CASE WHEN length(data) <= ?4 THEN data END \
                    FROM messages WHERE (timestamp, id) > (?1, ?2) ORDER BY timestamp, id LIMIT ?3";
        let limit = i64::try_from(self.limit).unwrap_or(i64::MAX);
        let mut statement = self.bag.prepare(text)?;
        let mut rows = statement.query(params![self.fetched.0, self.fetched.1, BATCH, limit])?;
        let mut bytes = 0;
        while let Some(row) = rows.next()? {
            let time_ns = row.get(2)?;
            let data: Vec<u8> = row.get::<_, Option<_>>(3)?.unwrap_or_default();
            bytes += data.len();
            self.fetched = (time_ns, row.get(0)?);
            self.batch.push(Row {
                topic: row.get(1)?,
                time_ns,
                data,
            });
            if bytes >= self.limit {
                break;
            }
        }
        Ok(())
    }

    /// Decompresses a message that was compressed separately.
    fn unpack(&mut self) -> Result<()> {
        let limit = self.limit;
        let data = &mut self.batch[self.at].data;
        if data.starts_with(ZSTD_MAGIC) {
            let unpacked = self.time.spend(|| {
                let decoder = zstd::Decoder::new(&data[..])?;
                let mut whole = Vec::new();
                decoder.take(limit as u64).read_to_end(&mut whole)?;
                Result::Ok(whole)
            });
            *data = unpacked.map_err(Error::other)??;
        }
        Ok(())
    }
}

impl Messages for Db3 {
    const FORMAT: Format = Format::Db3;

    fn next(&mut self, health: &mut Health) -> Result<Item> {
        // A decompressed message may be long: one at a time is kept.
        if let Some(last) = self.batch.get_mut(self.at) {
            last.data = Vec::new();
        }
        // Before the first batch nothing has been met.
        self.at += usize::from(!self.batch.is_empty());
        if self.at >= self.batch.len() && !self.ended {
            if let Err(error) = self.fetch() {
                let done = self.progress().bytes_done;
                let reason = format!("{error}; the messages after it are lost");
                health.damaged(done, self.bytes - done, Some(self.fetched.0), reason);
                self.ended = true;
            }
            self.ended |= self.batch.is_empty();
        }
        if self.ended {
            return Ok(Item::End);
        }
        self.unpack()?;
        let row = &self.batch[self.at];
        Ok(Item::Message {
            channel: row.topic,
            log_time_ns: u64::try_from(row.time_ns).unwrap_or(0),
        })
    }

    fn payload(&self) -> &[u8] {
        self.batch.get(self.at).map_or(&[], |row| &row.data)
    }

    fn summary(&mut self) -> Result<Option<Summary>> {
        Ok(Some(Summary {
            topics: self.topics.clone(),
            chunks: Vec::new(),
        }))
    }

    fn rewind(&mut self) -> Result<()> {
        self.batch.clear();
        (self.at, self.ended) = (0, false);
        self.fetched = (i64::MIN, i64::MIN);
        Ok(())
    }

    fn restart(&mut self, _offset: u64) -> Result<()> {
        Err(Error::other("a table has no offsets"))
    }

    fn progress(&self) -> Progress {
        let length = (self.last_ns as f64 - self.first_ns as f64).max(1.0);
        let done = self.batch.get(self.at).map_or(0.0, |row| {
            (row.time_ns as f64 - self.first_ns as f64) / length
        });
        Progress {
            bytes_done: match self.ended {
                true => self.bytes,
                false => (done.clamp(0.0, 1.0) * self.bytes as f64) as u64,
            },
            bytes_total: self.bytes,
        }
    }
}
