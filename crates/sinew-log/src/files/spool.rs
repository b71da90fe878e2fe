//! Bytes that come once, kept where they can be read again and again.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// What a file packed with zstd begins with.
pub(super) const ZSTD_MAGIC: &[u8] = b"\x28\xb5\x2f\xfd";

/// A file of this process that is gone with it.
pub(super) struct Spool {
    file: File,
    path: PathBuf,
}

impl Spool {
    /// Keeps all that `from` gives, at most `limit` bytes of it.
    pub(super) fn of(from: impl Read, limit: u64) -> std::io::Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("sinew-{}-{count}.tmp", std::process::id());
        let path = std::env::temp_dir().join(name);
        let file = File::options()
            .read(true)
            .write(true)
            .create_new(true)
            .open(&path)?;
        let mut spool = Spool { file, path };
        let kept = std::io::copy(&mut from.take(limit + 1), &mut spool.file)?;
        if kept > limit {
            let problem = format!("more than {limit} bytes");
            return Err(std::io::Error::new(
                std::io::ErrorKind::FileTooLarge,
                problem,
            ));
        }
        spool.file.rewind()?;
        Ok(spool)
    }
}

impl Spool {
    /// Where it lies.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Spool {
    fn drop(&mut self) {
        // A file that stays behind does no harm, and there is nobody to tell.
        let _ = std::fs::remove_file(&self.path);
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
