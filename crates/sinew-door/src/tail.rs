//! An MCAP that grows: a recorder's file, or the newest of a folder, read as it is written.
//!
//! The file is looked at every so often, since network disks tell nobody of changes. A record or chunk that isn't
//! whole yet is waited for. In a folder the next file, by name, is read when the one before it
//! ends, or stops to grow while there is a next one. A file replaced by another of its name is read from its start.

use crate::handle::{Door, DoorError, Shared};
use crate::received::Clock;
use crate::records::{Recorded, Records, State};
use crate::route::{Channels, Routes};
use crate::trouble::Trouble;
use sinew_files::names::natural_key;
use std::fs::{File, Metadata};
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// One read, bytes.
const PIECE: usize = 256 << 10;
/// Room that is kept for longer records, bytes.
const KEPT: usize = 8 << 20;
/// So often a record that can't be read is looked at again.
const TRIES: u32 = 3;
/// Looks without growth before the next file of a folder is begun.
const STILL_LOOKS: u32 = 3;
/// Bytes of the file's start that tell it from another of its name.
const HEAD: usize = 256;

/// How a growing recording is read.
#[derive(Debug, Clone)]
pub struct TailOptions {
    /// A file, which need not be there yet, or a folder of files that end in `.mcap`.
    pub path: PathBuf,
    /// What was recorded before the door was opened: read, or left out.
    pub from: From,
    /// Time from one look to the next, s.
    pub look_every_s: f64,
}

/// Where reading begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum From {
    /// At the start: of the file, of the folder's first file.
    Start,
    /// At what is written from now on: of the file, of the folder's last file.
    Now,
}

impl TailOptions {
    /// What is written from now on, looked at five times a second.
    pub fn of(path: PathBuf) -> Self {
        TailOptions {
            path,
            from: From::Now,
            look_every_s: 0.2,
        }
    }
}

/// Opens it; it reads until the door is dropped.
///
/// # Errors
/// A time between looks below 1 ms or above a minute.
pub fn open(options: &TailOptions, routes: &Routes, clock: Clock) -> Result<Door, DoorError> {
    let every_s = options.look_every_s;
    if !(0.001..=60.0).contains(&every_s) {
        return Err(DoorError::Option {
            what: "look_every_s",
            value: format!("{every_s} s"),
            why: "it is 0.001 s to 60 s".to_owned(),
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
    Door::run(Shared::new(name), move |shared| tail.follow(shared))
}

/// Looks whether there is a recording that can be read, as far as its first bytes tell: a file that has begun to be
/// written, or a folder, which may be empty yet.
///
/// # Errors
/// [`DoorError::Io`]: nothing is there, or the system refuses. [`DoorError::Content`]: it is no MCAP, or its records
/// are broken.
pub fn check(path: &Path) -> Result<(), DoorError> {
    let door = format!("mcap:{}", path.display());
    let io = |source| DoorError::Io {
        door: door.clone(),
        source,
    };
    let content = |why| DoorError::Content {
        door: door.clone(),
        why,
    };
    if path.is_dir() {
        return std::fs::read_dir(path).map(drop).map_err(io);
    }
    let mut head = Vec::new();
    let file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    file.take(PIECE as u64).read_to_end(&mut head).map_err(io)?;
    let known = head.len().min(mcap::MAGIC.len());
    if head[..known] != mcap::MAGIC[..known] {
        return Err(content("it is no MCAP".into()));
    }
    let mut records = Records::new();
    let (mut head, mut record) = (&head[..], Vec::new());
    // A record that is torn, or longer than what was looked at, is none yet.
    while records
        .next(&mut head, length.saturating_sub(records.read), &mut record)
        .map_err(content)?
    {
        match records.feed(&record, |_| true) {
            State::Broken(why) => return Err(content(why)),
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
    /// The record being read.
    record: Vec<u8>,
}

/// The file being read.
struct Following {
    path: PathBuf,
    file: BufReader<File>,
    records: Records,
    identity: Option<(u64, u64)>,
    head: Vec<u8>,
    /// Messages of bytes before this one were there already, and are left out.
    new_from: u64,
    still_looks: u32,
    /// Looks at a record that couldn't be read.
    tries: u32,
    /// Nothing more of it can be read.
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
                        shared.set_shut(None);
                        let door = shared.name().to_owned();
                        self.tell(&Trouble::Open { door });
                        following = Some(begun);
                    }
                    Err(why) => {
                        // What appears later is new as a whole.
                        is_first = false;
                        shared.set_shut(Some(why));
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
                shared.set_shut(None);
                following = Some(next);
                continue;
            }
            std::thread::sleep(self.every);
        }
    }

    fn tell(&self, trouble: &Trouble) {
        self.channels.tell_all(self.clock.now(), trouble);
    }

    /// The file to begin with.
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
        let file = file.ok_or_else(|| format!("no .mcap in {}", path.display()))?;
        Following::of(file, skips)
    }

    /// Reads what has been written; whether there was anything.
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
                Err(why) => {
                    self.give_up(now, why, shared);
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
                    let missing = HEAD - now.head.len();
                    now.head
                        .extend_from_slice(&record[..record.len().min(missing)]);
                    has_read = true;
                }
                State::Ended => now.is_done = true,
                // Written in two steps, it may be whole at the next look.
                State::Broken(_) if now.tries < TRIES => {
                    now.tries += 1;
                    break;
                }
                State::Broken(why) => self.give_up(now, why, shared),
            }
            now.tries = 0;
        }
        // Room is given back after an unusual record.
        record.clear();
        record.shrink_to(KEPT);
        self.record = record;
        if has_read {
            now.still_looks = 0;
        }
        has_read
    }

    fn give_up(&self, now: &mut Following, why: String, shared: &Shared) {
        now.is_done = true;
        let file = now.path.display().to_string();
        let offset = now.records.read;
        // Nothing more comes of it, until there is another.
        shared.set_shut(Some(format!(
            "{file} is damaged from byte {offset} on: {why}; the next recording is waited for"
        )));
        self.tell(&Trouble::Damaged { file, offset, why });
    }

    /// `false`: the door shall be shut.
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

    /// What to go on with where nothing more came: the same file anew, or the folder's next.
    fn next(&self, now: &mut Following) -> Option<Following> {
        now.still_looks = now.still_looks.saturating_add(1);
        if now.was_replaced() {
            let next = Following::of(&now.path, false).ok()?;
            let file = now.path.display().to_string();
            self.tell(&Trouble::Replaced { file });
            return Some(next);
        }
        let folder = &self.options.path;
        if !folder.is_dir() || !(now.is_done || now.still_looks >= STILL_LOOKS) {
            return None;
        }
        let later = mcaps(folder).ok()?;
        let here = natural_key(&now.path.to_string_lossy());
        let next = later
            .into_iter()
            .find(|path| natural_key(&path.to_string_lossy()) > here)?;
        let begun = Following::of(&next, false).ok()?;
        let file = next.display().to_string();
        self.tell(&Trouble::NextFile { file });
        Some(begun)
    }
}

