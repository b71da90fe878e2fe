//! A file of results that a stopped run goes on with: a line of settings, then a line per result.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

/// A file of results that can't be used.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {why}")]
pub struct JournalError {
    /// File.
    file: String,
    /// Why, and what to do.
    why: String,
}

/// What all results of a file have in common.
pub(crate) trait Settings: Serialize + DeserializeOwned + PartialEq {
    /// What the first line begins with.
    const HEAD: &'static str;
    /// What the file holds, in words.
    const HOLDS: &'static str;

    /// Why results of `self` don't go with `wanted`.
    fn difference(&self, wanted: &Self) -> String;
}

/// Tells what results were made with from anything else: FNV-1a, which is stable over versions.
pub(crate) fn checksum(text: &str) -> String {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for byte in text.bytes() {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    format!("{hash:016x}")
}

/// An open file of results, or none: then nothing is kept.
pub(crate) struct Journal {
    name: String,
    file: Option<File>,
}

impl Journal {
    /// Opens or starts the file; returns what is in it already. A last line that was cut off is
    /// removed.
    ///
    /// # Errors
    /// Why the file can't be used, and what to do.
    pub(crate) fn open<S: Settings, R: DeserializeOwned>(
        path: Option<&Path>,
        settings: &S,
    ) -> Result<(Self, Vec<R>), JournalError> {
        let mut journal = Self {
            name: path.map_or_else(String::new, |p| p.display().to_string()),
            file: None,
        };
        let Some(path) = path else {
            return Ok((journal, Vec::new()));
        };
        let wrong = |why: String| journal.refuse(why);
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
        let foreign = || wrong(format!("is not a file of {}; name another", S::HOLDS));
        match lines.next() {
            None if !text.is_empty() && !text.starts_with(S::HEAD) => return Err(foreign()),
            None => {}
            Some(first) => {
                let found: S = serde_json::from_str(first).map_err(|_| foreign())?;
                if found != *settings {
                    let why = found.difference(settings);
                    let holds = S::HOLDS;
                    return Err(wrong(format!(
                        "holds {holds} of other settings: {why}; name another file"
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
            journal.add(settings)?;
        }
        Ok((journal, done))
    }

    /// Adds a line.
    ///
    /// # Errors
    /// Why it can't be written.
    pub(crate) fn add<T: Serialize>(&mut self, value: &T) -> Result<(), JournalError> {
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        let written = serde_json::to_string(value).map_err(|e| e.to_string());
        // One call, so that a line is there as a whole unless the machine stops.
        let written = written.and_then(|text| {
            (file.write_all((text + "\n").as_bytes()))
                .and_then(|()| file.flush())
                .map_err(|e| format!("can't write: {e}"))
        });
        written.map_err(|why| self.refuse(why))
    }

    fn refuse(&self, why: String) -> JournalError {
        JournalError {
            file: self.name.clone(),
            why,
        }
    }
}
