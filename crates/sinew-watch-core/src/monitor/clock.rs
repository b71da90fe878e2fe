//! Checks of the clocks of monitor and robot.

use super::config::ClockChoice;
use crate::instant::Instant;
use crate::record::Clock;
use sinew_files::date::PLAUSIBLE_S;

/// Minimum deviation of the civil clock from the monotonic clock that counts as a step, s.
const MIN_CLOCK_STEP_S: f64 = 5.0;
/// Period over which the rate of the time stamps is measured, s; a network delay of 1 s is 5 % of it.
const RATE_PERIOD_S: f64 = 20.0;
/// Maximum rate error of the robot's clock; beyond it, time stamps are not real time.
const MAX_RATE_ERROR: f64 = 0.1;

/// Plausible civil time, 2024-01-01 to 2200-01-01, s since 1970 UTC; a clock outside this range was never set.
const PLAUSIBLE_CIVIL_S: std::ops::Range<f64> = 1_704_067_200.0..PLAUSIBLE_S.end;

/// Event of a clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ClockEvent {
    /// Step of the civil clock, s.
    Step(f64),
    /// Rate of the time stamps relative to real time, s/s.
    NotTime(f64),
}

/// Monitor of the three clocks.
#[derive(Debug, Clone, Default)]
pub(super) struct Clocks {
    choice: ClockChoice,
    /// Civil time at zero of the monotonic clock, and the monotonic time of the last comparison, ns.
    zero_ns: Option<(i64, i64)>,
    /// Time stamp, ns, and arrival at the start of the present rate measurement.
    rate_start: Option<(i64, Instant)>,
    /// Last time stamp, ns.
    last_stamp_ns: Option<i64>,
    /// Step of the time stamps that is a gap, ns.
    gap_ns: i64,
    stamps_are_not_time: bool,
    /// Whether the civil clock stepped since the start of the session.
    stepped: bool,
}

impl Clocks {
    pub(super) fn new(choice: ClockChoice, gap_s: f64) -> Self {
        Self {
            choice,
            gap_ns: (gap_s * 1e9) as i64,
            ..Self::default()
        }
    }

    pub(super) fn set_choice(&mut self, choice: ClockChoice) {
        self.choice = choice;
    }

    /// Compares the two clocks of the host.
    pub(super) fn now(&mut self, now: Instant) -> Option<ClockEvent> {
        let zero_ns = now.utc_ns.saturating_sub(now.monotonic_ns);
        // A slewed clock is tracked.
        let (before, last_ns) = self.zero_ns.replace((zero_ns, now.monotonic_ns))?;
        let mut by_s = zero_ns.saturating_sub(before) as f64 * 1e-9;
        if let ClockChoice::Fast { civil_rate } = self.choice {
            let passed_s = now.monotonic_ns.saturating_sub(last_ns) as f64 * 1e-9;
            by_s -= (civil_rate - 1.0) * passed_s;
        }
        (by_s.abs() > MIN_CLOCK_STEP_S).then(|| {
            self.stepped = true;
            ClockEvent::Step(by_s)
        })
    }

    /// Compares the time stamp of a frame with its arrival. A gap of the time stamps restarts the measurement: after a
    /// pause of the publisher, frames from before it may still arrive.
    pub(super) fn stamp(&mut self, stamp_ns: i64, now: Instant) -> Option<ClockEvent> {
        let last_ns = self.last_stamp_ns.replace(stamp_ns);
        if last_ns.is_some_and(|last_ns| stamp_ns.abs_diff(last_ns) > self.gap_ns.unsigned_abs()) {
            self.rate_start = None;
        }
        let (first_ns, first) = *self.rate_start.get_or_insert((stamp_ns, now));
        let waited_s = now.since_s(first);
        if waited_s < RATE_PERIOD_S {
            return None;
        }
        self.rate_start = Some((stamp_ns, now));
        let rate = stamp_ns.saturating_sub(first_ns) as f64 * 1e-9 / waited_s;
        let was = self.stamps_are_not_time;
        self.stamps_are_not_time = (rate - 1.0).abs() > MAX_RATE_ERROR;
        (self.stamps_are_not_time && !was).then_some(ClockEvent::NotTime(rate))
    }

    /// Whether a session with `motion_s` seconds of motion arrived within `passed_s`: a replayed recording too short
    /// for a rate measurement. Its date is not the present. Pauses and jumps of time stamps do not count as motion.
    pub(super) fn is_caught_up(motion_s: f64, passed_s: f64) -> bool {
        motion_s - passed_s > MAX_RATE_ERROR * RATE_PERIOD_S
            && motion_s > (1.0 + MAX_RATE_ERROR) * passed_s
    }

    /// Restarts the rate measurement after a gap or a restart of the robot.
    pub(super) fn restart(&mut self) {
        (self.rate_start, self.last_stamp_ns) = (None, None);
    }

    /// Notes the start of a session.
    pub(super) fn begin(&mut self) {
        self.stepped = false;
    }

    /// Returns the clock of the session's date.
    pub(super) fn clock(&self, now: Instant) -> Clock {
        if self.choice == ClockChoice::Stamp || self.stamps_are_not_time {
            Clock::Stamp
        } else if self.stepped || !PLAUSIBLE_CIVIL_S.contains(&now.utc_s()) {
            Clock::Stepped
        } else {
            Clock::Utc
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: f64) -> Instant {
        let ns = (1e9 * s) as i64;
        Instant {
            monotonic_ns: ns,
            utc_ns: 1_800_000_000_000_000_000 + ns,
        }
    }

    /// The publisher is stopped for 178 s; the first frame after it was queued before.
    #[test]
    fn rate_is_not_measured_across_gap() {
        let mut clocks = Clocks::new(ClockChoice::Real, 0.5);
        let stamp = |s: f64| (1e9 * s) as i64;
        clocks.restart();
        assert_eq!(clocks.stamp(stamp(100.0), at(278.0)), None);
        for k in 0..5000 {
            let s = 278.0 + 0.01 * f64::from(k);
            assert_eq!(clocks.stamp(stamp(s), at(s)), None, "{s}");
        }
        assert_eq!(clocks.clock(at(330.0)), Clock::Utc);
        // A simulation at three times real time is still found.
        let found = (0..5000).any(|k| {
            let s = 330.0 + 0.01 * f64::from(k);
            clocks
                .stamp(stamp(330.0 + 3.0 * (s - 330.0)), at(s))
                .is_some()
        });
        assert!(found);
    }

    #[test]
    fn clock_fast_civil_rate_reports_only_true_steps() {
        let mut clocks = Clocks::new(ClockChoice::Fast { civil_rate: 3600.0 }, 0.5);
        let start = Instant {
            monotonic_ns: 0,
            utc_ns: 1_800_000_000_000_000_000,
        };
        let at = |s: f64, step_s: f64| Instant {
            monotonic_ns: (1e9 * s) as i64,
            utc_ns: start.utc_ns + (1e9 * (3600.0 * s + step_s)) as i64,
        };
        let steps = (0..200).filter_map(|i| clocks.now(at(f64::from(i), 0.0)));
        assert_eq!(steps.count(), 0);
        assert_eq!(clocks.clock(at(200.0, 0.0)), Clock::Utc);
        let step = clocks.now(at(200.0, 3600.0));
        assert!(matches!(step, Some(ClockEvent::Step(by_s)) if (by_s - 3600.0).abs() < 1e-3));
    }
}