impl Following {
    /// `skips`: what is there already is left out.
    fn of(path: &Path, skips: bool) -> Result<Self, String> {
        let refuse = |error: std::io::Error| format!("{}: {error}", path.display());
        let file = File::open(path).map_err(refuse)?;
        let metadata = file.metadata().map_err(refuse)?;
        if !metadata.is_file() {
            return Err(format!("{}: not a file", path.display()));
        }
        Ok(Following {
            path: path.to_owned(),
            file: BufReader::with_capacity(PIECE, file),
            records: Records::new(),
            identity: identity(&metadata),
            head: Vec::new(),
            new_from: if skips { metadata.len() } else { 0 },
            still_looks: 0,
            tries: 0,
            is_done: false,
        })
    }

    /// Goes to what follows the records read; how many bytes there are. What wasn't a whole record is read again: it
    /// may have been changed.
    fn available(&mut self) -> Result<u64, String> {
        let at = self.records.read;
        let available = |file: &mut BufReader<File>| {
            file.seek(SeekFrom::Start(at))?;
            Ok(file.get_ref().metadata()?.len().saturating_sub(at))
        };
        available(&mut self.file).map_err(|error: std::io::Error| error.to_string())
    }

    /// Whether another file has its name now, or it was written anew.
    fn was_replaced(&mut self) -> bool {
        let Ok(mut file) = File::open(&self.path) else {
            // Taken away: it may come back.
            return false;
        };
        let Ok(metadata) = file.metadata() else {
            return false;
        };
        if identity(&metadata) != self.identity || metadata.len() < self.records.read {
            return true;
        }
        let mut head = vec![0; self.head.len()];
        let begins_alike = file
            .seek(SeekFrom::Start(0))
            .and(file.read_exact(&mut head));
        begins_alike.is_ok() && head != self.head
    }
}

/// What tells a file from another of its name, where the system says.
fn identity(metadata: &Metadata) -> Option<(u64, u64)> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        Some((metadata.dev(), metadata.ino()))
    }
    #[cfg(not(unix))]
    {
        let _nothing_is_told = metadata;
        None
    }
}

/// The recordings of a folder, in the order of their names and numbers.
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
