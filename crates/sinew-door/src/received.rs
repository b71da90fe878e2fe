//! When a message was received, by two clocks.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// When something was received, by the two clocks of the monitor's computer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Received {
    /// A clock that never steps, ns: UTC when the program started, and the time since then.
    pub monotonic_ns: i64,
    /// The civil clock, ns since 1970 UTC. It may step.
    pub utc_ns: i64,
}

/// Both clocks. Doors of one program share one, so that their instants can be compared.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    started: Instant,
    started_utc_ns: i64,
}

impl Clock {
    /// Starts the clock that never steps at UTC.
    pub fn start() -> Self {
        Clock {
            started: Instant::now(),
            started_utc_ns: utc_ns(),
        }
    }

    /// Returns the present instant.
    pub fn now(&self) -> Received {
        let since = i64::try_from(self.started.elapsed().as_nanos()).unwrap_or(i64::MAX);
        Received {
            monotonic_ns: self.started_utc_ns.saturating_add(since),
            utc_ns: utc_ns(),
        }
    }
}

/// The civil clock, ns since 1970; it saturates in 2262.
fn utc_ns() -> i64 {
    let ns = |duration: std::time::Duration| i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX);
    match SystemTime::now().duration_since(UNIX_EPOCH) {
        Ok(since) => ns(since),
        Err(before) => -ns(before.duration()),
    }
}
