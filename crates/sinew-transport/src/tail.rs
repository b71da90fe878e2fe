//! Growing MCAP recording: a file that is being written, or the newest file of a folder.
//!
//! The file is polled, because network file systems do not notify of changes. An incomplete record or chunk is waited
//! for. In a folder, the next file by name is read when the present one is closed, or has stopped growing while a
//! next one exists. A file replaced by another of the same name is read from its start.

use crate::error::TransportFault;
use crate::handle::{Shared, Transport, TransportError};
use crate::received::Clock;
use crate::records::{Recorded, Records, State};
use crate::route::{Channels, Routes};
use sinew_files::names::natural_key;
use std::fs::{File, Metadata};
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Length of one read, bytes.
const READ_BYTES: usize = 256 << 10;
/// Buffer capacity that is kept after long records, bytes.
const MAX_IDLE_CAPACITY_BYTES: usize = 8 << 20;
/// Maximum number of further attempts to read an unreadable record.
const MAX_READ_ATTEMPTS: u32 = 3;
/// Number of polls without growth before the next file of a folder is begun.
const MAX_IDLE_POLLS: u32 = 3;
/// Number of bytes at the start of a file by which a replaced file is recognised.
const HEAD_BYTES: usize = 256;

/// Options for reading a growing recording.
#[derive(Debug, Clone)]
pub struct TailOptions {
    /// File, which may not exist yet, or folder of `.mcap` files.
    pub path: PathBuf,
    /// Position at which reading begins.
    pub from: From,
    /// Polling interval, s.
    pub look_every_s: f64,
}

/// Position at which reading begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum From {
    /// Start of the file, or of the first file of the folder.
    Start,
    /// Present end of the file, or of the last file of the folder.
    Now,
}

impl TailOptions {
    /// Reads new data only and polls five times per second.
    pub fn of(path: PathBuf) -> Self {
        TailOptions {
            path,
            from: From::Now,
            look_every_s: 0.2,
        }
    }
}

/// Opens the transport; the recording is followed until the transport is dropped.
///
/// # Errors
/// Returns [`TransportError::Option`] if the polling interval is below 1 ms or above 60 s.
pub fn open(
    options: &TailOptions,
    routes: &Routes,
    clock: Clock,
) -> Result<Transport, TransportError> {
    let every_s = options.look_every_s;
    if !(0.001..=60.0).contains(&every_s) {
        return Err(TransportError::Option {
            what: "look_every_s",
            value: format!("{every_s} s"),
            reason: "expected 0.001 s to 60 s".to_owned(),
        });
    }
    let name = format!("mcap:{}", options.path.display());
    let tail = Tail {
        options: options.clone(),
        every: Duration::from_secs_f64(every_s),
        channels: Channels::new(routes),
        clock,
        record: Vec::new(),
    };
    Transport::run(Shared::new(name), move |shared| tail.follow(shared))
}

/// Checks whether the path is a readable recording, as far as its first bytes show: a file, possibly still being
/// written, or a folder, possibly empty.
///
/// # Errors
/// Returns [`TransportError::Io`] if the path does not exist or cannot be read, and [`TransportError::Content`] if
/// the file is not an MCAP or its records are invalid.
pub fn check(path: &Path) -> Result<(), TransportError> {
    let transport = format!("mcap:{}", path.display());
    let io = |source| TransportError::Io {
        transport: transport.clone(),
        source,
    };
    let content = |reason| TransportError::Content {
        transport: transport.clone(),
        reason,
    };
    if path.is_dir() {
        return std::fs::read_dir(path).map(drop).map_err(io);
    }
    let mut head = Vec::new();
    let file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    file.take(READ_BYTES as u64)
        .read_to_end(&mut head)
        .map_err(io)?;
    let magic_bytes = head.len().min(mcap::MAGIC.len());
    if head[..magic_bytes] != mcap::MAGIC[..magic_bytes] {
        return Err(content("not an MCAP file".into()));
    }
    let mut records = Records::new();
    let (mut head, mut record) = (&head[..], Vec::new());
    // An incomplete record, or one longer than the inspected part, ends the check.
    while records
        .next(&mut head, length.saturating_sub(records.read), &mut record)
        .map_err(content)?
    {
        match records.feed(&record, |_| true) {
            State::Broken(reason) => return Err(content(reason)),
            State::Ended => break,
            State::Wants => {}
        }
    }
    Ok(())
}

