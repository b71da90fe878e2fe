//! How fast the civil clock of monitors runs: an hour a second in the demonstration.

use sinew_door::Received;
use sinew_watch_core::Instant;

/// How fast the civil clock of monitors runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// As time does.
    Real,
    /// So many seconds in one, from an instant on.
    Fast {
        /// From then on.
        from: Received,
        /// Seconds in a second.
        rate: f64,
    },
}

impl Pace {
    /// When something was received, for a monitor.
    pub fn instant(self, received: Received) -> Instant {
        let utc_ns = match self {
            Self::Real => received.utc_ns,
            Self::Fast { from, rate } => {
                let since_ns = received.monotonic_ns.saturating_sub(from.monotonic_ns);
                from.utc_ns.saturating_add((rate * since_ns as f64) as i64)
            }
        };
        Instant {
            monotonic_ns: received.monotonic_ns,
            utc_ns,
        }
    }
}
