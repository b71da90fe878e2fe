//! Files whose content another library writes.

use crate::folder_of;
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// File that another library writes, such as a database: it gets its name once it is complete, is readable by its owner
/// only, and is removed if it is not completed.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    file: File,
}

impl NewFile {
    /// Creates the empty file in the folder of `target`; replaces that of an interrupted run.
    ///
    /// # Errors
    /// Returns an error if the file cannot be created.
    pub fn begin(target: &Path) -> std::io::Result<Self> {
        let path = PathBuf::from(format!("{}.new", target.display()));
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let mut options = File::options();
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let file = options
            .read(true)
            .write(true)
            .create_new(true)
            .open(&path)?;
        Ok(Self { path, file })
    }

    /// Returns the path at which the content is to be written.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Renames the file to its name when its content is on the disk; returns its length, bytes.
    ///
    /// # Errors
    /// Returns an error if the content cannot be synchronised or the file cannot be renamed.
    pub fn finish(self, target: &Path) -> std::io::Result<u64> {
        self.file.sync_all()?;
        let length = self.file.metadata()?.len();
        std::fs::rename(&self.path, target)?;
        #[cfg(unix)]
        File::open(folder_of(target))?.sync_all()?;
        Ok(length)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        // Renamed, or not needed any more.
        let _gone = std::fs::remove_file(&self.path);
    }
}
