//! Tables of the database, and the migration of older versions.

use super::StoreError;
use rusqlite::{Connection, Transaction, TransactionBehavior};

/// "Sinw": identifies the file type for `file watch.db`.
const APPLICATION_ID: i32 = 0x5369_6e77;

/// Migration from version `n` to `n + 1`. A published step is never changed.
const STEPS: [&str; 2] = [
    "
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
-- sinew-record/2: docs/src/reference/records.md
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
",
    "
ALTER TABLE record RENAME COLUMN offset_deviation_rad TO offset_std_rad;
ALTER TABLE record RENAME COLUMN elongation_deviation_m TO elongation_std_m;
ALTER TABLE record RENAME COLUMN strain_deviation_ratio TO strain_std_ratio;
ALTER TABLE record RENAME COLUMN stiffness_deviation_ratio TO stiffness_std_ratio;
ALTER TABLE record RENAME COLUMN in_doubt TO provisional;
UPDATE alarm SET condition = 'step-change' WHERE condition = 'jump';
UPDATE alarm SET condition = 'suspected-step' WHERE condition = 'suspicion';
UPDATE alarm SET condition = 'strand-failure' WHERE condition = 'strand-failed';
UPDATE alarm SET condition = 'transport' WHERE condition = 'door';
",
];

/// Version of the database that this program writes.
pub const VERSION: usize = STEPS.len();

/// Returns the version of a database; 0: empty.
///
/// # Errors
/// Returns a [`StoreError`] if the database belongs to another or a newer program.
pub(super) fn version(connection: &Connection, file: &str) -> Result<i64, StoreError> {
    let application: i32 = connection.pragma_query_value(None, "application_id", |r| r.get(0))?;
    let version: i64 = connection.pragma_query_value(None, "user_version", |r| r.get(0))?;
    let tables: i64 =
        connection.query_row("SELECT count(*) FROM sqlite_schema", [], |r| r.get(0))?;
    if application != APPLICATION_ID && (application != 0 || version != 0 || tables != 0) {
        return Err(StoreError::Foreign { file: file.into() });
    }
    let supported = i64::try_from(VERSION).unwrap_or(i64::MAX);
    if version > supported {
        return Err(StoreError::Newer {
            file: file.into(),
            version,
            supported,
        });
    }
    Ok(version)
}

/// Migrates a database to the version of this program, in one transaction.
pub(super) fn migrate(connection: &mut Connection, file: &str) -> Result<(), StoreError> {
    let version = version(connection, file)?;
    let supported = i64::try_from(VERSION).unwrap_or(i64::MAX);
    if version == supported {
        return Ok(());
    }
    let transaction = Transaction::new(connection, TransactionBehavior::Immediate)?;
    for step in STEPS.iter().skip(usize::try_from(version).unwrap_or(0)) {
        transaction.execute_batch(step)?;
    }
    transaction.pragma_update(None, "application_id", APPLICATION_ID)?;
    transaction.pragma_update(None, "user_version", supported)?;
    Ok(transaction.commit()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn version_1_records_and_alarms_are_migrated() {
        let mut connection = Connection::open_in_memory().unwrap();
        connection.execute_batch(STEPS[0]).unwrap();
        connection
            .execute_batch(
                "INSERT INTO robot VALUES ('arm', 'type', 1);
                 INSERT INTO record (robot, robot_type, joint, time_utc_s, duration_s, offset_rad,
                     offset_deviation_rad, source, clock, in_doubt, poses, frames, frames_lost, sinew_version)
                 VALUES ('arm', 'type', 'elbow', 1, 60, 0.005, 0.0002, 'dds:0', 'utc', 1, 9, 100, 0, '0.1.0');
                 INSERT INTO alarm VALUES ('arm', '', 'door', '{}'), ('arm', 'elbow', 'jump', '{}');",
            )
            .unwrap();
        connection
            .pragma_update(None, "application_id", APPLICATION_ID)
            .unwrap();
        connection.pragma_update(None, "user_version", 1).unwrap();
        migrate(&mut connection, "watch.db").unwrap();
        assert_eq!(version(&connection, "watch.db").unwrap(), 2);
        let sql = "SELECT offset_std_rad, provisional FROM record";
        let record = connection.query_row(sql, [], |row| Ok((row.get(0)?, row.get(1)?)));
        assert_eq!(record.unwrap(), (0.0002, true));
        let sql =
            "SELECT group_concat(condition) FROM (SELECT condition FROM alarm ORDER BY condition)";
        let conditions: String = connection.query_row(sql, [], |row| row.get(0)).unwrap();
        assert_eq!(conditions, "step-change,transport");
    }
}
