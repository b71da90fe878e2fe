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

/// Files that outputs of this process have replaced.
static REPLACED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Files that this process has read; `None`: they are not recorded.
static INPUTS: Mutex<Option<BTreeSet<PathBuf>>> = Mutex::new(None);

/// Starts or ends the record of the files that this process reads, so that no [`AtomicFile`] replaces one of them. A program
/// calls it around a command; a library does not.
pub fn protect_inputs(protects: bool) {
    let mut inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    *inputs = protects.then(BTreeSet::new);
}

/// Records a file that is read, see [`protect_inputs`].
pub fn note_input(path: &Path) {
    let mut inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(inputs) = &mut *inputs {
        inputs.extend(path.canonicalize());
    }
}

fn is_input(path: &Path) -> bool {
    let inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    inputs.as_ref().is_some_and(|inputs| inputs.contains(path))
}

/// A file that appears under its name only when it is finished.
///
/// Written as a [`Temporary`] file in the folder of its target. If it is dropped before it is finished,
/// no file is created and an existing file of that name is unchanged. A symbolic link is followed: its
/// target is replaced and the link is kept. `-`, pipes and devices are written directly, so that output
/// already written cannot be undone.
#[derive(Debug)]
pub struct AtomicFile {
    // Before `place`: the file is closed before it is removed.
    writer: BufWriter<File>,
    /// None where it is written through.
    place: Option<(Temporary, PathBuf)>,
    path: PathBuf,
    written: u64,
}

/// Error of writing an output file.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {source}", path = path.display())]
pub struct OutputError {
    /// Path of the requested output.
    pub path: PathBuf,
    /// Error reported by the operating system.
    pub source: std::io::Error,
}

/// Destination of the bytes of an output.
enum Destination {
    /// Standard output: `-` or `/dev/stdout`.
    Stdout,
    /// A pipe, a device, or a file that this process inherited open.
    Through,
    /// Path of the file after all links are resolved; the file may be missing.
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

/// Whether the path names standard output.
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

/// Returns the files that this process has replaced since the last call.
pub fn take_replaced() -> BTreeSet<PathBuf> {
    let mut replaced = REPLACED.lock().unwrap_or_else(PoisonError::into_inner);
    std::mem::take(&mut *replaced)
}

impl AtomicFile {
    /// Creates a file.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the system reports an error, e.g. for a missing folder.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let destination = || -> IoResult<(File, Option<(Temporary, PathBuf)>)> {
            Ok(match Destination::of(path)? {
                Destination::Stdout => (stdout_file()?, None),
                Destination::Through => (OpenOptions::new().append(true).open(path)?, None),
                Destination::Whole(target) if is_input(&target) => {
                    let problem = "it is an input of this command; specify another file";
                    return Err(std::io::Error::new(ErrorKind::AlreadyExists, problem));
                }
                Destination::Whole(target) => {
                    let name = target.file_name().unwrap_or_default().to_string_lossy();
                    let (file, temporary) = Temporary::create(folder_of(&target), &name)?;
                    (file, Some((temporary, target)))
                }
            })
        };
        let (file, place) = destination().map_err(|source| OutputError {
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

    /// Whether written data can still be changed, which is not possible in a pipe.
    pub fn can_seek(&self) -> bool {
        self.place.is_some()
    }

    /// Writes all of `bytes`.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the operating system reports an error.
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

    /// Waits until all written data is on the disk; afterwards only the renaming of the file can fail.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the operating system reports an error.
    pub fn sync(&mut self) -> Result<(), OutputError> {
        let done = self.writer.flush();
        let done = done.and_then(|()| match self.can_seek() {
            true => self.writer.get_ref().sync_all(),
            false => Ok(()),
        });
        done.map_err(|error| self.error(error))
    }

    /// Moves the file to its final name after its data is on the disk, and synchronises the name.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the operating system reports an error; no part of the file
    /// remains.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.settle().map_err(|error| self.error(error))
    }

    fn settle(&mut self) -> IoResult<()> {
        self.writer.flush()?;
        let Some((temporary, target)) = self.place.take() else {
            return Ok(());
        };
        if let Ok(old) = std::fs::metadata(&target) {
            // The permissions of the old file are kept where the file system supports them.
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

/// Returns stdout as a file without a second buffer.
fn stdout_file() -> IoResult<File> {
    let stdout = std::io::stdout();
    #[cfg(unix)]
    let handle = std::os::fd::AsFd::as_fd(&stdout).try_clone_to_owned();
    #[cfg(windows)]
    let handle = std::os::windows::io::AsHandle::as_handle(&stdout).try_clone_to_owned();
    handle.map(File::from)
}

/// Synchronises the names in a folder to the disk, if the operating system supports this.
fn sync_folder(folder: &Path) -> IoResult<()> {
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        // A disk fault is an error; a file system without this operation is not.
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
            // The position of a pipe is the number of bytes written.
            SeekFrom::Current(0) if !self.can_seek() => Ok(self.written),
            _ => self.writer.seek(to),
        }
    }
}

/// Writes a complete text or image.
///
/// # Errors
/// Returns an [`OutputError`] if the operating system reports an error; an existing file of the name is
/// then unchanged.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let mut file = AtomicFile::create(path)?;
    file.append(bytes)?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn protected_input_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let [input, link, other] =
            ["in.txt", "link.txt", "other.txt"].map(|n| folder.path().join(n));
        for path in [&input, &other] {
            std::fs::write(path, b"mine").unwrap();
        }
        #[cfg(unix)]
        std::os::unix::fs::symlink(&input, &link).unwrap();
        protect_inputs(true);
        crate::read_text(&input, &crate::Budget::SETTINGS).unwrap();
        for path in [&input, &link] {
            if path.exists() {
                let error = write_file(path, b"new").unwrap_err().to_string();
                assert!(error.contains("is an input of this command"), "{error}");
            }
        }
        assert_eq!(std::fs::read(&input).unwrap(), b"mine");
        write_file(&other, b"new").unwrap();
        protect_inputs(false);
        write_file(&input, b"new").unwrap();
    }

    #[test]
    fn file_is_complete_or_absent() {
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
