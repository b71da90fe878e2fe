//! The file of results: a line of settings, then a line per recording.

use super::{Recording, ScenarioError};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What all recordings of a file have in common.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    format: String,
    version: u32,
    /// Version of the program.
    pub(super) program: String,
    /// Checksum of robot and scenarios.
    pub(super) scenarios: String,
    /// With session C.
    pub(super) steps: bool,
    /// With the motor's torque.
    pub(super) motor_torque: bool,
}

impl Settings {
    pub(super) fn new(scenarios: String, steps: bool, motor_torque: bool) -> Self {
        Self {
            format: "sinew-scenarios".into(),
            version: 1,
            program: env!("CARGO_PKG_VERSION").into(),
            scenarios,
            steps,
            motor_torque,
        }
    }
}

/// An open file of results.
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
    ) -> Result<(Self, Vec<Recording>), ScenarioError> {
        let wrong = |why: String| ScenarioError::Journal {
            file: path.display().to_string(),
            why,
        };
        let io = |e: std::io::Error| wrong(format!("can't be used: {e}"));
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
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
        match lines.next() {
            None if !text.is_empty() && !text.starts_with("{\"format\":\"sinew-scen") => {
                return Err(wrong(
                    "is not a file of scenario results; name another".into(),
                ));
            }
            None => {}
            Some(first) => {
                let found: Settings = serde_json::from_str(first)
                    .map_err(|_| wrong("is not a file of scenario results; name another".into()))?;
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
        file.seek(SeekFrom::End(0)).map_err(io)?;
        let mut journal = Self {
            path: path.into(),
            file,
        };
        if whole == 0 {
            journal.line(settings)?;
        }
        Ok((journal, done))
    }

    /// Adds a recording.
    pub(super) fn add(&mut self, recording: &Recording) -> Result<(), ScenarioError> {
        self.line(recording)
    }

    fn line<T: Serialize>(&mut self, value: &T) -> Result<(), ScenarioError> {
        let wrong = |why: String| ScenarioError::Journal {
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
    let what = if found.steps != wanted.steps {
        "with and without session C (--no-steps)".to_string()
    } else if found.motor_torque != wanted.motor_torque {
        "with and without motor torque (--no-motor-torque)".to_string()
    } else if found.program != wanted.program || found.version != wanted.version {
        format!("of versions {} and {}", found.program, wanted.program)
    } else {
        "of other scenarios than this program's".to_string()
    };
    format!("holds results of other settings: {what}; name another file")
}
