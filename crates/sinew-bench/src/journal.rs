//! File of results from which a stopped run resumes: a line of settings, then a line per result.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sinew_files::Budget;
use sinew_files::lock::lock;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

/// Error of a file of results.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct JournalError {
    /// Path of the file.
    file: String,
    /// Reason and remedy.
    reason: String,
}

/// Kind of stored results.
pub(crate) struct Kind {
    /// Format name in the first line of its files.
    pub(crate) format: &'static str,
    /// Format version, raised when the results or their format change: older files cannot be resumed.
    pub(crate) version: u32,
    /// Description of the content, for messages.
    pub(crate) holds: &'static str,
}

/// Setting common to all results of a file: its name, its value, and the message about a file with another value,
/// which replaces `{}`.
pub(crate) type Setting = (&'static str, String, &'static str);

/// The first line of a file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    format: String,
    version: u32,
    /// Version of the program.
    program: String,
    settings: BTreeMap<String, String>,
}

impl Head {
    /// Returns the reason why results under this header cannot be resumed with `settings`.
    fn difference(&self, wanted: &Self, settings: &[Setting]) -> Option<String> {
        let value = |name: &str| self.settings.get(name).map_or("", String::as_str);
        if let Some((name, _, other)) = settings.iter().find(|(name, own, _)| value(name) != own) {
            Some(other.replace("{}", value(name)))
        } else if self.program != wanted.program {
            Some(format!("versions {} and {}", self.program, wanted.program))
        } else if self.version != wanted.version {
            Some(format!(
                "estimator {}, now {}",
                self.version, wanted.version
            ))
        } else {
            None
        }
    }
}

/// Returns a checksum of the inputs of the results: FNV-1a, which is stable over versions.
pub(crate) fn checksum(text: &str) -> String {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for byte in text.bytes() {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    format!("{hash:016x}")
}

/// Open file of results; without a file nothing is stored.
pub(crate) struct Journal {
    name: String,
    file: Option<File>,
}

impl Journal {
    /// Opens or creates the file and returns its stored results. A truncated last line is removed.
    ///
    /// # Errors
    /// Returns a message if the file cannot be used, with the remedy.
    pub(crate) fn open<R: DeserializeOwned>(
        path: Option<&Path>,
        kind: &Kind,
        settings: &[Setting],
    ) -> Result<(Self, Vec<R>), JournalError> {
        let mut journal = Self {
            name: path.map_or_else(String::new, |p| p.display().to_string()),
            file: None,
        };
        let Some(path) = path else {
            return Ok((journal, Vec::new()));
        };
        let wanted = Head {
            format: kind.format.into(),
            version: kind.version,
            program: env!("CARGO_PKG_VERSION").into(),
            settings: (settings.iter())
                .map(|(name, value, _)| ((*name).into(), value.clone()))
                .collect(),
        };
        let start = format!("{{\"format\":\"{}\"", kind.format);
        let wrong = |reason: String| journal.error(reason);
        let io = |e: std::io::Error| wrong(format!("cannot be used: {e}"));
        let is_file = std::fs::metadata(path).map_or(true, |about| about.is_file());
        if !is_file || sinew_files::is_stdout(path) {
            return Err(wrong(
                "--out requires a regular file, because a stopped run resumes from it; specify a file".into(),
            ));
        }
        let mut options = OpenOptions::new();
        let options = options.read(true).append(true).create(true);
        let mut file = options.open(path).map_err(io)?;
        lock(&file).map_err(|holder| {
            wrong(format!(
                "another run is writing it ({holder}); wait for it, or specify another file"
            ))
        })?;
        let length = file.metadata().map_err(io)?.len();
        Budget::TABLE.memory.check(length).map_err(wrong)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(|e| match e.kind() {
            ErrorKind::InvalidData => wrong("is not text; specify another file".into()),
            _ => io(e),
        })?;
        let whole = text.rfind('\n').map_or(0, |at| at + 1);
        let mut lines = text[..whole].lines();
        let mut done = Vec::new();
        let foreign = || {
            wrong(format!(
                "is not a file of {}; specify another file",
                kind.holds
            ))
        };
        match lines.next() {
            None if !text.is_empty() && !start.starts_with(&text) && !text.starts_with(&start) => {
                return Err(foreign());
            }
            None => {}
            Some(first) => {
                if !first.starts_with(&start) {
                    return Err(foreign());
                }
                let found: Option<Head> = serde_json::from_str(first).ok();
                let reason = found.map_or(Some("another version".into()), |f| {
                    f.difference(&wanted, settings)
                });
                if let Some(reason) = reason {
                    let holds = kind.holds;
                    return Err(wrong(format!(
                        "contains {holds} with other settings: {reason}; specify another file"
                    )));
                }
                for (k, line) in lines.enumerate() {
                    let result = serde_json::from_str(line);
                    done.push(result.map_err(|e| {
                        wrong(format!("line {} is damaged: {e}; remove it", k + 2))
                    })?);
                }
            }
        }
        file.set_len(whole as u64).map_err(io)?;
        journal.file = Some(file);
        if whole == 0 {
            journal.add(&wanted)?;
        }
        Ok((journal, done))
    }

    /// Adds a line.
    ///
    /// # Errors
    /// Returns a message if it cannot be written.
    pub(crate) fn add<T: Serialize>(&mut self, value: &T) -> Result<(), JournalError> {
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        let written = serde_json::to_string(value).map_err(|e| e.to_string());
        // One call, so that a line is there as a whole unless the machine stops.
        let written = written.and_then(|text| {
            (file.write_all((text + "\n").as_bytes()))
                .and_then(|()| file.flush())
                .map_err(|e| format!("cannot write: {e}"))
        });
        written.map_err(|reason| self.error(reason))
    }

    fn error(&self, reason: String) -> JournalError {
        JournalError {
            file: self.name.clone(),
            reason,
        }
    }
}
