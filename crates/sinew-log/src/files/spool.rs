//! Temporary storage of a stream, so that it can be read repeatedly.

use sinew_files::Temporary;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// First bytes of a file compressed with zstd.
pub(super) const ZSTD_MAGIC: &[u8] = b"\x28\xb5\x2f\xfd";

/// First bytes of an SQLite file.
pub(super) const SQLITE_MAGIC: &[u8] = b"SQLite f";

/// Temporary file that is deleted with its process.
pub(super) struct Spool {
    file: File,
    temporary: Temporary,
}

impl Spool {
    /// Stores the content of `from`, at most `limit` bytes.
    pub(super) fn of(from: impl Read, limit: u64) -> std::io::Result<Self> {
        let (file, temporary) = Temporary::create(&std::env::temp_dir(), "recording")?;
        let mut spool = Spool { file, temporary };
        let kept = std::io::copy(&mut from.take(limit.saturating_add(1)), &mut spool.file)?;
        if kept > limit {
            let problem = format!("more than {limit} bytes");
            return Err(std::io::Error::new(
                std::io::ErrorKind::FileTooLarge,
                problem,
            ));
        }
        // SQLite opens a file by its path.
        let mut start = [0; SQLITE_MAGIC.len()];
        spool.file.rewind()?;
        if spool.file.read_exact(&mut start).is_ok() && start == SQLITE_MAGIC {
            spool.temporary.expose(&spool.file)?;
        }
        spool.file.rewind()?;
        Ok(spool)
    }
}

impl Spool {
    /// Path of the file, if it is an SQLite file or the file system has no files without a name.
    pub(super) fn path(&self) -> Option<&Path> {
        self.temporary.path()
    }
}

impl Read for Spool {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        self.file.read(into)
    }
}

impl Seek for Spool {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}
