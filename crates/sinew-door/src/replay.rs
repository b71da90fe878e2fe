//! A recording played: the same queue, the same way, without a network. For the demonstration and for tests.

use crate::handle::{Door, DoorError, Shared};
use crate::received::Clock;
use crate::records::{Recorded, Records, State};
use crate::route::{Channels, Routes};
use crate::trouble::Trouble;
use sinew_log::decode::{MessageKind, set_stamp_ns, stamp_ns};
use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// One read, bytes.
const PIECE: usize = 64 << 10;
/// How long a wait lasts at most before the door looks whether it shall stop.
const LOOK: Duration = Duration::from_millis(20);

/// Where the recording is: an MCAP.
#[derive(Debug, Clone)]
pub enum Played {
    /// A file, by its path.
    File(PathBuf),
    /// Bytes, such as those a program carries.
    Bytes(Arc<[u8]>),
}

/// How a recording is played.
#[derive(Debug, Clone)]
pub struct ReplayOptions {
    /// The recording that is played.
    pub recording: Played,
    /// What records say that they came from, such as `mcap:run.mcap`.
    pub name: String,
    /// Seconds of the recording in a second; infinite: as fast as it is taken.
    pub speed: f64,
    /// Whether it begins anew at its end.
    pub is_looped: bool,
    /// Whether its stamps are moved to now, and go on from one turn to the next. Else they are as recorded.
    pub is_restamped: bool,
    /// Pause between two turns of a restamped recording, s: longer than a gap, so that filters begin anew.
    pub pause_s: f64,
}

impl ReplayOptions {
    /// An MCAP at its own pace, once, as it was recorded.
    pub fn of(path: PathBuf) -> Self {
        ReplayOptions {
            name: format!("mcap:{}", path.display()),
            recording: Played::File(path),
            speed: 1.0,
            is_looped: false,
            is_restamped: false,
            pause_s: 1.0,
        }
    }
}

/// Changes messages as they are played: what a demonstration does to its robot.
pub trait Alter: Send {
    /// A message about to be received; `since_start_s` is the recording's time since it was first played.
    fn alter(&mut self, topic: &str, schema: &str, since_start_s: f64, cdr: &mut [u8]);
}

/// Opens it; it plays until its end, or until the door is dropped.
///
/// # Errors
/// A speed or pause that can't be, a file that can't be opened or has no message.
pub fn open(
    options: &ReplayOptions,
    routes: &Routes,
    clock: Clock,
    alter: Option<Box<dyn Alter>>,
) -> Result<Door, DoorError> {
    let refuse = |what, value: f64, why: &str| DoorError::Option {
        what,
        value: value.to_string(),
        why: why.to_owned(),
    };
    if !(options.speed > 0.0) {
        return Err(refuse("speed", options.speed, "it is more than 0"));
    }
    if !(options.pause_s >= 0.0 && options.pause_s.is_finite()) {
        return Err(refuse("pause_s", options.pause_s, "it is 0 s or more"));
    }
    let io = |source| DoorError::Io {
        door: options.name.clone(),
        source,
    };
    source(&options.recording).map_err(io)?;
    let player = Player {
        options: options.clone(),
        channels: Channels::new(routes),
        clock,
        alter,
        scratch: Vec::new(),
        begun: Instant::now(),
        first_ns: None,
        newest_ns: 0,
        turn_ns: 0,
        start_utc_ns: clock.now().utc_ns,
    };
    Door::run(Shared::new(options.name.clone()), move |shared| {
        player.play(shared);
    })
}