struct Tail {
    options: TailOptions,
    every: Duration,
    channels: Channels,
    clock: Clock,
    /// Buffer of the present record.
    record: Vec<u8>,
}

/// File that is being followed.
struct Following {
    path: PathBuf,
    file: BufReader<File>,
    records: Records,
    identity: Option<(u64, u64)>,
    head: Vec<u8>,
    /// Messages before this byte existed already and are skipped.
    new_from: u64,
    idle_polls: u32,
    /// Number of attempts to read an unreadable record.
    attempts: u32,
    /// Whether nothing more can be read from the file.
    is_done: bool,
}

impl Tail {
    fn follow(mut self, shared: &Shared) {
        let mut following: Option<Following> = None;
        let mut is_first = true;
        while !shared.stops() {
            let Some(now) = &mut following else {
                match self.begin(is_first) {
                    Ok(begun) => {
                        is_first = false;
                        self.channels.forget();
                        shared.set_disconnected(None);
                        let transport = shared.name().to_owned();
                        self.report(&TransportFault::Connected { transport });
                        following = Some(begun);
                    }
                    Err(reason) => {
                        // A file that appears later is read from its start.
                        is_first = false;
                        shared.set_disconnected(Some(reason));
                        std::thread::sleep(self.every);
                    }
                }
                continue;
            };
            if self.read(now, shared) {
                continue;
            }
            if let Some(next) = self.next(now) {
                self.channels.forget();
                shared.set_disconnected(None);
                following = Some(next);
                continue;
            }
            std::thread::sleep(self.every);
        }
    }

    fn report(&self, fault: &TransportFault) {
        self.channels.report_all(self.clock.now(), fault);
    }

    /// Opens the first file to follow.
    fn begin(&self, is_first: bool) -> Result<Following, String> {
        let skips = is_first && self.options.from == From::Now;
        let path = &self.options.path;
        if !path.is_dir() {
            return Following::of(path, skips);
        }
        let files = mcaps(path)?;
        let file = match self.options.from {
            From::Start => files.first(),
            From::Now => files.last(),
        };
        let file = file.ok_or_else(|| format!("no .mcap file in {}", path.display()))?;
        Following::of(file, skips)
    }

    /// Reads the new data; returns whether there were any.
    fn read(&mut self, now: &mut Following, shared: &Shared) -> bool {
        if now.is_done {
            return false;
        }
        let mut record = std::mem::take(&mut self.record);
        let mut has_read = false;
        let mut available = now.available();
        while !now.is_done && !shared.stops() {
            let next = available.and_then(|available| {
                let records = &now.records;
                let there = records.next(&mut now.file, available, &mut record)?;
                Ok(there.then_some(available))
            });
            let there = match next {
                Ok(Some(there)) => there,
                Ok(None) => break,
                Err(reason) => {
                    self.skip_damaged(now, reason, shared);
                    has_read = true;
                    break;
                }
            };
            let length = record.len() as u64;
            available = Ok(there.saturating_sub(length));
            let is_new = now.records.read + length > now.new_from;
            let state = now.records.feed(&record, |recorded| {
                !is_new || self.message(&recorded, shared)
            });
            match state {
                State::Wants => {
                    let missing = HEAD_BYTES - now.head.len();
                    now.head
                        .extend_from_slice(&record[..record.len().min(missing)]);
                    has_read = true;
                }
                State::Ended => now.is_done = true,
                // A record written in two steps may be complete at the next poll.
                State::Broken(_) if now.attempts < MAX_READ_ATTEMPTS => {
                    now.attempts += 1;
                    break;
                }
                State::Broken(reason) => self.skip_damaged(now, reason, shared),
            }
            now.attempts = 0;
        }
        // Memory is released after an unusually long record.
        record.clear();
        record.shrink_to(MAX_IDLE_CAPACITY_BYTES);
        self.record = record;
        if has_read {
            now.idle_polls = 0;
        }
        has_read
    }

    fn skip_damaged(&self, now: &mut Following, reason: String, shared: &Shared) {
        now.is_done = true;
        let file = now.path.display().to_string();
        let offset = now.records.read;
        // The file yields nothing more until it is replaced.
        shared.set_disconnected(Some(format!(
            "{file} damaged at byte {offset}: {reason}; waiting for the next recording"
        )));
        self.report(&TransportFault::Damaged {
            file,
            offset,
            reason,
        });
    }

