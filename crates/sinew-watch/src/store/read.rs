//! Connections that read while the store is being written.

use super::row::{COLUMNS, record};
use super::{MAX_BUSY_TIME, Place, StoreError};
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Row, ToSql, params};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sinew_files::NewFile;
use sinew_watch_core::alarm::{Alarm, AlarmsStored};
use sinew_watch_core::journal::Entry;
use sinew_watch_core::{History, MonitorState, Record, Stored};
use std::path::Path;

/// Maximum length of an unpacked state, that of a baseline, bytes.
const MAX_STATE_BYTES: usize = sinew_files::Budget::TABLE.memory.most as usize;

/// Connection that reads the store.
#[derive(Debug)]
pub struct Reader {
    connection: Connection,
}

/// Selection of records.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RecordQuery {
    /// Only records of this robot.
    pub robot: Option<String>,
    /// Only records of this joint.
    pub joint: Option<String>,
    /// Start of the time range, s since 1970 UTC, inclusive.
    pub from_utc_s: Option<f64>,
    /// End of the time range, s since 1970 UTC, exclusive.
    pub to_utc_s: Option<f64>,
    /// Only records before the record with this number in chronological order: `older` of the previous response.
    pub before: Option<i64>,
    /// Maximum number of records, the newest; for JSON the default is 1000, the limit 100,000.
    pub most: Option<u64>,
}

/// Position of a record in chronological order: start of its session, s since 1970 UTC, and its number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Start of the session, s since 1970 UTC.
    pub time_utc_s: f64,
    /// Number of the record.
    pub id: i64,
}

/// First and last record of a selection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordSpan {
    /// Position of the first record.
    pub first: Position,
    /// Position of the last record.
    pub last: Position,
    /// Whether the limit excludes older records.
    pub has_older: bool,
}

/// Condition of a selection with its values.
struct Selection<'q> {
    /// Name of the index that yields the records in chronological order without sorting.
    index: &'static str,
    condition: String,
    values: Vec<&'q dyn ToSql>,
}

impl RecordQuery {
    fn selection(&self) -> Selection<'_> {
        let mut condition = String::from("1");
        let mut values: Vec<&dyn ToSql> = Vec::new();
        let conditions: [(&str, Option<&dyn ToSql>); 5] = [
            ("robot = ?", self.robot.as_ref().map(|v| v as _)),
            ("joint = ?", self.joint.as_ref().map(|v| v as _)),
            ("time_utc_s >= ?", self.from_utc_s.as_ref().map(|v| v as _)),
            ("time_utc_s < ?", self.to_utc_s.as_ref().map(|v| v as _)),
            (
                "(time_utc_s, id) < (SELECT time_utc_s, id FROM record WHERE id = ?)",
                self.before.as_ref().map(|v| v as _),
            ),
        ];
        for (text, value) in conditions {
            if let Some(value) = value {
                condition += " AND ";
                condition += text;
                values.push(value);
            }
        }
        let index = match (&self.robot, &self.joint) {
            (Some(_), Some(_)) => "record_of_tendon",
            _ => "record_by_time",
        };
        Selection {
            index,
            condition,
            values,
        }
    }
}

/// Disk usage of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotUsage {
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Number of records.
    pub records: i64,
    /// Number of days with records.
    pub days: i64,
    /// Records and journal with their indices, bytes.
    pub history_bytes: f64,
    /// Compressed state of the monitor, bytes.
    pub state_bytes: i64,
}

/// Selection of journal entries.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JournalFilter {
    /// Only entries of this robot; `None`: all.
    pub robot: Option<String>,
    /// Only entries of this kind; `None`: all.
    pub event: Option<String>,
    /// Only entries older than the entry with this number.
    pub before: Option<i64>,
    /// Maximum number of entries.
    pub most: u64,
}

/// Journal entry with its number and robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JournalEntry {
    /// Number of the entry, ascending.
    pub id: i64,
    /// Name of the robot in the configuration.
    pub robot: String,
    /// Journal entry as data.
    #[serde(flatten)]
    pub entry: Entry,
}

