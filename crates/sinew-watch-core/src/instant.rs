//! When something reached the monitor, by two clocks.

use serde::{Deserialize, Serialize};

/// When something reached the monitor, by the two clocks of its computer.
///
/// A robot's stamps are a third clock: they give time steps, and nothing else.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Instant {
    /// A clock that never steps, ns from an unknown zero: staleness and delays.
    pub monotonic_ns: i64,
    /// The civil clock, ns since 1970 UTC: dates of records. It may step.
    pub utc_ns: i64,
}

impl Instant {
    /// Both clocks, `s` seconds later.
    #[must_use]
    pub fn after_s(self, s: f64) -> Self {
        let ns = (s * 1e9) as i64;
        Self {
            monotonic_ns: self.monotonic_ns.saturating_add(ns),
            utc_ns: self.utc_ns.saturating_add(ns),
        }
    }

    /// Time since `earlier` by the clock that never steps, s; 0 where that is later.
    pub fn since_s(self, earlier: Self) -> f64 {
        self.monotonic_ns
            .saturating_sub(earlier.monotonic_ns)
            .max(0) as f64
            * 1e-9
    }

    /// The civil time, s since 1970.
    pub fn utc_s(self) -> f64 {
        self.utc_ns as f64 * 1e-9
    }
}
