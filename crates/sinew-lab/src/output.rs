//! Files that are whole or not there.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that appears under its name only when it is finished.
///
/// Written beside as `NAME.tmp`; dropped unfinished, nothing stays and an older file of the name
/// is untouched.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    temporary: PathBuf,
    writer: Option<BufWriter<File>>,
}

/// What went wrong with an output file.
#[derive(Debug, thiserror::Error)]
#[error("can't write {path}: {error}", path = path.display())]
pub struct OutputError {
    path: PathBuf,
    error: std::io::Error,
}

impl AtomicFile {
    /// Starts a file.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let mut name = path.as_os_str().to_owned();
        name.push(".tmp");
        let temporary = PathBuf::from(name);
        let file = File::create(&temporary).map_err(|error| OutputError {
            path: path.to_path_buf(),
            error,
        })?;
        Ok(Self {
            path: path.to_path_buf(),
            temporary,
            writer: Some(BufWriter::with_capacity(1 << 16, file)),
        })
    }

    /// Writes all of `bytes`.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let Some(writer) = &mut self.writer else {
            return Ok(());
        };
        writer.write_all(bytes).map_err(|error| OutputError {
            path: self.path.clone(),
            error,
        })
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn finish(mut self) -> Result<(), OutputError> {
        let Some(mut writer) = self.writer.take() else {
            return Ok(());
        };
        let result = writer
            .flush()
            .and_then(|()| std::fs::rename(&self.temporary, &self.path));
        if result.is_err() {
            let _ = std::fs::remove_file(&self.temporary);
        }
        result.map_err(|error| OutputError {
            path: self.path.clone(),
            error,
        })
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if self.writer.take().is_some() {
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

/// Writes a whole text or image at once.
///
/// # Errors
/// [`OutputError`] with the path.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let mut file = AtomicFile::create(path)?;
    file.write(bytes)?;
    file.finish()
}
