//! Recordings and robot in memory instead of files.

use crate::robot_dir::LoadedRobot;
use sinew_log::{LogError, OpenOptions, Recording};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Function that opens a recording in memory from its start.
pub type Opener = Arc<dyn Fn(&OpenOptions) -> Result<Recording, LogError> + Send + Sync>;

/// Inputs of a [`Request`](crate::Request) that are in memory; all others are read from files.
#[derive(Clone, Default)]
pub struct Given {
    /// Robot that replaces the folder of the request.
    pub robot: Option<Arc<LoadedRobot>>,
    recordings: Vec<(PathBuf, Opener)>,
}

impl Given {
    /// Adds a recording; `name` is its name in the request.
    #[must_use]
    pub fn with_recording(mut self, name: impl Into<PathBuf>, opener: Opener) -> Self {
        self.recordings.push((name.into(), opener));
        self
    }

    /// Opens the recording in memory with this name, otherwise the file.
    pub(crate) fn open(&self, name: &Path, options: &OpenOptions) -> Result<Recording, LogError> {
        match self.recordings.iter().find(|(stored, _)| stored == name) {
            Some((_, open)) => open(options),
            None => sinew_log::open(name, options),
        }
    }
}

impl fmt::Debug for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = self.recordings.iter().map(|(name, _)| name);
        f.debug_struct("Given")
            .field("robot", &self.robot.as_ref().map(|r| &r.robot.name))
            .field("recordings", &names.collect::<Vec<_>>())
            .finish()
    }
}
