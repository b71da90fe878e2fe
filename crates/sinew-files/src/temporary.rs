//! Temporary files with an exclusive writer, removed after a crash.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Result as IoResult};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Maximum number of characters of the requested name in a temporary name, because file systems permit 255 bytes.
const NAME_KEPT: usize = 40;

/// A file that is deleted unless it is given a name.
///
/// On Linux it has no name while it is written, if the file system supports this: the file disappears
/// when the process ends for any reason. Elsewhere its name is `.NAME.sinew-PROCESS-NUMBER.tmp`. Its
/// process holds a lock on it, so that a later run can identify the files of a crashed run.
#[derive(Debug)]
pub struct Temporary(Place);

#[derive(Debug)]
enum Place {
    Named(PathBuf),
    /// Folder of the file, and prefix of its later name.
    #[cfg_attr(not(target_os = "linux"), allow(dead_code))]
    Unnamed(PathBuf, String),
    /// Renamed to the requested name.
    Settled,
}

impl Temporary {
    /// Creates an empty file for `name` in `folder`, open for reading and writing, and without a name if the operating
    /// system supports this. Removes temporary files of terminated runs for that name.
    ///
    /// # Errors
    /// Returns the error of the operating system.
    pub fn create(folder: &Path, name: &str) -> IoResult<(File, Self)> {
        #[cfg(target_os = "linux")]
        if let Some(file) = unnamed::create(folder) {
            let start = start(name);
            remove_dead(folder, &start);
            // Without locks, no file is assumed to belong to a crashed run.
            let _without = file.lock();
            return Ok((file, Self(Place::Unnamed(folder.to_path_buf(), start))));
        }
        Self::create_named(folder, name)
    }

    /// Creates an empty file with a name.
    ///
    /// # Errors
    /// Returns the error of the operating system.
    pub fn create_named(folder: &Path, name: &str) -> IoResult<(File, Self)> {
        let start = start(name);
        remove_dead(folder, &start);
        loop {
            let path = next_name(folder, &start);
            // Never a file that is there: another program's, or one left by a crash.
            let mut options = OpenOptions::new();
            match options.read(true).write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(error),
                Ok(file) => {
                    let _without = file.lock();
                    // Taken for dead between its making and its lock.
                    if path.try_exists()? {
                        return Ok((file, Self(Place::Named(path))));
                    }
                }
            }
        }
    }

    /// Gives the open `file` a temporary name if it has none, for a library that needs its path.
    ///
    /// # Errors
    /// Returns the error of the operating system.
    pub fn expose(&mut self, file: &File) -> IoResult<()> {
        if let Place::Unnamed(folder, start) = &self.0 {
            self.0 = Place::Named(name(file, folder, start)?);
        }
        Ok(())
    }

    /// Path of the file, if it has a name.
    pub fn path(&self) -> Option<&Path> {
        match &self.0 {
            Place::Named(path) => Some(path),
            Place::Unnamed(..) | Place::Settled => None,
        }
    }

    /// Renames the open `file` to its final name and replaces an existing file; returns whether there
    /// was one.
    ///
    /// # Errors
    /// Returns the error of the operating system.
    pub fn rename(mut self, file: &File, to: &Path) -> IoResult<bool> {
        if matches!(self.0, Place::Unnamed(..)) {
            match link(file, to) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => self.expose(file)?,
                done => return done.map(|()| false),
            }
        }
        let replaces = to.try_exists().unwrap_or(false);
        if let Place::Named(path) = &self.0 {
            std::fs::rename(path, to)?;
            self.0 = Place::Settled;
        }
        Ok(replaces)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Place::Named(path) = &self.0 {
            // Nothing can be done about a failure here; the next run tries again.
            let _left_behind = std::fs::remove_file(path);
        }
    }
}

/// How the temporary names for `name` begin.
fn start(name: &str) -> String {
    let kept: String = name.chars().take(NAME_KEPT).collect();
    format!(".{kept}.sinew-")
}

/// A name that no other file of this process has.
fn next_name(folder: &Path, start: &str) -> PathBuf {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    folder.join(format!("{start}{}-{number}.tmp", std::process::id()))
}

/// Temporarily names an unnamed file: a named file can replace another, an unnamed one cannot.
fn name(file: &File, folder: &Path, start: &str) -> IoResult<PathBuf> {
    loop {
        let path = next_name(folder, start);
        match link(file, &path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            done => return done.map(|()| path),
        }
    }
}

#[cfg(target_os = "linux")]
use unnamed::link;

#[cfg(not(target_os = "linux"))]
fn link(_file: &File, _path: &Path) -> IoResult<()> {
    Err(ErrorKind::Unsupported.into())
}

#[cfg(target_os = "linux")]
mod unnamed {
    use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat, open};
    use std::fs::File;
    use std::io::Result as IoResult;
    use std::os::fd::AsRawFd as _;
    use std::path::{Path, PathBuf};

    /// A file without a name; none where the file system has no such files, or no name could be given.
    pub(super) fn create(folder: &Path) -> Option<File> {
        let how = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
        let file = File::from(open(folder, how, Mode::from_raw_mode(0o666)).ok()?);
        descriptor(&file).exists().then_some(file)
    }

    pub(super) fn link(file: &File, path: &Path) -> IoResult<()> {
        let from = descriptor(file);
        Ok(linkat(CWD, from, CWD, path, AtFlags::SYMLINK_FOLLOW)?)
    }

    fn descriptor(file: &File) -> PathBuf {
        format!("/proc/self/fd/{}", file.as_raw_fd()).into()
    }
}

/// Removes files of dead runs: those that begin with `start` and that no process holds a lock on.
fn remove_dead(folder: &Path, start: &str) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let numbers = name.to_str().and_then(|n| n.strip_prefix(start));
        let Some(numbers) = numbers.and_then(|n| n.strip_suffix(".tmp")) else {
            continue;
        };
        let parts = numbers.split_once('-').map(|(a, b)| [a, b]);
        let digits = |t: &str| !t.is_empty() && t.bytes().all(|b| b.is_ascii_digit());
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if !is_file || !parts.is_some_and(|parts| parts.into_iter().all(digits)) {
            continue;
        }
        let Ok(file) = OpenOptions::new().write(true).open(entry.path()) else {
            continue;
        };
        match file.try_lock() {
            Ok(()) => drop(std::fs::remove_file(entry.path())),
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cleanup_removes_only_files_of_crashed_runs() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let others = [
            "a.csv.tmp",
            ".a.csv.sinew-notes.tmp",
            ".a.csv.sinew-1-x.tmp",
            ".b.csv.sinew-1-1.tmp",
            ".a.csv.sinew-1-1.bak",
        ];
        let dead = ".a.csv.sinew-1-1.tmp";
        for name in others.iter().chain([&dead]) {
            std::fs::write(place(name), "mine").unwrap();
        }
        let (_open, living) = Temporary::create_named(folder.path(), "a.csv").unwrap();
        let (_file, second) = Temporary::create_named(folder.path(), "a.csv").unwrap();
        assert!(living.path().unwrap().exists() && second.path().unwrap().exists());
        assert!(!place(dead).exists());
        for name in others {
            assert_eq!(std::fs::read(place(name)).unwrap(), b"mine", "{name}");
        }
        drop((living, second));
        let count = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(count, others.len());
    }
}
