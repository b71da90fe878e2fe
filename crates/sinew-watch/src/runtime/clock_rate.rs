//! Speed of the civil clock of the monitors: one hour per second in the demonstration.

use sinew_transport::Received;
use sinew_watch_core::Instant;

/// Speed of the civil clock of the monitors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClockRate {
    /// Same speed as real time.
    Real,
    /// Accelerated from a start time on.
    Accelerated {
        /// Start of the acceleration.
        from: Received,
        /// Civil seconds per real second.
        rate: f64,
    },
}

impl ClockRate {
    /// Converts a time of reception to an instant of the monitor.
    pub fn instant(self, received: Received) -> Instant {
        let utc_ns = match self {
            Self::Real => received.utc_ns,
            Self::Accelerated { from, rate } => {
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
