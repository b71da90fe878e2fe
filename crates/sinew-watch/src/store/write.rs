//! Single connection that writes the store.

use super::row::{COLUMNS, values, word};
use super::schema::migrate;
use super::{MAX_BUSY_TIME, Pending, Place, Reader, StoreError};
use rusqlite::{Connection, OpenFlags, TransactionBehavior, params, params_from_iter};
use sinew_files::NewFile;
use sinew_watch_core::{MonitorState, Transaction};
use std::fs::File;
use std::path::Path;

/// Compression level of stored states (zstd).
const COMPRESSION_LEVEL: i32 = 1;
/// Maximum number of journal entries of all robots together; the oldest are deleted.
const MAX_JOURNAL_ENTRIES: i64 = 1_000_000;
/// Number of commits between two checks of the journal's length.
const COMMITS_PER_JOURNAL_CHECK: u64 = 1000;

/// Store connection for writing.
#[derive(Debug)]
pub struct Store {
    connection: Connection,
    place: Place,
    commits: u64,
    /// Lock that is held as long as the store is open.
    _lock: Option<File>,
}

impl Store {
    /// Opens a store, creates it if missing, and migrates an older one to this version.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the store is in use, damaged or newer, or the system reports an error.
    pub fn open(place: Place) -> Result<Self, StoreError> {
        let lock = match &place {
            Place::Folder(folder) => Some(lock(folder)?),
            Place::Memory(_) => None,
        };
        let file = place.file();
        if lock.is_some() {
            super::check_content(Path::new(&file))?;
            create(Path::new(&file))?;
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
            | OpenFlags::SQLITE_OPEN_CREATE
            | OpenFlags::SQLITE_OPEN_URI
            | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = Connection::open_with_flags(&file, flags);
        let connection = connection
            .map_err(StoreError::from)
            .and_then(|mut connection| {
                connection.busy_timeout(MAX_BUSY_TIME)?;
                if lock.is_some() {
                    // Acknowledged data survive a power failure.
                    connection.pragma_update(None, "journal_mode", "WAL")?;
                    connection.pragma_update(None, "synchronous", "FULL")?;
                }
                connection.pragma_update(None, "foreign_keys", true)?;
                migrate(&mut connection, &file)?;
                check(&connection, &file)?;
                Ok(connection)
            });
        let connection = connection.map_err(|error| match error {
            error @ StoreError::Damaged { .. } => error,
            error if error.is_damaged() => StoreError::Damaged {
                file: file.clone(),
                reason: error.to_string(),
            },
            error => error,
        })?;
        Ok(Self {
            connection,
            place,
            commits: 0,
            _lock: lock,
        })
    }

    /// Opens another connection, for reading.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the store cannot be opened.
    pub fn reader(&self) -> Result<Reader, StoreError> {
        Reader::open(&self.place)
    }

    /// Stores transactions, either all or none. When this returns they are on the disk.
    ///
    /// A transaction that is already stored, by robot and number, is skipped.
    ///
    /// # Errors
    /// Returns a [`StoreError`]; none of them is stored then.
    pub fn commit(&mut self, transactions: &[Transaction]) -> Result<(), StoreError> {
        let sql = self
            .connection
            .transaction_with_behavior(TransactionBehavior::Immediate)?;
        for transaction in transactions {
            write(&sql, transaction)?;
        }
        self.commits += 1;
        if self.commits.is_multiple_of(COMMITS_PER_JOURNAL_CHECK) {
            sql.execute(
                "DELETE FROM journal WHERE id <= (SELECT max(id) FROM journal) - ?1",
                [MAX_JOURNAL_ENTRIES],
            )?;
        }
        Ok(sql.commit()?)
    }

    /// Records that the records of a robot type and month are in their file.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be written.
    pub fn exported(&mut self, written: &Pending) -> Result<(), StoreError> {
        let Pending {
            robot_type,
            month,
            number,
            last,
            ..
        } = written;
        self.connection.execute(
            "INSERT OR REPLACE INTO exported (robot_type, month, number, last_record) VALUES (?1, ?2, ?3, ?4)",
            params![robot_type, month, number, last],
        )?;
        Ok(())
    }

    /// Deletes the records of a robot before a time, except the best of each day, tendon and tensioning, on which the trend
    /// is based, the last of each tendon, and those that are in no monthly file yet; returns their number.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be written.
    pub fn thin(&mut self, robot: &str, before_utc_s: f64) -> Result<usize, StoreError> {
        // The order of `History`: the narrowest interval, of equal ones the first stored.
        let deleted = self.connection.execute(
            "DELETE FROM record WHERE robot = ?1 AND time_utc_s < ?2
             AND EXISTS (
                SELECT 1 FROM exported WHERE exported.robot_type = record.robot_type
                AND month = strftime('%Y-%m', record.time_utc_s, 'unixepoch') AND last_record >= record.id
             )
             AND id NOT IN (
                SELECT id FROM (
                    SELECT id, row_number() OVER (
                        PARTITION BY joint, baseline, CAST(time_utc_s / 86400.0 AS INTEGER)
                        ORDER BY offset_std_rad, time_utc_s, id
                    ) AS place
                    FROM record WHERE robot = ?1 AND time_utc_s < ?2 AND clock = 'utc'
                    AND offset_rad IS NOT NULL AND offset_std_rad IS NOT NULL
                ) WHERE place = 1
                UNION ALL
                SELECT id FROM (
                    SELECT id, row_number() OVER (
                        PARTITION BY joint ORDER BY time_utc_s DESC, id DESC
                    ) AS place
                    FROM record WHERE robot = ?1
                ) WHERE place = 1
             )",
            params![robot, before_utc_s],
        )?;
        Ok(deleted)
    }

    /// Moves the write-ahead log into the database as far as no reader prevents it.
    ///
    /// # Errors
    /// Returns a [`StoreError`] if the database cannot be written.
    pub fn checkpoint(&self) -> Result<(), StoreError> {
        let done = self
            .connection
            .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        Ok(done?)
    }
}

/// Locks the folder of a store, which is created if missing.
fn lock(folder: &Path) -> Result<File, StoreError> {
    let error = |source| StoreError::Folder {
        folder: folder.into(),
        source,
    };
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder).map_err(error)?;
    let mut options = File::options();
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let file = options
        .create(true)
        .append(true)
        .open(folder.join("watch.lock"))
        .map_err(error)?;
    sinew_files::lock::lock(&file).map_err(|holder| StoreError::Held {
        folder: folder.into(),
        holder,
    })?;
    Ok(file)
}