impl Reader {
    /// Opens a store for reading; another process may have it open.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the store does not exist or cannot be read.
    pub fn open(place: &Place) -> Result<Self, StoreError> {
        let access = match place {
            // The shared-memory file next to the database must be writable even for reading.
            Place::Folder(_) => OpenFlags::SQLITE_OPEN_READ_ONLY,
            Place::Memory(_) => OpenFlags::SQLITE_OPEN_READ_WRITE,
        };
        let flags = access | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = Connection::open_with_flags(place.file(), flags)?;
        connection.busy_timeout(MAX_BUSY_TIME)?;
        connection.pragma_update(None, "query_only", true)?;
        Ok(Self { connection })
    }

    /// Checks whether the store can be used by this program.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if it belongs to another program, is newer, or cannot be read.
    pub fn check(&self) -> Result<(), StoreError> {
        let path = self.connection.path().unwrap_or_default();
        super::check_content(Path::new(path))?;
        super::schema::version(&self.connection, path).map(drop)
    }

    pub(super) fn connection(&self) -> &Connection {
        &self.connection
    }

    /// Returns the stored state from which the monitor of a robot continues; empty if it was never monitored.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if a state or an alarm is invalid, so that the monitor does not silently restart
    /// without it.
    pub fn stored(&self, robot: &str) -> Result<Stored, StoreError> {
        let last: Option<i64> = self
            .connection
            .query_row(
                "SELECT last_transaction FROM robot WHERE name = ?1",
                [robot],
                |r| r.get(0),
            )
            .optional()?;
        let Some(last) = last else {
            return Ok(Stored::default());
        };
        let mut history = History::default();
        let own = RecordQuery {
            robot: Some(robot.into()),
            ..RecordQuery::default()
        };
        self.each_record(&own, |record| {
            history.push(&record);
            Ok(())
        })?;
        Ok(Stored {
            state: self.state_estimate(robot)?,
            alarms: AlarmsStored {
                alarms: self.alarms(robot)?,
            },
            history,
            last_id: u64::try_from(last).unwrap_or(0),
        })
    }

    fn state_estimate(&self, robot: &str) -> Result<Option<MonitorState>, StoreError> {
        let packed: Option<Vec<u8>> = self
            .connection
            .query_row(
                "SELECT document FROM belief WHERE robot = ?1",
                [robot],
                |r| r.get(0),
            )
            .optional()?;
        let Some(packed) = packed else {
            return Ok(None);
        };
        let error = |reason: String| StoreError::Document {
            what: "the state",
            robot: robot.into(),
            reason,
        };
        let text =
            zstd::bulk::decompress(&packed, MAX_STATE_BYTES).map_err(|e| error(e.to_string()))?;
        let state_estimate: MonitorState =
            serde_json::from_slice(&text).map_err(|e| error(e.to_string()))?;
        match state_estimate.version {
            1..=MonitorState::VERSION => Ok(Some(state_estimate)),
            other => Err(error(format!(
                "version {other} is unsupported, expected at most {}",
                MonitorState::VERSION
            ))),
        }
    }

    fn alarms(&self, robot: &str) -> Result<Vec<Alarm>, StoreError> {
        let mut of_robot = self.connection.prepare_cached(
            "SELECT document FROM alarm WHERE robot = ?1 ORDER BY joint, condition",
        )?;
        let documents = of_robot.query_map([robot], |row| row.get::<_, String>(0))?;
        documents
            .map(|text| document("an alarm", robot, &text?))
            .collect()
    }

