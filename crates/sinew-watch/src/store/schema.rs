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
    use crate::store::{JournalFilter, Place, Reader, RecordQuery, Store};
    use sinew_watch_core::MonitorState;
    use sinew_watch_core::alarm::{AlarmCause, Condition};

    /// Documents of the versions of the program that wrote database version 1, from 2026-11-25, and version 2 with state
    /// version 1, from 2026-11-29. The names of columns and conditions changed between them.
    struct Former {
        version: usize,
        columns: &'static str,
        condition: &'static str,
        alarm: &'static str,
        state: &'static str,
        journal: [(&'static str, &'static str); 4],
    }

    const FORMER: [Former; 2] = [
        Former {
            version: 1,
            columns: "offset_deviation_rad, in_doubt",
            condition: "jump",
            alarm: r#"{"key":{"joint":"elbow","condition":"jump"},"state":"latched","acknowledged":true,"raised_utc_s":2.0,
                "cause":{"kind":"jump","time_utc_s":1.0,"size_rad":0.005,"deviation_rad":0.0002,"what":"slip","cause":"rope",
                "stiffness_ratio":null},"shelved_until_utc_s":null,"shelved_for_s":null}"#,
            state: r#"{"version":1,"baseline":null,"end_utc_s":9.0,"learns":null,"sessions":7,"tendons":[{"joint":"elbow",
                "since":"tensioned","tensioned_utc_s":[1.5],"replaced_utc_s":null,"before_m":{"mean":0.001,"deviation":0.0001},
                "last_rad":{"mean":0.005,"deviation":0.0002},"last_utc_s":9.0,"suspected":{"time_utc_s":8.0,
                "before_rad":{"mean":0.001,"deviation":0.0001},"size_rad":{"mean":0.004,"deviation":0.0002},"what":"while-off",
                "cause":{"unknown":"both"},"stiffness_ratio":null,"stiffness_before_ratio":0.01,"session":6,"undecided":1}}]}"#,
            journal: [
                (
                    "baseline-waits",
                    r#"{"time_utc_s":1.0,"event":{"event":"baseline-waits","why":"refused"}}"#,
                ),
                (
                    "belief-left",
                    r#"{"time_utc_s":2.0,"event":{"event":"belief-left","why":"another robot"}}"#,
                ),
                (
                    "alarm",
                    r#"{"time_utc_s":3.0,"event":{"event":"alarm","key":{"joint":null,"condition":"door"},"from":"normal",
                    "to":"active","time_utc_s":3.0,"why":{"by":"condition","cause":{"kind":"door","door":"dds:0","why":"off"}}}}"#,
                ),
                (
                    "alarm",
                    r#"{"time_utc_s":4.0,"event":{"event":"alarm","key":{"joint":"elbow","condition":"limit-near"},"from":"normal",
                    "to":"active","time_utc_s":4.0,"why":{"by":"condition","cause":{"kind":"soon","after_low_s":1.0,"after_s":null}}}}"#,
                ),
            ],
        },
        Former {
            version: 2,
            columns: "offset_std_rad, provisional",
            condition: "step-change",
            alarm: r#"{"key":{"joint":"elbow","condition":"step-change"},"state":"latched","acknowledged":true,"raised_utc_s":2.0,
                "cause":{"kind":"step-change","time_utc_s":1.0,"size_rad":0.005,"std_rad":0.0002,"what":"slip","cause":"rope",
                "stiffness_ratio":null},"shelved_until_utc_s":null,"shelved_for_s":null}"#,
            state: r#"{"version":1,"baseline":null,"end_utc_s":9.0,"learns":null,"sessions":7,"tendons":[{"joint":"elbow",
                "since":"tensioned","tensioned_utc_s":[1.5],"replaced_utc_s":null,"before_m":{"mean":0.001,"std":0.0001},
                "last_rad":{"mean":0.005,"std":0.0002},"last_utc_s":9.0,"suspected":{"time_utc_s":8.0,
                "before_rad":{"mean":0.001,"std":0.0001},"size_rad":{"mean":0.004,"std":0.0002},"what":"while-off",
                "cause":{"unknown":"both"},"stiffness_ratio":null,"stiffness_before_ratio":0.01,"session":6,"undecided":1}}]}"#,
            journal: [
                (
                    "baseline-pending",
                    r#"{"time_utc_s":1.0,"event":{"event":"baseline-pending","reason":"rejected"}}"#,
                ),
                (
                    "stored-state-ignored",
                    r#"{"time_utc_s":2.0,"event":{"event":"stored-state-ignored","reason":"another robot"}}"#,
                ),
                (
                    "alarm",
                    r#"{"time_utc_s":3.0,"event":{"event":"alarm","key":{"joint":null,"condition":"transport"},"from":"normal",
                    "to":"active","time_utc_s":3.0,"reason":{"by":"condition","cause":{"kind":"transport","transport":"dds:0",
                    "reason":"off"}}}}"#,
                ),
                (
                    "alarm",
                    r#"{"time_utc_s":4.0,"event":{"event":"alarm","key":{"joint":"elbow","condition":"limit-near"},"from":"normal",
                    "to":"active","time_utc_s":4.0,"reason":{"by":"condition","cause":{"kind":"soon","after_low_s":1.0,
                    "after_s":null}}}}"#,
                ),
            ],
        },
    ];

    /// Writes the database of a former version.
    fn write(former: &Former, file: &std::path::Path) {
        let connection = Connection::open(file).unwrap();
        for step in &STEPS[..former.version] {
            connection.execute_batch(step).unwrap();
        }
        let robot = "INSERT INTO robot VALUES ('arm', 'type', 12)";
        connection.execute(robot, []).unwrap();
        let record = format!(
            "INSERT INTO record (robot, robot_type, joint, time_utc_s, duration_s, offset_rad, {}, source, clock, poses, frames,
                 frames_lost, sinew_version)
             VALUES ('arm', 'type', 'elbow', 1, 60, 0.005, 0.0002, 1, 'dds:0', 'utc', 9, 100, 0, '0.1.0')",
            former.columns
        );
        connection.execute(&record, []).unwrap();
        let alarm = "INSERT INTO alarm VALUES ('arm', 'elbow', ?1, ?2)";
        let values = [former.condition, former.alarm];
        connection.execute(alarm, values).unwrap();
        let packed = zstd::bulk::compress(former.state.as_bytes(), 1).unwrap();
        let state = "INSERT INTO belief VALUES ('arm', 1, ?1)";
        connection.execute(state, [packed]).unwrap();
        for (event, document) in former.journal {
            let entry = "INSERT INTO journal (robot, time_utc_s, event, document) VALUES ('arm', 1, ?1, ?2)";
            connection.execute(entry, [event, document]).unwrap();
        }
        let pragma = |name, value: i64| connection.pragma_update(None, name, value).unwrap();
        pragma("application_id", APPLICATION_ID.into());
        pragma("user_version", former.version as i64);
    }

    /// Checks that a store has all data of the former version.
    fn check(reader: &Reader, former: &Former) {
        let stored = reader.stored("arm").unwrap();
        assert_eq!(stored.last_id, 12);
        let state = stored.state.unwrap();
        assert_eq!((state.sessions, state.end_utc_s), (7, Some(9.0)));
        let tendon = &state.tendons[0];
        assert_eq!(tendon.last_rad.unwrap().std, 0.0002);
        assert_eq!(tendon.suspected.unwrap().size_rad.mean, 0.004);
        let alarm = &stored.alarms.alarms[0];
        assert_eq!(alarm.key.condition, Condition::StepChange);
        assert!(matches!(
            alarm.cause,
            AlarmCause::StepChange {
                std_rad: 0.0002,
                ..
            }
        ));
        let records = reader.records(&RecordQuery::default()).unwrap();
        assert_eq!(records[0].offset().unwrap().std, 0.0002);
        assert!(records[0].provisional);
        let all = JournalFilter {
            most: 10,
            ..JournalFilter::default()
        };
        let journal = reader.journal(&all).unwrap();
        assert_eq!(journal.len(), former.journal.len());
        let texts: Vec<String> = journal
            .iter()
            .map(|e| crate::words::entry(&e.entry.event))
            .collect();
        assert!(texts[1].contains("Transport disconnected"), "{texts:?}");
        let condition: String = reader
            .connection()
            .query_row("SELECT condition FROM alarm", [], |row| row.get(0))
            .unwrap();
        assert_eq!(condition, "step-change");
    }

    #[test]
    fn stores_and_backups_of_former_versions_are_upgraded() {
        assert_eq!(FORMER.map(|former| former.version), [1, 2]);
        for former in FORMER {
            let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
            let [folder, other] = folders.each_ref().map(|folder| folder.path());
            write(&former, &folder.join("watch.db"));
            // A backup of the former program: its database in one file.
            std::fs::copy(folder.join("watch.db"), other.join("watch.db")).unwrap();
            let store = Store::open(Place::Folder(folder.into())).unwrap();
            let reader = store.reader().unwrap();
            let file = folder.display().to_string();
            assert_eq!(version(reader.connection(), &file).unwrap(), VERSION as i64);
            check(&reader, &former);
            // The upgraded store is written with the state of this version, backed up, and restored in place of the former.
            let state = reader.stored("arm").unwrap().state.unwrap();
            drop(Store::open(Place::Folder(other.into())).unwrap());
            reader.backup(&other.join("watch.db")).unwrap();
            let mut restored = Store::open(Place::Folder(other.into())).unwrap();
            check(&restored.reader().unwrap(), &former);
            let next = sinew_watch_core::Transaction {
                id: 13,
                robot: "arm".into(),
                records: Vec::new(),
                replaced_from_utc_s: None,
                state: Some(std::sync::Arc::new(MonitorState {
                    version: MonitorState::VERSION,
                    ..state
                })),
                alarms: None,
                journal: Vec::new(),
            };
            restored.commit(&[next]).unwrap();
            let stored = restored.reader().unwrap().stored("arm").unwrap();
            assert_eq!(stored.state.unwrap().version, MonitorState::VERSION);
        }
    }
}