/// Creates the database, if missing, readable by its owner only; the files in its folder inherit this. It is complete before
/// it gets its name, so that an interrupted start leaves no empty database.
fn create(file: &Path) -> Result<(), StoreError> {
    if file.exists() {
        return Ok(());
    }
    let folder = sinew_files::folder_of(file);
    let error = |source| StoreError::Folder {
        folder: folder.into(),
        source,
    };
    let new = NewFile::begin(file).map_err(error)?;
    let mut connection = Connection::open(new.path())?;
    migrate(&mut connection, &file.display().to_string())?;
    connection.close().map_err(|(_, reason)| reason)?;
    new.finish(file).map(drop).map_err(error)
}

/// Checks the integrity of the database, as far as this is quick.
fn check(connection: &Connection, file: &str) -> Result<(), StoreError> {
    let reason: String = connection.query_row("PRAGMA quick_check(1)", [], |row| row.get(0))?;
    match reason.as_str() {
        "ok" => Ok(()),
        _ => Err(StoreError::Damaged {
            file: file.into(),
            reason,
        }),
    }
}

fn write(sql: &rusqlite::Transaction<'_>, transaction: &Transaction) -> Result<(), StoreError> {
    let Transaction { id, robot, .. } = transaction;
    let id = i64::try_from(*id).unwrap_or(i64::MAX);
    let robot_type = transaction.records.first().map(|r| r.robot_type.as_str());
    let new = sql
        .prepare_cached(
            "INSERT INTO robot (name, robot_type, last_transaction) VALUES (?1, coalesce(?2, ''), ?3)
             ON CONFLICT (name) DO UPDATE SET last_transaction = excluded.last_transaction,
             robot_type = coalesce(?2, robot_type) WHERE excluded.last_transaction > last_transaction",
        )?
        .execute(params![robot, robot_type, id])?;
    if new == 0 {
        return Ok(());
    }
    if let Some(from_utc_s) = transaction.replaced_from_utc_s {
        sql.prepare_cached("DELETE FROM record WHERE robot = ?1 AND time_utc_s >= ?2")?
            .execute(params![robot, from_utc_s])?;
    }
    let mut insert = sql.prepare_cached(&format!(
        "INSERT INTO record ({}) VALUES ({})",
        COLUMNS.join(", "),
        ["?"; COLUMNS.len()].join(", ")
    ))?;
    // SQLite gives the number of a deleted last record again: monthly files would be complete without the new one.
    let exported: Option<i64> =
        sql.query_row("SELECT max(last_record) FROM exported", [], |r| r.get(0))?;
    for record in &transaction.records {
        insert.execute(params_from_iter(values(record)))?;
        let id = sql.last_insert_rowid();
        if let Some(last) = exported.filter(|last| id <= *last) {
            sql.execute("UPDATE record SET id = ?1 WHERE id = ?2", [last + 1, id])?;
        }
    }
    if let Some(state_estimate) = &transaction.state {
        sql.prepare_cached(
            "INSERT INTO belief (robot, version, document) VALUES (?1, ?2, ?3)
             ON CONFLICT (robot) DO UPDATE SET version = excluded.version, document = excluded.document",
        )?
        .execute(params![robot, MonitorState::VERSION, packed(robot, state_estimate)?])?;
    }
    if let Some(stored) = &transaction.alarms {
        sql.prepare_cached("DELETE FROM alarm WHERE robot = ?1")?
            .execute([robot])?;
        let mut insert = sql.prepare_cached(
            "INSERT INTO alarm (robot, joint, condition, document) VALUES (?1, ?2, ?3, ?4)",
        )?;
        for alarm in &stored.alarms {
            let joint = alarm.key.joint.as_deref().unwrap_or("");
            let document = json("an alarm", robot, alarm)?;
            insert.execute(params![robot, joint, word(&alarm.key.condition), document])?;
        }
    }
    let mut insert = sql.prepare_cached(
        "INSERT INTO journal (robot, time_utc_s, event, document) VALUES (?1, ?2, ?3, ?4)",
    )?;
    for entry in &transaction.journal {
        let event = serde_json::to_value(&entry.event).ok();
        let event = event.as_ref().and_then(|e| e.get("event")?.as_str());
        let document = json("an entry of the journal", robot, entry)?;
        insert.execute(params![
            robot,
            entry.time_utc_s,
            event.unwrap_or(""),
            document
        ])?;
    }
    Ok(())
}

fn json<T: serde::Serialize>(
    what: &'static str,
    robot: &str,
    value: &T,
) -> Result<String, StoreError> {
    serde_json::to_string(value).map_err(|reason| StoreError::Document {
        what,
        robot: robot.into(),
        reason: reason.to_string(),
    })
}

/// Serialises and compresses a state.
fn packed(robot: &str, state_estimate: &MonitorState) -> Result<Vec<u8>, StoreError> {
    let text = json("a state", robot, state_estimate)?;
    let packed = zstd::bulk::Compressor::new(COMPRESSION_LEVEL).and_then(|mut compressor| {
        // SQLite has no checksums: a changed byte would be another state.
        compressor.include_checksum(true)?;
        compressor.compress(text.as_bytes())
    });
    packed.map_err(|reason| StoreError::Document {
        what: "a state",
        robot: robot.into(),
        reason: reason.to_string(),
    })
}
