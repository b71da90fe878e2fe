//! Store of records, state estimates, alarms and journal in one SQLite file.
//!
//! One connection writes, on one thread; all others only read. A [`Transaction`](sinew_watch_core::Transaction) of
//! the monitor is one transaction of the database: stored completely or not at all. WAL with `synchronous = FULL`:
//! data for which [`Store::commit`] has returned survive `kill -9` and, if the disk keeps what it acknowledged, a
//! power failure.

mod export;
mod read;
mod row;
mod schema;
mod series;
mod survival;
mod write;

pub use export::{Pending, write_records, write_sessions};
pub use read::{
    JournalEntry, JournalFilter, Position, Reader, RecordQuery, RecordSpan, RobotUsage,
};
pub use row::COLUMNS;
pub(crate) use row::word;
pub use schema::VERSION;
pub use series::{Series, SeriesPoint, SeriesQuery};
pub use survival::write_lives;
pub use write::Store;

use rusqlite::ErrorCode;
use sinew_watch_core::alarm::StoreFault;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Maximum time that a reader and the writer wait for each other; with WAL they rarely do.
const MAX_BUSY_TIME: Duration = Duration::from_secs(5);

/// Location of the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Folder with `watch.db` and `watch.lock`.
    Folder(PathBuf),
    /// Memory of the process; the number distinguishes several stores.
    Memory(u64),
}

impl Place {
    /// Returns the path of the database file.
    pub fn file(&self) -> String {
        match self {
            Self::Folder(folder) => folder.join("watch.db").display().to_string(),
            Self::Memory(number) => format!("file:/sinew-watch-{number}?vfs=memdb"),
        }
    }

    /// Returns the folder, if any.
    pub fn folder(&self) -> Option<&Path> {
        match self {
            Self::Folder(folder) => Some(folder),
            Self::Memory(_) => None,
        }
    }
}

/// Checks that a database which was created is not empty or missing while its write-ahead log exists: SQLite would begin a new
/// one in its place. A new database is never empty, as it is written under another name first.
fn check_content(file: &Path) -> Result<(), StoreError> {
    let length = |path: &Path| std::fs::metadata(path).ok().map(|of| of.len());
    let log = PathBuf::from(format!("{}-wal", file.display()));
    let (what, remains) = match (length(file), length(&log)) {
        (Some(0), _) => ("is empty", file),
        (None, Some(1..)) => ("is missing", log.as_path()),
        _ => return Ok(()),
    };
    Err(StoreError::Lost {
        file: file.display().to_string(),
        what,
        remains: remains.display().to_string(),
    })
}

/// Error of storing or reading.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// Another monitor uses the store.
    #[error(
        "{folder}: in use by {holder}; set another folder in [store] dir", folder = folder.display()
    )]
    Held {
        /// Folder of the store.
        folder: PathBuf,
        /// Name of the process that uses it.
        holder: String,
    },
    /// The folder cannot be used.
    #[error("{folder}: {source}; set a writable folder in [store] dir", folder = folder.display())]
    Folder {
        /// Folder of the store.
        folder: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is not a database of this program.
    #[error("{file} is a database of another program; set another folder in [store] dir")]
    Foreign {
        /// Path of the database.
        file: String,
    },
    /// The database has no content, although it was created before: a file system repair or a copy lost it.
    #[error(
        "{file} {what}, but a store has been here before; restore it from a backup, or remove {remains} to begin a new store"
    )]
    Lost {
        /// Path of the database.
        file: String,
        /// Condition of the file.
        what: &'static str,
        /// Path of the file that remains.
        remains: String,
    },
    /// The database was written by a newer program.
    #[error(
        "{file} has format version {version}, and this program supports versions up to {supported}; use the newer sinew-watch that wrote it"
    )]
    Newer {
        /// Path of the database.
        file: String,
        /// Version of the database.
        version: i64,
        /// Newest supported version.
        supported: i64,
    },
    /// The database is damaged.
    #[error(
        "{file} is damaged: {reason}; move it to another folder and recover its records with `sqlite3 FILE .recover`"
    )]
    Damaged {
        /// Path of the database.
        file: String,
        /// Result of the integrity check.
        reason: String,
    },
    /// A stored document is invalid.
    #[error("{what} of '{robot}' in the store is invalid: {reason}")]
    Document {
        /// Kind of the document: state or alarm.
        what: &'static str,
        /// Name of the robot in the configuration.
        robot: String,
        /// Reason why the document is invalid.
        reason: String,
    },
    /// SQLite reported an error.
    #[error(transparent)]
    Sqlite(#[from] rusqlite::Error),
    /// A file of records cannot be written.
    #[error(transparent)]
    File(#[from] sinew_log::LogError),
}

impl StoreError {
    /// Returns the error code of SQLite, if it is one of its errors.
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

    /// Whether the failure concerns the disk or the database as a whole, so that other transactions fail as well.
    pub fn is_of_the_disk(&self) -> bool {
        use ErrorCode::{CannotOpen, DiskFull, ReadOnly, SystemIoFailure};
        let code = self.code();
        self.is_damaged()
            || matches!(
                code,
                Some(CannotOpen | DiskFull | ReadOnly | SystemIoFailure)
            )
    }

    /// Returns the kind of the failure.
    pub fn fault(&self) -> StoreFault {
        use ErrorCode::{CannotOpen, DiskFull, PermissionDenied, ReadOnly, SystemIoFailure};
        match self.code() {
            Some(DiskFull) => StoreFault::Full,
            _ if self.is_damaged() || matches!(self, Self::Lost { .. }) => StoreFault::Damaged,
            Some(ReadOnly | CannotOpen | PermissionDenied) => StoreFault::ReadOnly,
            Some(SystemIoFailure) => StoreFault::Disk,
            _ => StoreFault::Other,
        }
    }

    /// Returns the reason as a short text for an alarm.
    pub fn in_words(&self) -> String {
        match self.code() {
            Some(ErrorCode::DiskFull) => "the disk is full".into(),
            Some(ErrorCode::ReadOnly) => "the store is read-only".into(),
            Some(ErrorCode::SystemIoFailure) => format!("disk failure: {self}"),
            _ => self.to_string(),
        }
    }
}
