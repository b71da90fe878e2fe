//! File of the trends of all tendons, from which the next run resumes.
//!
//! The first line identifies the file and the version of the program that wrote it. One entry per tendon follows, ordered by robot and
//! joint: number of bytes, checksum, and the tendon with its trend as [postcard](https://docs.rs/postcard). Robots are read and
//! written in batches, which bounds the memory.

use crate::FleetError;
use crate::folder::sides::Tendon;
use sinew_files::AtomicFile;
use sinew_trend::LoadedTrend;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead as _, BufReader, ErrorKind, Read as _};
use std::path::{Path, PathBuf};
use twox_hash::XxHash64;

/// First line of the file before the version.
const MAGIC: &str = "sinew-fleet due 1 ";
/// Version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Maximum size of an entry, bytes; thousands of filters take less than 4 MB.
const MAX_BYTES: usize = 64_000_000;
/// Size of the header of an entry, bytes: length and checksum.
const HEAD_BYTES: usize = 16;

/// Reason why a stored state is not used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StateUnused {
    /// Another version of the program wrote it.
    Version(String),
    /// File truncated or corrupt.
    Damaged,
}

/// State file: the old one is read while the new one is written.
pub(super) struct State {
    path: PathBuf,
    old: Option<BufReader<File>>,
    /// Next tendon of the old file.
    next: Option<(Tendon, Vec<u8>)>,
    new: AtomicFile,
    pub(super) unused: Option<StateUnused>,
}

impl State {
    /// Opens a file, which may be missing.
    ///
    /// # Errors
    /// Returns [`FleetError::NoState`] for a file of another kind.
    pub(super) fn open(path: &Path) -> Result<Self, FleetError> {
        let old = match File::open(path) {
            Ok(file) => Some(BufReader::new(file)),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(source) => {
                return Err(FleetError::StateUnread {
                    path: path.into(),
                    source,
                });
            }
        };
        let mut out = Self {
            path: path.into(),
            old,
            next: None,
            new: AtomicFile::create(path)?,
            unused: None,
        };
        out.check()?;
        out.advance();
        let line = format!("{MAGIC}{VERSION}\n");
        out.new.append(line.as_bytes())?;
        Ok(out)
    }

    /// Reads the first line.
    fn check(&mut self) -> Result<(), FleetError> {
        let Some(old) = &mut self.old else {
            return Ok(());
        };
        const LONGEST: u64 = 200;
        let mut line = Vec::new();
        let read = old.take(LONGEST).read_until(b'\n', &mut line);
        read.map_err(|source| FleetError::StateUnread {
            path: self.path.clone(),
            source,
        })?;
        let line = String::from_utf8_lossy(&line);
        match line.trim_end().strip_prefix(MAGIC) {
            Some(VERSION) => {}
            Some(version) => {
                self.unused = Some(StateUnused::Version(version.to_owned()));
                self.old = None;
            }
            // What mktemp made.
            None if line.is_empty() => self.old = None,
            None => return Err(FleetError::NoState(self.path.clone())),
        }
        Ok(())
    }

    /// Returns the stored trends of robots up to the last of `robots`, in the order of their names.
    pub(super) fn of(&mut self, robots: &[String]) -> BTreeMap<Tendon, Vec<u8>> {
        let mut out = BTreeMap::new();
        let Some(last) = robots.last() else {
            return out;
        };
        while let Some((tendon, trend)) = self.next.take_if(|(tendon, _)| tendon.0 <= *last) {
            out.insert(tendon, trend);
            self.advance();
        }
        out
    }

    /// Reads the next tendon of the old file.
    fn advance(&mut self) {
        let Some(old) = &mut self.old else {
            return;
        };
        match next(old) {
            Some(Some(found)) => self.next = Some(found),
            Some(None) => self.old = None,
            None => {
                self.unused = Some(StateUnused::Damaged);
                self.old = None;
            }
        }
    }

    /// Writes the trend of a tendon; tendons are in the order of their names.
    pub(super) fn keep(&mut self, tendon: &Tendon, trend: &[u8]) -> Result<(), FleetError> {
        let name = encoded(tendon)?;
        let whole = [&name, trend].concat();
        self.new.append(&(whole.len() as u64).to_le_bytes())?;
        self.new
            .append(&XxHash64::oneshot(0, &whole).to_le_bytes())?;
        Ok(self.new.append(&whole)?)
    }

    /// Replaces the old file by the new one.
    pub(super) fn finish(self) -> Result<Option<StateUnused>, FleetError> {
        self.new.finish()?;
        Ok(self.unused)
    }
}

/// The next tendon, or the end; `None`: damaged.
fn next(old: &mut BufReader<File>) -> Option<Option<(Tendon, Vec<u8>)>> {
    if old.fill_buf().ok()?.is_empty() {
        return Some(None);
    }
    let mut head = [0; HEAD_BYTES];
    old.read_exact(&mut head).ok()?;
    let [length, checksum] = [0, 8].map(|at| {
        let bytes = head[at..at + 8].try_into();
        bytes.map_or(u64::MAX, u64::from_le_bytes)
    });
    let length = usize::try_from(length).ok().filter(|n| *n <= MAX_BYTES)?;
    let mut whole = vec![0; length];
    old.read_exact(&mut whole).ok()?;
    if XxHash64::oneshot(0, &whole) != checksum {
        return None;
    }
    let (tendon, trend) = postcard::take_from_bytes::<Tendon>(&whole).ok()?;
    Some(Some((tendon, trend.to_vec())))
}

/// A trend from its bytes; `None`: they are none.
pub(super) fn trend_of(bytes: &[u8]) -> Option<LoadedTrend> {
    postcard::from_bytes(bytes).ok()
}

/// A trend, or a tendon's name, as bytes.
pub(super) fn encoded(value: &impl serde::Serialize) -> Result<Vec<u8>, FleetError> {
    postcard::to_stdvec(value).map_err(|e| FleetError::Engine(e.to_string()))
}
