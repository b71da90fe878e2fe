//! The file of sessions: a line of settings, then a line per session.

use super::{ChainError, ChainRequest, Session};
use serde::{Deserialize, Serialize};
use sinew_model::robot::Robot;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// What all sessions of a file have in common.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    format: String,
    version: u32,
    /// Version of the program.
    program: String,
    /// Robot.
    robot: String,
    /// Joints watched: the strand fails in one of them.
    joints: Vec<String>,
    /// Check or work.
    session: super::SessionKind,
    /// Whether each session starts from the last one's posterior.
    chained: bool,
}

impl Settings {
    pub(super) fn new(robot: &Robot, joints: &[String], request: &ChainRequest) -> Self {
        Self {
            format: "sinew-sessions".into(),
            version: 1,
            program: env!("CARGO_PKG_VERSION").into(),
            robot: robot.name.clone(),
            joints: joints.to_vec(),
            session: request.kind,
            chained: request.chained,
        }
    }
}

/// An open file of sessions.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens or starts the file; returns what is in it already. A last line that was cut off is
    /// removed.
    pub(super) fn open(
        path: &Path,
        settings: &Settings,
    ) -> Result<(Self, Vec<Session>), ChainError> {
        let wrong = |why: String| ChainError::Journal {
            file: path.display().to_string(),
            why,
        };
        let io = |e: std::io::Error| wrong(format!("can't be used: {e}"));
        let mut file = OpenOptions::new()
            .read(true)
            // Two runs with one file repeat each other's work, but spoil nothing.
            .append(true)
            .create(true)
            .open(path)
            .map_err(io)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(|e| match e.kind() {
            ErrorKind::InvalidData => wrong("is not text; name another file".into()),
            _ => io(e),
        })?;
        let whole = text.rfind('\n').map_or(0, |at| at + 1);
        let mut lines = text[..whole].lines();
        let mut done = Vec::new();
        let foreign = || wrong("is not a file of simulated sessions; name another".into());
        match lines.next() {
            None if !text.is_empty() && !text.starts_with("{\"format\":\"sinew-sess") => {
                return Err(foreign());
            }
            None => {}
            Some(first) => {
                let found: Settings = serde_json::from_str(first).map_err(|_| foreign())?;
                if found != *settings {
                    return Err(wrong(difference(&found, settings)));
                }
                for (k, line) in lines.enumerate() {
                    done.push(serde_json::from_str(line).map_err(|e| {
                        wrong(format!("line {} is damaged: {e}; remove it", k + 2))
                    })?);
                }
            }
        }
        file.set_len(whole as u64).map_err(io)?;
        let mut journal = Self {
            path: path.into(),
            file,
        };
        if whole == 0 {
            journal.line(settings)?;
        }
        Ok((journal, done))
    }

    /// Adds a session.
    pub(super) fn add(&mut self, session: &Session) -> Result<(), ChainError> {
        self.line(session)
    }

    fn line<T: Serialize>(&mut self, value: &T) -> Result<(), ChainError> {
        let wrong = |why: String| ChainError::Journal {
            file: self.path.display().to_string(),
            why,
        };
        let mut text = serde_json::to_string(value).map_err(|e| wrong(e.to_string()))?;
        text.push('\n');
        // One call, so that a line is there as a whole unless the machine stops.
        self.file
            .write_all(text.as_bytes())
            .and_then(|()| self.file.flush())
            .map_err(|e| wrong(format!("can't write: {e}")))
    }
}

fn difference(found: &Settings, wanted: &Settings) -> String {
    let what = if found.session != wanted.session {
        format!("{} sessions (--session)", found.session.name())
    } else if found.chained != wanted.chained {
        "with and without --chained".to_string()
    } else if found.robot != wanted.robot {
        format!("robot '{}'", found.robot)
    } else if found.joints != wanted.joints {
        format!("joints {} (--joints)", found.joints.join(", "))
    } else {
        format!("version {} of the program", found.program)
    };
    format!("holds sessions of other settings: {what}; name another file")
}
