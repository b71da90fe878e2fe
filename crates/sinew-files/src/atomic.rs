//! Files that are whole or not there.

use crate::temporary::Temporary;
use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Result as IoResult, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// One write of the operating system, bytes.
const BUFFER_BYTES: usize = 256 << 10;

/// Links that lead to links, followed at most: as many as Linux follows.
const LINKS_MOST: usize = 40;

/// What files of this process took the place of.
static REPLACED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A file that appears under its name only when it is finished.
///
/// Written as a [`Temporary`] file in the folder of its target. Dropped unfinished, nothing stays, and an
/// older file of the name is untouched. A link is followed: its target is replaced, the link stays.
/// `-`, a pipe and a device are written through: what was written can't be taken back.
#[derive(Debug)]
pub struct AtomicFile {
    // Before `place`: the file is closed before it is removed.
    writer: BufWriter<File>,
    /// None where it is written through.
    place: Option<(Temporary, PathBuf)>,
    path: PathBuf,
    written: u64,
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

/// Where the bytes of an output go.
enum Destination {
    /// `-`, `/dev/stdout`.
    Stdout,
    /// A pipe, a device, or a file this process was given open.
    Through,
    /// A file, there or not, behind all links.
    Whole(PathBuf),
}

impl Destination {
    fn of(path: &Path) -> IoResult<Self> {
        if is_stdout(path) {
            return Ok(Self::Stdout);
        }
        // `/dev/stderr` and the like may be regular files, already written to by others.
        let given_open = ["/dev/fd", "/proc", "/dev/stderr"];
        match std::fs::metadata(path) {
            Ok(about) if about.is_dir() => Err(std::io::Error::new(
                ErrorKind::IsADirectory,
                "it is a folder; name a file",
            )),
            Ok(about) if !about.is_file() => Ok(Self::Through),
            Ok(_) if given_open.iter().any(|start| path.starts_with(start)) => Ok(Self::Through),
            Ok(_) => Ok(Self::Whole(path.canonicalize()?)),
            // Not there, or a link to what is not there.
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let mut target = path.to_path_buf();
                for _ in 0..LINKS_MOST {
                    let Ok(next) = target.read_link() else {
                        return Ok(Self::Whole(target));
                    };
                    target = folder_of(&target).join(next);
                }
                Err(error)
            }
            Err(error) => Err(error),
        }
    }
}

/// Whether an output is asked for on stdout.
pub fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].contains(&path.to_str().unwrap_or(""))
}

/// The folder a file lies in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// What files of this process took the place of, since the last call.
pub fn take_replaced() -> BTreeSet<PathBuf> {
    let mut replaced = REPLACED.lock().unwrap_or_else(PoisonError::into_inner);
    std::mem::take(&mut *replaced)
}

impl AtomicFile {
    /// Starts a file.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses, such as in a folder that isn't there.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let opened = || -> IoResult<(File, Option<(Temporary, PathBuf)>)> {
            Ok(match Destination::of(path)? {
                Destination::Stdout => (stdout_file()?, None),
                Destination::Through => (OpenOptions::new().append(true).open(path)?, None),
                Destination::Whole(target) => {
                    let name = target.file_name().unwrap_or_default().to_string_lossy();
                    let (file, temporary) = Temporary::create(folder_of(&target), &name)?;
                    (file, Some((temporary, target)))
                }
            })
        };
        let (file, place) = opened().map_err(|source| OutputError {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(Self {
            writer: BufWriter::with_capacity(BUFFER_BYTES, file),
            place,
            path: path.to_path_buf(),
            written: 0,
        })
    }

    /// The name the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether what was written can still be changed: not in a pipe.
    pub fn can_seek(&self) -> bool {
        self.place.is_some()
    }

    /// Writes all of `bytes`.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let result = self.write_all(bytes);
        result.map_err(|error| self.error(error))
    }

    /// A failure of the system as an error of this file.
    pub fn error(&self, source: std::io::Error) -> OutputError {
        OutputError {
            path: self.path.clone(),
            source,
        }
    }

    /// Waits until all that was written is on the disk: what can fail then is the name alone.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses.
    pub fn sync(&mut self) -> Result<(), OutputError> {
        let done = self.writer.flush();
        let done = done.and_then(|()| match self.can_seek() {
            true => self.writer.get_ref().sync_all(),
            false => Ok(()),
        });
        done.map_err(|error| self.error(error))
    }

    /// Puts the file in its place, once its bytes are on the disk; the disk then knows its name too.
    ///
    /// # Errors
    /// [`OutputError`] where the system refuses; no part of the file stays.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.settle().map_err(|error| self.error(error))
    }

    fn settle(&mut self) -> IoResult<()> {
        self.writer.flush()?;
        let Some((temporary, target)) = self.place.take() else {
            return Ok(());
        };
        if let Ok(old) = std::fs::metadata(&target) {
            // Who may read it stays as it was, where the file system knows of that.
            let _unknown = self.writer.get_ref().set_permissions(old.permissions());
        }
        self.writer.get_ref().sync_all()?;
        if temporary.rename(self.writer.get_ref(), &target)? {
            let mut replaced = REPLACED.lock().unwrap_or_else(PoisonError::into_inner);
            replaced.insert(self.path.clone());
        }
        sync_folder(folder_of(&target))
    }
}

/// Stdout as a file: what is written passes no second buffer.
fn stdout_file() -> IoResult<File> {
    let stdout = std::io::stdout();
    #[cfg(unix)]
    let handle = std::os::fd::AsFd::as_fd(&stdout).try_clone_to_owned();
    #[cfg(windows)]
    let handle = std::os::windows::io::AsHandle::as_handle(&stdout).try_clone_to_owned();
    handle.map(File::from)
}

/// Makes the disk keep the names in a folder, where the system lets a folder be opened for it.
fn sync_folder(folder: &Path) -> IoResult<()> {
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        // A failing disk is an error; a file system that can't do it is none.
        Err(error) if error.raw_os_error() == Some(5) => Err(error),
        _ => Ok(()),
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        let taken = self.writer.write(bytes)?;
        self.written += taken as u64;
        Ok(taken)
    }

    fn flush(&mut self) -> IoResult<()> {
        self.writer.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> IoResult<u64> {
        match to {
            // A pipe knows how much went through it.
            SeekFrom::Current(0) if !self.can_seek() => Ok(self.written),
            _ => self.writer.seek(to),
        }
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
        // Besides the old one at most the temporary file, which may have no name yet.
        assert!(count() <= 2);
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
