//! Files that are whole or not there.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Result as IoResult, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// One write of the operating system, bytes.
const BUFFER_BYTES: usize = 256 << 10;

/// A file that appears under its name only when it is finished.
///
/// Written beside its target as `NAME.PROCESS-NUMBER.tmp`, a name of its own for every writer.
/// Dropped unfinished, nothing stays, and an older file of the name is untouched.
#[derive(Debug)]
pub struct AtomicFile {
    // Before `temporary`: the file is closed before it is removed.
    writer: BufWriter<File>,
    temporary: Temporary,
    path: PathBuf,
}

/// A file that is removed again unless it gets another name.
#[derive(Debug)]
struct Temporary(Option<PathBuf>);

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // Nothing can be done about a failure here, and the name says what it is.
            let _left_behind = std::fs::remove_file(path);
        }
    }
}

/// Why an output file was not written.
#[derive(Debug, thiserror::Error)]
#[error("can't write {path}: {source}", path = path.display())]
pub struct OutputError {
    /// The file asked for.
    pub path: PathBuf,
    /// What the system says.
    pub source: std::io::Error,
}

impl AtomicFile {
    /// Starts a file.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses, such as in a folder that isn't there.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let refuse = |source| OutputError {
            path: path.to_path_buf(),
            source,
        };
        loop {
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let mut name = path.as_os_str().to_owned();
            name.push(format!(".{}-{number}.tmp", std::process::id()));
            let temporary = PathBuf::from(name);
            // Never a file that is there: another program's, or one left by a crash.
            match OpenOptions::new()
                .write(true)
                .create_new(true)
                .open(&temporary)
            {
                Ok(file) => {
                    return Ok(Self {
                        writer: BufWriter::with_capacity(BUFFER_BYTES, file),
                        temporary: Temporary(Some(temporary)),
                        path: path.to_path_buf(),
                    });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(refuse(error)),
            }
        }
    }

    /// The name the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes all of `bytes`.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let result = self.writer.write_all(bytes);
        result.map_err(|error| self.error(error))
    }

    /// A failure of the system as an error of this file.
    pub fn error(&self, source: std::io::Error) -> OutputError {
        OutputError {
            path: self.path.clone(),
            source,
        }
    }

    /// Puts the file in its place, once its bytes are on the disk.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses; no part of the file stays.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.place().map_err(|error| self.error(error))
    }

    fn place(&mut self) -> IoResult<()> {
        self.writer.flush()?;
        self.writer.get_ref().sync_all()?;
        if let Some(temporary) = &self.temporary.0 {
            std::fs::rename(temporary, &self.path)?;
            self.temporary.0 = None;
        }
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> IoResult<()> {
        self.writer.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> IoResult<u64> {
        self.writer.seek(to)
    }
}

/// Writes a whole text or image at once.
///
/// # Errors
/// [`OutputError`] where the system refuses; an older file of the name is then untouched.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let mut file = AtomicFile::create(path)?;
    file.append(bytes)?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let count = || std::fs::read_dir(folder.path()).unwrap().count();
        write_file(&path, b"old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.append(b"half").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(count(), 2);
        drop(file);
        assert_eq!(
            (std::fs::read(&path).unwrap(), count()),
            (b"old".to_vec(), 1)
        );
        let [mut one, mut other] = [(); 2].map(|()| AtomicFile::create(&path).unwrap());
        one.append(b"one").unwrap();
        other.append(b"other").unwrap();
        other.finish().unwrap();
        one.finish().unwrap();
        assert_eq!(
            (std::fs::read(&path).unwrap(), count()),
            (b"one".to_vec(), 1)
        );
        let error = write_file(&folder.path().join("no/a.txt"), b"x").unwrap_err();
        assert!(error.to_string().contains("a.txt"), "{error}");
    }
}
