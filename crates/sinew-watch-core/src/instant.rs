//! Time of arrival at the monitor, by two clocks.

use serde::{Deserialize, Serialize};

/// Time of arrival at the monitor, by the two clocks of its host.
///
/// The robot's time stamps are a third clock that gives only time differences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Instant {
    /// Monotonic clock, ns from an arbitrary zero; used for staleness and delays.
    pub monotonic_ns: i64,
    /// Civil clock, ns since 1970 UTC; used for the dates of records. It may step.
    pub utc_ns: i64,
}

impl Instant {
    /// Returns both clocks advanced by `s` seconds.
    #[must_use]
    pub fn after_s(self, s: f64) -> Self {
        let ns = (s * 1e9) as i64;
        Self {
            monotonic_ns: self.monotonic_ns.saturating_add(ns),
            utc_ns: self.utc_ns.saturating_add(ns),
        }
    }

    /// Returns the time since `earlier` by the monotonic clock, s; 0 if `earlier` is later.
    pub fn since_s(self, earlier: Self) -> f64 {
        self.monotonic_ns
            .saturating_sub(earlier.monotonic_ns)
            .max(0) as f64
            * 1e-9
    }

    /// Returns the civil time, s since 1970 UTC.
    pub fn utc_s(self) -> f64 {
        self.utc_ns as f64 * 1e-9
    }
}
