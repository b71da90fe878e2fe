//! What is kept: records, beliefs, alarms and journal, in one SQLite file.
//!
//! One connection writes, on one thread; others only read. A [`Transaction`](sinew_watch_core::Transaction)
//! of the monitor is one of the database: stored as a whole or not at all. WAL with `synchronous = FULL`: what
//! [`Store::commit`] has returned from survives `kill -9` and, if the disk keeps what it acknowledged, a loss of
//! power.

mod export;
mod read;
mod row;
mod schema;
mod write;

pub use export::{Pending, write_records, write_sessions};
pub use read::{JournalEntry, JournalQuery, Reader, RecordQuery};
pub use row::COLUMNS;
pub(crate) use row::word;
pub use schema::VERSION;
pub use write::Store;

use rusqlite::ErrorCode;
use sinew_watch_core::alarm::StoreFault;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A reader and the writer wait so long for each other at most; in WAL they hardly ever do.
const BUSY: Duration = Duration::from_secs(5);

/// Where the store is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// In a folder: `watch.db` and `watch.lock`.
    Folder(PathBuf),
    /// In memory, gone with the process; the number tells several apart.
    Memory(u64),
}

impl Place {
    /// The file of the database.
    pub fn file(&self) -> String {
        match self {
            Self::Folder(folder) => folder.join("watch.db").display().to_string(),
            Self::Memory(number) => format!("file:/sinew-watch-{number}?vfs=memdb"),
        }
    }

    /// The folder, if there is one.
    pub fn folder(&self) -> Option<&Path> {
        match self {
            Self::Folder(folder) => Some(folder),
            Self::Memory(_) => None,
        }
    }
}

/// Why something could not be stored or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// Another monitor has it.
    #[error(
        "{folder}: in use by {holder}; one monitor has a store, name another folder in [store] dir", folder = folder.display()
    )]
    Held {
        /// Folder of the store.
        folder: PathBuf,
        /// Name of the process that has it.
        holder: String,
    },
    /// The folder can't be used.
    #[error("{folder}: {source}; [store] dir must be a folder that can be written", folder = folder.display())]
    Folder {
        /// Folder of the store.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Not a database of this program.
    #[error("{file} is a database of another program; name another folder in [store] dir")]
    Foreign {
        /// Path of the database.
        file: String,
    },
    /// Written by a later program.
    #[error(
        "{file} has version {version}; this program knows versions up to {known}: a newer sinew-watch wrote it"
    )]
    Newer {
        /// Path of the database.
        file: String,
        /// Version of the database.
        version: i64,
        /// The newest known.
        known: i64,
    },
    /// The database is damaged.
    #[error(
        "{file} is damaged: {why}; move it away and keep it: `sqlite3 FILE .recover` may save its records"
    )]
    Damaged {
        /// Path of the database.
        file: String,
        /// What was found.
        why: String,
    },
    /// A document in it that can't be read.
    #[error("{what} of '{robot}' in the store can't be read: {why}")]
    Document {
        /// Belief or alarm.
        what: &'static str,
        /// Name of the robot in the configuration.
        robot: String,
        /// The reason.
        why: String,
    },
    /// What SQLite says.
    #[error(transparent)]
    Sqlite(#[from] rusqlite::Error),
    /// A file of records that could not be written.
    #[error(transparent)]
    File(#[from] sinew_log::LogError),
}

impl StoreError {
    /// What SQLite calls it, where it is one of its errors.
    fn code(&self) -> Option<ErrorCode> {
        match self {
            Self::Sqlite(error) => error.sqlite_error_code(),
            _ => None,
        }
    }

    /// Whether the database itself is damaged.
    pub fn is_damaged(&self) -> bool {
        use ErrorCode::{DatabaseCorrupt, NotADatabase};
        let damaged = matches!(self.code(), Some(DatabaseCorrupt | NotADatabase));
        damaged || matches!(self, Self::Damaged { .. })
    }

    /// Whether it is of the disk or the database as a whole: no other transaction fares better then.
    pub fn is_of_the_disk(&self) -> bool {
        use ErrorCode::{CannotOpen, DiskFull, ReadOnly, SystemIoFailure};
        let code = self.code();
        self.is_damaged()
            || matches!(
                code,
                Some(CannotOpen | DiskFull | ReadOnly | SystemIoFailure)
            )
    }

    /// What kind of failure.
    pub fn fault(&self) -> StoreFault {
        use ErrorCode::{CannotOpen, DiskFull, PermissionDenied, ReadOnly, SystemIoFailure};
        match self.code() {
            Some(DiskFull) => StoreFault::Full,
            _ if self.is_damaged() => StoreFault::Damaged,
            Some(ReadOnly | CannotOpen | PermissionDenied) => StoreFault::ReadOnly,
            Some(SystemIoFailure) => StoreFault::Disk,
            _ => StoreFault::Other,
        }
    }

    /// In words that fit an alarm.
    pub fn in_words(&self) -> String {
        match self.code() {
            Some(ErrorCode::DiskFull) => "the disk is full".into(),
            Some(ErrorCode::ReadOnly) => "the store can't be written".into(),
            Some(ErrorCode::SystemIoFailure) => format!("the disk fails: {self}"),
            _ => self.to_string(),
        }
    }
}
