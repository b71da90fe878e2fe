//! Replay of a recording through the same queues, without a network, for the demonstration and for tests.

use crate::error::TransportFault;
use crate::handle::{Shared, Transport, TransportError};
use crate::received::Clock;
use crate::records::{Recorded, Records, State};
use crate::route::{Channels, Routes};
use sinew_log::decode::{MessageKind, set_stamp_ns, stamp_ns};
use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Length of one read, bytes.
const READ_BYTES: usize = 64 << 10;
/// Maximum waiting time before the transport checks whether it shall stop.
const MAX_SLEEP: Duration = Duration::from_millis(20);

/// Location of the MCAP recording.
#[derive(Debug, Clone)]
pub enum Played {
    /// File with its path.
    File(PathBuf),
    /// Bytes in memory, such as those embedded in a program.
    Bytes(Arc<[u8]>),
}

/// Options of a replay.
#[derive(Debug, Clone)]
pub struct ReplayOptions {
    /// Recording to replay.
    pub recording: Played,
    /// Source name of stored records, such as `mcap:run.mcap`.
    pub name: String,
    /// Seconds of the recording per second; infinite: as fast as it is consumed.
    pub speed: f64,
    /// Whether the replay restarts at the end.
    pub is_looped: bool,
    /// Whether time stamps are shifted to the present time and continue from one repetition to the next; otherwise
    /// they stay as recorded.
    pub is_restamped: bool,
    /// Pause between two repetitions of a restamped recording, s: longer than a gap, so that filters are
    /// re-initialised.
    pub pause_s: f64,
}

impl ReplayOptions {
    /// Replays an MCAP once at its original speed, with time stamps as recorded.
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

/// Modifies messages during the replay, for example to simulate changes of the demonstration robot.
pub trait Alter: Send {
    /// Modifies a message before it is received; `since_start_s` is the recording time since the first replay began,
    /// s.
    fn alter(&mut self, topic: &str, schema: &str, since_start_s: f64, cdr: &mut [u8]);
}

/// Opens the replay; it ends with the recording, or when the transport is dropped.
///
/// # Errors
/// Returns [`TransportError::Option`] if speed or pause is invalid, and [`TransportError::Io`] if the file cannot be
/// read.
pub fn open(
    options: &ReplayOptions,
    routes: &Routes,
    clock: Clock,
    alter: Option<Box<dyn Alter>>,
) -> Result<Transport, TransportError> {
    let invalid = |what, value: f64, reason: &str| TransportError::Option {
        what,
        value: value.to_string(),
        reason: reason.to_owned(),
    };
    if !(options.speed > 0.0) {
        return Err(invalid("speed", options.speed, "expected more than 0"));
    }
    if !(options.pause_s >= 0.0 && options.pause_s.is_finite()) {
        return Err(invalid("pause_s", options.pause_s, "expected 0 s or more"));
    }
    let io = |source| TransportError::Io {
        transport: options.name.clone(),
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
    Transport::run(Shared::new(options.name.clone()), move |shared| {
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
    /// Recorder clock at the first message of a repetition; the newest follows.
    first_ns: Option<i64>,
    newest_ns: i64,
    /// Duration of the previous repetitions, ns.
    turn_ns: i64,
    start_utc_ns: i64,
}

impl Player {
    fn play(mut self, shared: &Shared) {
        loop {
            if let Err(reason) = self.turn(shared) {
                shared.set_disconnected(Some(reason.clone()));
                let transport = shared.name().to_owned();
                let fault = TransportFault::Disconnected { transport, reason };
                self.channels.report_all(self.clock.now(), &fault);
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

    /// Replays the recording once, from the first message to the last.
    fn turn(&mut self, shared: &Shared) -> Result<(), String> {
        let source = source(&self.options.recording).map_err(|e| e.to_string())?;
        let mut source = BufReader::with_capacity(READ_BYTES, source);
        let mut records = Records::new();
        let mut record = Vec::new();
        let mut messages = 0_u64;
        while records.next(&mut source, u64::MAX, &mut record)? {
            let mut is_stopped = false;
            let state = records.feed(&record, |recorded| {
                messages += 1;
                let continues = self.message(&recorded, shared);
                is_stopped |= !continues;
                continues
            });
            match state {
                State::Broken(reason) => {
                    return Err(format!("damaged at byte {}: {reason}", records.read));
                }
                State::Wants if !is_stopped => {}
                State::Wants | State::Ended => break,
            }
        }
        match messages {
            0 => Err("no message found".to_owned()),
            _ => Ok(()),
        }
    }

    /// Replays a message at its time; returns `false` if the transport shall be closed.
    fn message(&mut self, recorded: &Recorded<'_>, shared: &Shared) -> bool {
        let targets = self.channels.of(recorded);
        let first_ns = *self.first_ns.get_or_insert(recorded.logged_ns);
        self.newest_ns = self.newest_ns.max(recorded.logged_ns);
        if targets.is_empty() {
            return !shared.stops();
        }
        // Time of the recording since the first repetition began.
        let within_ns = recorded.logged_ns.saturating_sub(first_ns).max(0);
        let since_ns = self.turn_ns.saturating_add(within_ns);
        let due = Duration::try_from_secs_f64(since_ns as f64 * 1e-9 / self.options.speed);
        let due = due.unwrap_or(Duration::MAX);
        while self.options.speed.is_finite() && !shared.stops() {
            let left = due.saturating_sub(self.begun.elapsed());
            if left.is_zero() {
                break;
            }
            std::thread::sleep(left.min(MAX_SLEEP));
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
                // The delay from stamp to logging is preserved.
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
