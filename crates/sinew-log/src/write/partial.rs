//! A file that gets its name only when it is complete.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use crate::error::LogError;

const BUFFER_BYTES: usize = 1 << 20;

/// The temporary file; removed when dropped before [`Partial::finish`].
#[derive(Debug)]
pub(super) struct Partial {
    target: PathBuf,
    temporary: PathBuf,
    finished: bool,
}

impl Partial {
    pub(super) fn create(target: &Path) -> Result<(Partial, BufWriter<File>), LogError> {
        let mut temporary = target.as_os_str().to_owned();
        temporary.push(".tmp");
        let temporary = PathBuf::from(temporary);
        let file = File::create(&temporary).map_err(|source| LogError::Io {
            file: target.display().to_string(),
            action: "create",
            source,
        })?;
        let partial = Partial {
            target: target.to_owned(),
            temporary,
            finished: false,
        };
        Ok((partial, BufWriter::with_capacity(BUFFER_BYTES, file)))
    }

    pub(super) fn name(&self) -> String {
        self.target.display().to_string()
    }

    pub(super) fn io(&self, action: &'static str, source: std::io::Error) -> LogError {
        LogError::Io {
            file: self.name(),
            action,
            source,
        }
    }

    /// The file is complete: give it its name.
    pub(super) fn finish(mut self) -> Result<(), LogError> {
        std::fs::rename(&self.temporary, &self.target)
            .map_err(|source| self.io("rename", source))?;
        self.finished = true;
        Ok(())
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if !self.finished {
            // Nothing can be done about a failure here, and the name says what it is.
            let _left_behind = std::fs::remove_file(&self.temporary);
        }
    }
}