fn source(recording: &Played) -> std::io::Result<Box<dyn Read + Send>> {
    Ok(match recording {
        Played::File(path) => Box::new(File::open(path)?),
        Played::Bytes(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
    })
}

struct Player {
    options: ReplayOptions,
    channels: Channels,
    clock: Clock,
    alter: Option<Box<dyn Alter>>,
    scratch: Vec<u8>,
    begun: Instant,
    /// The recorder's clock at the first message of a turn, and at the newest.
    first_ns: Option<i64>,
    newest_ns: i64,
    /// Time of the turns played before this one.
    turn_ns: i64,
    start_utc_ns: i64,
}

impl Player {
    fn play(mut self, shared: &Shared) {
        loop {
            if let Err(why) = self.turn(shared) {
                shared.set_shut(Some(why.clone()));
                let door = shared.name().to_owned();
                let trouble = Trouble::Shut { door, why };
                self.channels.tell_all(self.clock.now(), &trouble);
                break;
            }
            if !self.options.is_looped || shared.stops() {
                break;
            }
            let length = self.newest_ns - self.first_ns.take().unwrap_or(self.newest_ns);
            let pause = (self.options.pause_s * 1e9) as i64;
            self.turn_ns = self.turn_ns.saturating_add(length).saturating_add(pause);
        }
        shared.end();
    }

    /// From the first message to the last.
    fn turn(&mut self, shared: &Shared) -> Result<(), String> {
        let source = source(&self.options.recording).map_err(|e| e.to_string())?;
        let mut source = BufReader::with_capacity(PIECE, source);
        let mut records = Records::new();
        let mut record = Vec::new();
        let mut messages = 0_u64;
        while records.next(&mut source, u64::MAX, &mut record)? {
            let mut is_stopped = false;
            let state = records.feed(&record, |recorded| {
                messages += 1;
                let goes_on = self.message(&recorded, shared);
                is_stopped |= !goes_on;
                goes_on
            });
            match state {
                State::Broken(why) => {
                    return Err(format!("damaged from byte {} on: {why}", records.read));
                }
                State::Wants if !is_stopped => {}
                State::Wants | State::Ended => break,
            }
        }
        match messages {
            0 => Err("no message".to_owned()),
            _ => Ok(()),
        }
    }

    /// Plays a message when it is due; `false`: the door shall be shut.
    fn message(&mut self, recorded: &Recorded<'_>, shared: &Shared) -> bool {
        let targets = self.channels.of(recorded);
        let first_ns = *self.first_ns.get_or_insert(recorded.logged_ns);
        self.newest_ns = self.newest_ns.max(recorded.logged_ns);
        if targets.is_empty() {
            return !shared.stops();
        }
        // Time of the recording since the first turn began.
        let within_ns = recorded.logged_ns.saturating_sub(first_ns).max(0);
        let since_ns = self.turn_ns.saturating_add(within_ns);
        let due = Duration::try_from_secs_f64(since_ns as f64 * 1e-9 / self.options.speed);
        let due = due.unwrap_or(Duration::MAX);
        while self.options.speed.is_finite() && !shared.stops() {
            let left = due.saturating_sub(self.begun.elapsed());
            if left.is_zero() {
                break;
            }
            std::thread::sleep(left.min(LOOK));
        }
        if !targets.wait_for_room(recorded.cdr.len(), shared) {
            return false;
        }
        self.scratch.clear();
        self.scratch.extend_from_slice(recorded.cdr);
        let mut source_ns = recorded.logged_ns;
        if self.options.is_restamped {
            source_ns = self.start_utc_ns.saturating_add(since_ns);
            if MessageKind::of_schema(recorded.schema).is_some() {
                // How long before its logging it was stamped is kept.
                let age = stamp_ns(recorded.cdr).filter(|stamp| *stamp != 0);
                let age = age.map_or(0, |stamp| recorded.logged_ns.saturating_sub(stamp));
                let is_stamp = age.unsigned_abs() <= 1_000_000_000;
                let age = if is_stamp { age } else { 0 };
                set_stamp_ns(&mut self.scratch, source_ns.saturating_sub(age));
            }
        }
        if let Some(alter) = &mut self.alter {
            let since_s = since_ns as f64 * 1e-9;
            alter.alter(recorded.topic, recorded.schema, since_s, &mut self.scratch);
        }
        shared.count(1);
        targets.message(self.clock.now(), source_ns, &[&self.scratch]);
        true
    }
}
