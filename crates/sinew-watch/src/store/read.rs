//! Connections that read, while the one that writes goes on.

use super::row::{COLUMNS, record};
use super::{BUSY, Place, StoreError};
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, ToSql, params};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sinew_watch_core::alarm::{Alarm, AlarmsStored};
use sinew_watch_core::journal::Entry;
use sinew_watch_core::{Belief, History, Record, Stored};

/// A belief unpacked is no larger than a baseline may be.
const BELIEF_MOST: usize = sinew_files::limits::BASELINE.length();

/// A connection that reads.
#[derive(Debug)]
pub struct Reader {
    connection: Connection,
}

/// Which records are asked for.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RecordQuery {
    /// Of this robot.
    pub robot: Option<String>,
    /// Of this joint.
    pub joint: Option<String>,
    /// From this time on, s since 1970 UTC.
    pub from_utc_s: Option<f64>,
    /// Before this time, s since 1970 UTC.
    pub to_utc_s: Option<f64>,
    /// So many at most, the newest; of JSON 1000, and no more than 100,000.
    pub most: Option<u64>,
}

/// Which entries of the journal.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JournalQuery {
    /// Of this robot; `None`: of all.
    pub robot: Option<String>,
    /// Of this kind; `None`: of all.
    pub event: Option<String>,
    /// Older than the entry of this number.
    pub before: Option<i64>,
    /// So many at most.
    pub most: u64,
}

/// An entry of the journal with its number and robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JournalEntry {
    /// Number that rises from one to the next.
    pub id: i64,
    /// Name of the robot in the configuration.
    pub robot: String,
    /// The entry of the journal.
    #[serde(flatten)]
    pub entry: Entry,
}

impl Reader {
    /// Opens a store for reading; another process may have it open.
    ///
    /// # Errors
    /// [`StoreError`]: there is none, or it can't be read.
    pub fn open(place: &Place) -> Result<Self, StoreError> {
        let access = match place {
            // Shared memory beside the database has to be written even to read it.
            Place::Folder(_) => OpenFlags::SQLITE_OPEN_READ_ONLY,
            Place::Memory(_) => OpenFlags::SQLITE_OPEN_READ_WRITE,
        };
        let flags = access | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = Connection::open_with_flags(place.file(), flags)?;
        connection.busy_timeout(BUSY)?;
        connection.pragma_update(None, "query_only", true)?;
        Ok(Self { connection })
    }

    /// Looks whether it is a store that this program can go on with.
    ///
    /// # Errors
    /// [`StoreError`]: another program's, a newer one's, or it can't be read.
    pub fn check(&self) -> Result<(), StoreError> {
        let path = self.connection.path().unwrap_or_default();
        super::schema::version(&self.connection, path).map(drop)
    }

    pub(super) fn connection(&self) -> &Connection {
        &self.connection
    }

    /// What a robot's monitor goes on from; nothing, of one that was never watched.
    ///
    /// # Errors
    /// [`StoreError`]; of a belief or an alarm that can't be read, so that it is not begun anew silently.
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
            belief: self.belief(robot)?,
            alarms: AlarmsStored {
                alarms: self.alarms(robot)?,
            },
            history,
            last_id: u64::try_from(last).unwrap_or(0),
        })
    }

    fn belief(&self, robot: &str) -> Result<Option<Belief>, StoreError> {
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
        let refuse = |why: String| StoreError::Document {
            what: "the belief",
            robot: robot.into(),
            why,
        };
        let text =
            zstd::bulk::decompress(&packed, BELIEF_MOST).map_err(|e| refuse(e.to_string()))?;
        let belief: Belief = serde_json::from_slice(&text).map_err(|e| refuse(e.to_string()))?;
        match belief.version {
            Belief::VERSION => Ok(Some(belief)),
            other => Err(refuse(format!(
                "it has version {other}, this program knows version {}",
                Belief::VERSION
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

    /// Records in the order of time, each given to `take` as it is read; so many there were.
    ///
    /// # Errors
    /// [`StoreError`], or what `take` refuses.
    pub fn each_record(
        &self,
        query: &RecordQuery,
        mut take: impl FnMut(Record) -> Result<(), StoreError>,
    ) -> Result<u64, StoreError> {
        let columns = COLUMNS.join(", ");
        let mut which = String::from("1");
        let mut values: Vec<&dyn ToSql> = Vec::new();
        let conditions: [(&str, Option<&dyn ToSql>); 4] = [
            ("robot =", query.robot.as_ref().map(|v| v as _)),
            ("joint =", query.joint.as_ref().map(|v| v as _)),
            ("time_utc_s >=", query.from_utc_s.as_ref().map(|v| v as _)),
            ("time_utc_s <", query.to_utc_s.as_ref().map(|v| v as _)),
        ];
        for (condition, value) in conditions {
            if let Some(value) = value {
                which += &format!(" AND {condition} ?");
                values.push(value);
            }
        }
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

    /// Records in the order of time.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn records(&self, query: &RecordQuery) -> Result<Vec<Record>, StoreError> {
        let mut out = Vec::new();
        self.each_record(query, |record| {
            out.push(record);
            Ok(())
        })?;
        Ok(out)
    }

    /// Entries of the journal, the newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn journal(&self, query: &JournalQuery) -> Result<Vec<JournalEntry>, StoreError> {
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

    /// Robots there are, in the order of names.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn robots(&self) -> Result<Vec<String>, StoreError> {
        let mut statement = self
            .connection
            .prepare_cached("SELECT name FROM robot ORDER BY name")?;
        let names = statement.query_map([], |row| row.get(0))?;
        Ok(names.collect::<Result<_, _>>()?)
    }
}

/// What was stored as JSON.
fn document<T: DeserializeOwned>(
    what: &'static str,
    robot: &str,
    text: &str,
) -> Result<T, StoreError> {
    serde_json::from_str(text).map_err(|why| StoreError::Document {
        what,
        robot: robot.into(),
        why: why.to_string(),
    })
}
