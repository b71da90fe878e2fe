//! Tables of the database, and how an older one becomes today's.

use super::StoreError;
use rusqlite::{Connection, Transaction, TransactionBehavior};

/// "Sinw", so that `file watch.db` can tell.
const APPLICATION_ID: i32 = 0x5369_6e77;

/// What makes version `n + 1` of version `n`. A step that was published is never changed.
const STEPS: [&str; 1] = ["
CREATE TABLE robot (
    name TEXT PRIMARY KEY,
    robot_type TEXT NOT NULL,
    -- Number of the last transaction stored: one that comes twice is stored once.
    last_transaction INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE belief (
    robot TEXT PRIMARY KEY REFERENCES robot (name),
    version INTEGER NOT NULL,
    -- JSON, packed with zstd.
    document BLOB NOT NULL
) STRICT, WITHOUT ROWID;
-- sinew-record/1: docs/src/reference/records.md
CREATE TABLE record (
    id INTEGER PRIMARY KEY,
    robot TEXT NOT NULL REFERENCES robot (name),
    robot_type TEXT NOT NULL,
    joint TEXT NOT NULL,
    time_utc_s REAL NOT NULL,
    duration_s REAL NOT NULL,
    offset_rad REAL,
    offset_deviation_rad REAL,
    elongation_m REAL,
    elongation_deviation_m REAL,
    strain_ratio REAL,
    strain_deviation_ratio REAL,
    temperature_c REAL,
    stiffness_ratio REAL,
    stiffness_deviation_ratio REAL,
    baseline TEXT,
    source TEXT NOT NULL,
    clock TEXT NOT NULL,
    in_doubt INTEGER NOT NULL,
    reason TEXT,
    poses INTEGER NOT NULL,
    frames INTEGER NOT NULL,
    frames_lost INTEGER NOT NULL,
    sinew_version TEXT NOT NULL
) STRICT;
CREATE INDEX record_of_tendon ON record (robot, joint, time_utc_s);
CREATE INDEX record_by_time ON record (time_utc_s);
CREATE TABLE alarm (
    robot TEXT NOT NULL REFERENCES robot (name),
    -- Empty: of the robot as a whole.
    joint TEXT NOT NULL,
    condition TEXT NOT NULL,
    document TEXT NOT NULL,
    PRIMARY KEY (robot, joint, condition)
) STRICT, WITHOUT ROWID;
CREATE TABLE journal (
    id INTEGER PRIMARY KEY,
    robot TEXT NOT NULL REFERENCES robot (name),
    time_utc_s REAL NOT NULL,
    event TEXT NOT NULL,
    document TEXT NOT NULL
) STRICT;
CREATE INDEX journal_of_robot ON journal (robot, id);
CREATE TABLE exported (
    robot_type TEXT NOT NULL,
    month TEXT NOT NULL,
    number INTEGER NOT NULL,
    last_record INTEGER NOT NULL,
    PRIMARY KEY (robot_type, month, number)
) STRICT, WITHOUT ROWID;
"];

/// Version that this program writes.
pub const VERSION: usize = STEPS.len();

/// Version of a database; 0: it is empty.
///
/// # Errors
/// [`StoreError`]: another program's, or a newer one's.
pub(super) fn version(connection: &Connection, file: &str) -> Result<i64, StoreError> {
    let application: i32 = connection.pragma_query_value(None, "application_id", |r| r.get(0))?;
    let version: i64 = connection.pragma_query_value(None, "user_version", |r| r.get(0))?;
    let tables: i64 =
        connection.query_row("SELECT count(*) FROM sqlite_schema", [], |r| r.get(0))?;
    if application != APPLICATION_ID && (application != 0 || version != 0 || tables != 0) {
        return Err(StoreError::Foreign { file: file.into() });
    }
    let known = i64::try_from(VERSION).unwrap_or(i64::MAX);
    if version > known {
        return Err(StoreError::Newer {
            file: file.into(),
            version,
            known,
        });
    }
    Ok(version)
}

/// Brings a database to this program's version, in one transaction.
pub(super) fn migrate(connection: &mut Connection, file: &str) -> Result<(), StoreError> {
    let version = version(connection, file)?;
    let known = i64::try_from(VERSION).unwrap_or(i64::MAX);
    if version == known {
        return Ok(());
    }
    let transaction = Transaction::new(connection, TransactionBehavior::Immediate)?;
    for step in STEPS.iter().skip(usize::try_from(version).unwrap_or(0)) {
        transaction.execute_batch(step)?;
    }
    transaction.pragma_update(None, "application_id", APPLICATION_ID)?;
    transaction.pragma_update(None, "user_version", known)?;
    Ok(transaction.commit()?)
}
