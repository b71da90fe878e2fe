//! Recordings and a robot that are in memory and no files.

use crate::robot_dir::LoadedRobot;
use sinew_log::{LogError, OpenOptions, Recording};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Opens a recording that is in memory, from its start.
pub type Opener = Arc<dyn Fn(&OpenOptions) -> Result<Recording, LogError> + Send + Sync>;

/// What of a [`Request`](crate::Request) is in memory; everything else is read from files.
#[derive(Clone, Default)]
pub struct Given {
    /// The robot; it stands for the folder that a request may name.
    pub robot: Option<Arc<LoadedRobot>>,
    recordings: Vec<(PathBuf, Opener)>,
}

impl Given {
    /// Adds a recording; `name` is what the request calls it.
    #[must_use]
    pub fn with_recording(mut self, name: impl Into<PathBuf>, opener: Opener) -> Self {
        self.recordings.push((name.into(), opener));
        self
    }

    /// Opens a recording: the one of this name, else the file.
    pub(crate) fn open(&self, name: &Path, options: &OpenOptions) -> Result<Recording, LogError> {
        match self.recordings.iter().find(|(known, _)| known == name) {
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
