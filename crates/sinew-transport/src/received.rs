//! Time of reception by two clocks.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Time of reception by the two clocks of the monitor host.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Received {
    /// Clock that never steps, ns: UTC at program start plus the time since then.
    pub monotonic_ns: i64,
    /// Civil clock, ns since 1970 UTC. It may step.
    pub utc_ns: i64,
}

/// Pair of clocks. The transports of a program share one, so that their time stamps are comparable.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    started: Instant,
    started_utc_ns: i64,
}

impl Clock {
    /// Starts the monotonic clock at the present UTC.
    pub fn start() -> Self {
        Clock {
            started: Instant::now(),
            started_utc_ns: utc_ns(),
        }
    }

    /// Returns the present time.
    pub fn now(&self) -> Received {
        let since = i64::try_from(self.started.elapsed().as_nanos()).unwrap_or(i64::MAX);
        Received {
            monotonic_ns: self.started_utc_ns.saturating_add(since),
            utc_ns: utc_ns(),
        }
    }
}

/// Returns the civil clock, ns since 1970; saturates in 2262.
fn utc_ns() -> i64 {
    let ns = |duration: std::time::Duration| i64::try_from(duration.as_nanos()).unwrap_or(i64::MAX);
    match SystemTime::now().duration_since(UNIX_EPOCH) {
        Ok(since) => ns(since),
        Err(before) => -ns(before.duration()),
    }
}