    /// Forwards a message; returns `false` if the transport shall be closed.
    fn message(&mut self, recorded: &Recorded<'_>, shared: &Shared) -> bool {
        let targets = self.channels.of(recorded);
        if targets.is_empty() {
            return !shared.stops();
        }
        if !targets.wait_for_room(recorded.cdr.len(), shared) {
            return false;
        }
        shared.count(1);
        targets.message(self.clock.now(), recorded.logged_ns, &[recorded.cdr]);
        !shared.stops()
    }

    /// Returns the file to continue with when no new data arrive: the same file again, or the next file of the
    /// folder.
    fn next(&self, now: &mut Following) -> Option<Following> {
        now.idle_polls = now.idle_polls.saturating_add(1);
        if now.was_replaced() {
            let next = Following::of(&now.path, false).ok()?;
            let file = now.path.display().to_string();
            self.report(&TransportFault::Replaced { file });
            return Some(next);
        }
        let folder = &self.options.path;
        if !folder.is_dir() || !(now.is_done || now.idle_polls >= MAX_IDLE_POLLS) {
            return None;
        }
        let later = mcaps(folder).ok()?;
        let here = natural_key(&now.path.to_string_lossy());
        let next = later
            .into_iter()
            .find(|path| natural_key(&path.to_string_lossy()) > here)?;
        let begun = Following::of(&next, false).ok()?;
        let file = next.display().to_string();
        self.report(&TransportFault::NextFile { file });
        Some(begun)
    }
}

impl Following {
    /// Opens a file; with `skips`, existing data are skipped.
    fn of(path: &Path, skips: bool) -> Result<Self, String> {
        let io_error = |error: std::io::Error| format!("{}: {error}", path.display());
        let file = File::open(path).map_err(io_error)?;
        let metadata = file.metadata().map_err(io_error)?;
        if !metadata.is_file() {
            return Err(format!("{}: not a regular file", path.display()));
        }
        Ok(Following {
            path: path.to_owned(),
            file: BufReader::with_capacity(READ_BYTES, file),
            records: Records::new(),
            identity: identity(&metadata),
            head: Vec::new(),
            new_from: if skips { metadata.len() } else { 0 },
            idle_polls: 0,
            attempts: 0,
            is_done: false,
        })
    }

    /// Seeks behind the records read and returns the number of bytes that follow. An incomplete record is read again,
    /// because it may have changed.
    fn available(&mut self) -> Result<u64, String> {
        let at = self.records.read;
        let available = |file: &mut BufReader<File>| {
            file.seek(SeekFrom::Start(at))?;
            Ok(file.get_ref().metadata()?.len().saturating_sub(at))
        };
        available(&mut self.file).map_err(|error: std::io::Error| error.to_string())
    }

    /// Whether another file has taken the name, or the file was rewritten.
    fn was_replaced(&mut self) -> bool {
        let Ok(mut file) = File::open(&self.path) else {
            // The file was removed: it may return.
            return false;
        };
        let Ok(metadata) = file.metadata() else {
            return false;
        };
        if identity(&metadata) != self.identity || metadata.len() < self.records.read {
            return true;
        }
        let mut head = vec![0; self.head.len()];
        let read = file
            .seek(SeekFrom::Start(0))
            .and(file.read_exact(&mut head));
        read.is_ok() && head != self.head
    }
}

/// Returns device and inode number, which identify a file, if the system provides them.
fn identity(metadata: &Metadata) -> Option<(u64, u64)> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        Some((metadata.dev(), metadata.ino()))
    }
    #[cfg(not(unix))]
    {
        let _unavailable = metadata;
        None
    }
}

/// Returns the recordings of a folder in natural order of their names.
fn mcaps(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = std::fs::read_dir(folder);
    let entries = entries.map_err(|error| format!("{}: {error}", folder.display()))?;
    let files = entries.filter_map(|entry| entry.ok().map(|entry| entry.path()));
    let is_mcap = |path: &PathBuf| path.extension().is_some_and(|end| end == "mcap");
    let mut files: Vec<PathBuf> = files
        .filter(is_mcap)
        .filter(|path| path.is_file())
        .collect();
    files.sort_by_cached_key(|path| natural_key(&path.to_string_lossy()));
    Ok(files)
}