    /// Passes records in chronological order to `take` as they are read; returns their number.
    ///
    /// # Errors
    /// Returns a [`StoreError`], or the error of `take`.
    pub fn each_record(
        &self,
        query: &RecordQuery,
        mut take: impl FnMut(Record) -> Result<(), StoreError>,
    ) -> Result<u64, StoreError> {
        let columns = COLUMNS.join(", ");
        let Selection {
            condition: which,
            mut values,
            ..
        } = query.selection();
        let most = query.most.map(|n| i64::try_from(n).unwrap_or(i64::MAX));
        let text = match &most {
            None => format!("SELECT {columns} FROM record WHERE {which} ORDER BY time_utc_s, id"),
            Some(most) => {
                values.push(most);
                format!(
                    "SELECT {columns} FROM (SELECT * FROM record WHERE {which} \
                     ORDER BY time_utc_s DESC, id DESC LIMIT ?) ORDER BY time_utc_s, id"
                )
            }
        };
        let mut statement = self.connection.prepare_cached(&text)?;
        let mut rows = statement.query(&values[..])?;
        let mut count = 0;
        while let Some(row) = rows.next()? {
            take(record(row)?)?;
            count += 1;
        }
        Ok(count)
    }

    /// Returns first and last record of a selection; `None`: it has none.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn span(&self, query: &RecordQuery) -> Result<Option<RecordSpan>, StoreError> {
        let Selection {
            index,
            condition,
            values,
        } = query.selection();
        let at = |order: &str, offset: u64| {
            let text = format!(
                "SELECT time_utc_s, id FROM record INDEXED BY {index} WHERE {condition} \
                 ORDER BY time_utc_s {order}, id {order} LIMIT 1 OFFSET {offset}"
            );
            let mut statement = self.connection.prepare_cached(&text)?;
            let position = |row: &Row<'_>| {
                Ok(Position {
                    time_utc_s: row.get(0)?,
                    id: row.get(1)?,
                })
            };
            statement.query_row(&values[..], position).optional()
        };
        let most = query.most.unwrap_or(u64::from(u32::MAX)).max(1);
        let Some(last) = at("DESC", 0)? else {
            return Ok(None);
        };
        Ok(Some(match at("DESC", most - 1)? {
            Some(first) => RecordSpan {
                first,
                last,
                has_older: at("DESC", most)?.is_some(),
            },
            None => RecordSpan {
                first: at("ASC", 0)?.unwrap_or(last),
                last,
                has_older: false,
            },
        }))
    }

    /// Passes at most `most` records of a selection between two positions, both included, to `take`; returns the position
    /// of the next record, if any.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn piece(
        &self,
        query: &RecordQuery,
        [from, to]: [Position; 2],
        most: usize,
        mut take: impl FnMut(Record),
    ) -> Result<Option<Position>, StoreError> {
        let Selection {
            index,
            condition,
            mut values,
        } = query.selection();
        let text = format!(
            "SELECT {}, id FROM record INDEXED BY {index} WHERE {condition} \
             AND (time_utc_s, id) >= (?, ?) AND (time_utc_s, id) <= (?, ?) ORDER BY time_utc_s, id",
            COLUMNS.join(", ")
        );
        values.extend([
            &from.time_utc_s as &dyn ToSql,
            &from.id,
            &to.time_utc_s,
            &to.id,
        ]);
        let mut statement = self.connection.prepare_cached(&text)?;
        let mut rows = statement.query(&values[..])?;
        let mut count = 0;
        while let Some(row) = rows.next()? {
            if count == most {
                return Ok(Some(Position {
                    time_utc_s: row.get("time_utc_s")?,
                    id: row.get("id")?,
                }));
            }
            take(record(row)?);
            count += 1;
        }
        Ok(None)
    }

    /// Whether there is a record with this number.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn has_record(&self, id: i64) -> Result<bool, StoreError> {
        let mut statement = self
            .connection
            .prepare_cached("SELECT 1 FROM record WHERE id = ?1")?;
        Ok(statement.exists([id])?)
    }

    /// Copies the database into a file as it is at this moment, while the monitor continues to store; returns the size of
    /// the copy, bytes.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if reading or writing fails; an existing file remains unchanged then.
    pub fn backup(&self, target: &Path) -> Result<u64, StoreError> {
        let folder = sinew_files::folder_of(target);
        let error = |source| StoreError::Folder {
            folder: folder.into(),
            source,
        };
        let new = NewFile::begin(target).map_err(error)?;
        let path = new.path().display().to_string();
        // SQLite counts this as writing, although it writes only the copy.
        self.connection.pragma_update(None, "query_only", false)?;
        let copied = self.connection.execute("VACUUM INTO ?1", [path]);
        self.connection.pragma_update(None, "query_only", true)?;
        copied?;
        new.finish(target).map_err(error)
    }

    /// Returns the disk usage of every robot in the database, sorted by name.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn usage(&self) -> Result<Vec<RobotUsage>, StoreError> {
        // Pages of a table and its indices in equal shares of its rows.
        let mut statement = self.connection.prepare_cached(
            "WITH pages AS (
                SELECT tbl_name AS name, sum(pgsize) AS bytes
                FROM dbstat JOIN sqlite_schema USING (name) GROUP BY 1
             ), share AS (
                SELECT (SELECT bytes FROM pages WHERE name = 'record') / max(1.0, (SELECT count(*) FROM record)) AS record,
                       (SELECT bytes FROM pages WHERE name = 'journal') / max(1.0, (SELECT count(*) FROM journal)) AS entry
             )
             SELECT name,
                    (SELECT count(*) FROM record WHERE robot = name),
                    (SELECT count(DISTINCT CAST(time_utc_s / 86400.0 AS INTEGER)) FROM record WHERE robot = name),
                    (SELECT count(*) FROM record WHERE robot = name) * share.record
                    + (SELECT count(*) FROM journal WHERE robot = name) * share.entry,
                    coalesce((SELECT length(document) FROM belief WHERE robot = name), 0)
             FROM robot, share ORDER BY name",
        )?;
        let rows = statement.query_map([], |row| {
            Ok(RobotUsage {
                robot: row.get(0)?,
                records: row.get(1)?,
                days: row.get(2)?,
                history_bytes: row.get(3)?,
                state_bytes: row.get(4)?,
            })
        })?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// Returns records in chronological order.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn records(&self, query: &RecordQuery) -> Result<Vec<Record>, StoreError> {
        let mut out = Vec::new();
        self.each_record(query, |record| {
            out.push(record);
            Ok(())
        })?;
        Ok(out)
    }

    /// Returns journal entries, the newest first.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn journal(&self, query: &JournalFilter) -> Result<Vec<JournalEntry>, StoreError> {
        let mut statement = self.connection.prepare_cached(
            "SELECT id, robot, document FROM journal WHERE (?1 IS NULL OR robot = ?1) \
             AND (?2 IS NULL OR event = ?2) AND (?3 IS NULL OR id < ?3) ORDER BY id DESC LIMIT ?4",
        )?;
        let most = i64::try_from(query.most).unwrap_or(i64::MAX);
        let values = params![query.robot, query.event, query.before, most];
        let rows = statement.query_map(values, |row| {
            Ok((
                row.get(0)?,
                row.get::<_, String>(1)?,
                row.get::<_, String>(2)?,
            ))
        })?;
        rows.map(|row| {
            let (id, robot, text) = row?;
            let entry = document("an entry of the journal", &robot, &text)?;
            Ok(JournalEntry { id, robot, entry })
        })
        .collect()
    }

    /// Returns the names of all robots, sorted.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be read.
    pub fn robots(&self) -> Result<Vec<String>, StoreError> {
        let mut statement = self
            .connection
            .prepare_cached("SELECT name FROM robot ORDER BY name")?;
        let names = statement.query_map([], |row| row.get(0))?;
        Ok(names.collect::<Result<_, _>>()?)
    }
}

/// Parses a document stored as JSON.
pub(super) fn document<T: DeserializeOwned>(
    what: &'static str,
    robot: &str,
    text: &str,
) -> Result<T, StoreError> {
    serde_json::from_str(text).map_err(|reason| StoreError::Document {
        what,
        robot: robot.into(),
        reason: reason.to_string(),
    })
}
