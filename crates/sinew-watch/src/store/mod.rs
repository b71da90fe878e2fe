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
pub use schema::VERSION;
pub use write::Store;

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
    /// Of the database, for messages.
    pub fn name(&self) -> String {
        self.file()
    }

    /// Of the database.
    fn file(&self) -> String {
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
        /// The folder.
        folder: PathBuf,
        /// Who.
        holder: String,
    },
    /// The folder can't be used.
    #[error("{folder}: {source}; [store] dir must be a folder that can be written", folder = folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Not a database of this program.
    #[error("{file} is a database of another program; name another folder in [store] dir")]
    Foreign {
        /// The file.
        file: String,
    },
    /// Written by a later program.
    #[error(
        "{file} has version {version}; this program knows versions up to {known}: a newer sinew-watch wrote it"
    )]
    Newer {
        /// The file.
        file: String,
        /// Its version.
        version: i64,
        /// The newest known.
        known: i64,
    },
    /// Damaged.
    #[error(
        "{file} is damaged: {why}; move it away and keep it: `sqlite3 FILE .recover` may save its records"
    )]
    Damaged {
        /// The file.
        file: String,
        /// What was found.
        why: String,
    },
    /// A document in it that can't be read.
    #[error("{what} of '{robot}' in the store can't be read: {why}")]
    Document {
        /// Belief or alarm.
        what: &'static str,
        /// Robot.
        robot: String,
        /// Why.
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
    /// Whether the disk has no room.
    pub fn is_full(&self) -> bool {
        matches!(self, Self::Sqlite(e) if e.sqlite_error_code() == Some(rusqlite::ErrorCode::DiskFull))
    }

    /// Whether the database itself is damaged.
    pub fn is_damaged(&self) -> bool {
        use rusqlite::ErrorCode::{DatabaseCorrupt, NotADatabase};
        match self {
            Self::Damaged { .. } => true,
            Self::Sqlite(e) => {
                matches!(e.sqlite_error_code(), Some(DatabaseCorrupt | NotADatabase))
            }
            _ => false,
        }
    }

    /// Whether it is of the disk or the database as a whole: no other transaction fares better then.
    pub fn is_of_the_disk(&self) -> bool {
        use rusqlite::ErrorCode::{CannotOpen, DiskFull, ReadOnly, SystemIoFailure};
        let of_sqlite = |e: &rusqlite::Error| {
            matches!(
                e.sqlite_error_code(),
                Some(CannotOpen | DiskFull | ReadOnly | SystemIoFailure)
            )
        };
        self.is_damaged() || matches!(self, Self::Sqlite(e) if of_sqlite(e))
    }

    /// What kind of failure.
    pub fn fault(&self) -> StoreFault {
        use rusqlite::ErrorCode::{CannotOpen, PermissionDenied, ReadOnly, SystemIoFailure};
        let code = match self {
            Self::Sqlite(error) => error.sqlite_error_code(),
            _ => None,
        };
        match code {
            _ if self.is_full() => StoreFault::Full,
            _ if self.is_damaged() => StoreFault::Damaged,
            Some(ReadOnly | CannotOpen | PermissionDenied) => StoreFault::ReadOnly,
            Some(SystemIoFailure) => StoreFault::Disk,
            _ => StoreFault::Other,
        }
    }

    /// In words that fit an alarm.
    pub fn in_words(&self) -> String {
        match self {
            Self::Sqlite(_) if self.is_full() => "the disk is full".into(),
            Self::Sqlite(e) => match e.sqlite_error_code() {
                Some(rusqlite::ErrorCode::ReadOnly) => "the store can't be written".into(),
                Some(rusqlite::ErrorCode::SystemIoFailure) => {
                    format!("the disk fails: {e}")
                }
                _ => e.to_string(),
            },
            other => other.to_string(),
        }
    }
}
