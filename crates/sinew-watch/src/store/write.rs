//! The one connection that writes.

use super::row::{COLUMNS, values, word};
use super::schema::migrate;
use super::{BUSY, Pending, Place, Reader, StoreError};
use rusqlite::{Connection, OpenFlags, TransactionBehavior, params, params_from_iter};
use sinew_watch_core::{Belief, Transaction};
use std::fs::File;
use std::path::Path;

/// A belief is packed so hard.
const PACKING: i32 = 1;
/// Entries of the journal that are kept, of all robots together; the oldest go first.
const JOURNAL_MOST: i64 = 1_000_000;
/// Every so many commits the journal is looked at.
const JOURNAL_EVERY: u64 = 1000;

/// The store, open for writing.
#[derive(Debug)]
pub struct Store {
    connection: Connection,
    place: Place,
    commits: u64,
    /// Held as long as the store is open.
    _lock: Option<File>,
}

impl Store {
    /// Opens a store, or makes it where there is none; brings an older one to this version.
    ///
    /// # Errors
    /// [`StoreError`]: held by another process, damaged, newer, or the system refuses.
    pub fn open(place: Place) -> Result<Self, StoreError> {
        let lock = match &place {
            Place::Folder(folder) => Some(lock(folder)?),
            Place::Memory(_) => None,
        };
        let file = place.file();
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE
            | OpenFlags::SQLITE_OPEN_CREATE
            | OpenFlags::SQLITE_OPEN_URI
            | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let opened = Connection::open_with_flags(&file, flags);
        let connection = opened.map_err(StoreError::from).and_then(|mut connection| {
            connection.busy_timeout(BUSY)?;
            if lock.is_some() {
                // Of what is acknowledged nothing is lost with the power.
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
                why: error.to_string(),
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

    /// Another connection, for reading.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn reader(&self) -> Result<Reader, StoreError> {
        Reader::open(&self.place)
    }

    /// Stores transactions, each as a whole, all of them or none. When this returns they are on the disk.
    ///
    /// One that is stored already, by its robot and number, is left out.
    ///
    /// # Errors
    /// [`StoreError`]; nothing of them is stored then.
    pub fn commit(&mut self, transactions: &[Transaction]) -> Result<(), StoreError> {
        let sql = self
            .connection
            .transaction_with_behavior(TransactionBehavior::Immediate)?;
        for transaction in transactions {
            write(&sql, transaction)?;
        }
        self.commits += 1;
        if self.commits.is_multiple_of(JOURNAL_EVERY) {
            sql.execute(
                "DELETE FROM journal WHERE id <= (SELECT max(id) FROM journal) - ?1",
                [JOURNAL_MOST],
            )?;
        }
        Ok(sql.commit()?)
    }

    /// Remembers that records of a type and month are in their file.
    ///
    /// # Errors
    /// [`StoreError`].
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

    /// Puts what is in the write-ahead log into the database, as far as no reader is in the way.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn checkpoint(&self) -> Result<(), StoreError> {
        let done = self
            .connection
            .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        Ok(done?)
    }
}

/// The lock of a store's folder, which is made where it isn't there.
fn lock(folder: &Path) -> Result<File, StoreError> {
    let refuse = |source| StoreError::Folder {
        folder: folder.into(),
        source,
    };
    std::fs::create_dir_all(folder).map_err(refuse)?;
    let mut options = File::options();
    let file = options
        .create(true)
        .append(true)
        .open(folder.join("watch.lock"))
        .map_err(refuse)?;
    sinew_files::lock::lock(&file).map_err(|holder| StoreError::Held {
        folder: folder.into(),
        holder,
    })?;
    Ok(file)
}

/// Looks whether the database is whole, as far as that is quick.
fn check(connection: &Connection, file: &str) -> Result<(), StoreError> {
    let why: String = connection.query_row("PRAGMA quick_check(1)", [], |row| row.get(0))?;
    match why.as_str() {
        "ok" => Ok(()),
        _ => Err(StoreError::Damaged {
            file: file.into(),
            why,
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
    let mut insert = sql.prepare_cached(&format!(
        "INSERT INTO record ({}) VALUES ({})",
        COLUMNS.join(", "),
        ["?"; COLUMNS.len()].join(", ")
    ))?;
    for record in &transaction.records {
        insert.execute(params_from_iter(values(record)))?;
    }
    if let Some(belief) = &transaction.belief {
        sql.prepare_cached(
            "INSERT INTO belief (robot, version, document) VALUES (?1, ?2, ?3)
             ON CONFLICT (robot) DO UPDATE SET version = excluded.version, document = excluded.document",
        )?
        .execute(params![robot, Belief::VERSION, packed(robot, belief)?])?;
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
    serde_json::to_string(value).map_err(|why| StoreError::Document {
        what,
        robot: robot.into(),
        why: why.to_string(),
    })
}

/// A belief as it is stored.
fn packed(robot: &str, belief: &Belief) -> Result<Vec<u8>, StoreError> {
    let text = json("a belief", robot, belief)?;
    zstd::bulk::compress(text.as_bytes(), PACKING).map_err(|why| StoreError::Document {
        what: "a belief",
        robot: robot.into(),
        why: why.to_string(),
    })
}
