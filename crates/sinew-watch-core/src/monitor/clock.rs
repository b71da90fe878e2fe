//! Which clock can be believed.

use super::config::ClockChoice;
use crate::instant::Instant;
use crate::record::Clock;
use sinew_files::date::PLAUSIBLE_S;

/// The civil clock against the one that never steps: more is a step, s.
const STEP_S: f64 = 5.0;
/// Stamps are held against time over so long, s: what a network holds back for a second is a twentieth.
const RATE_OVER_S: f64 = 20.0;
/// A robot's clock may run wrong by this share; beyond, its stamps aren't time.
const RATE_WITHIN: f64 = 0.1;

/// 2024-01-01 to 2200-01-01, s since 1970: a civil clock that says otherwise was never set. No monitor is older.
const CIVIL_S: std::ops::Range<f64> = 1_704_067_200.0..PLAUSIBLE_S.end;

/// What the clocks did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ClockEvent {
    /// The civil clock stepped by so much, s.
    Step(f64),
    /// Stamps run at this rate, s in a second.
    NotTime(f64),
}

/// Watches the three clocks.
#[derive(Debug, Clone, Default)]
pub(super) struct Clocks {
    choice: ClockChoice,
    /// Civil time at zero of the clock that never steps, and that clock, ns.
    zero_ns: Option<(i64, i64)>,
    /// Stamp and time where the present count of the rate began.
    from: Option<(i64, Instant)>,
    stamps_are_not_time: bool,
    /// Since the last session began.
    stepped: bool,
}

impl Clocks {
    pub(super) fn new(choice: ClockChoice) -> Self {
        Self {
            choice,
            ..Self::default()
        }
    }

    pub(super) fn set_choice(&mut self, choice: ClockChoice) {
        self.choice = choice;
    }

    /// Compares the two clocks of the computer.
    pub(super) fn now(&mut self, now: Instant) -> Option<ClockEvent> {
        let zero_ns = now.utc_ns.saturating_sub(now.monotonic_ns);
        // A clock that is slewed is followed.
        let (before, last_ns) = self.zero_ns.replace((zero_ns, now.monotonic_ns))?;
        let mut by_s = zero_ns.saturating_sub(before) as f64 * 1e-9;
        if let ClockChoice::Fast { civil_rate } = self.choice {
            let passed_s = now.monotonic_ns.saturating_sub(last_ns) as f64 * 1e-9;
            by_s -= (civil_rate - 1.0) * passed_s;
        }
        (by_s.abs() > STEP_S).then(|| {
            self.stepped = true;
            ClockEvent::Step(by_s)
        })
    }

    /// Holds a frame's stamp against the time it came.
    pub(super) fn stamp(&mut self, stamp_ns: i64, now: Instant) -> Option<ClockEvent> {
        let (first_ns, first) = *self.from.get_or_insert((stamp_ns, now));
        let waited_s = now.since_s(first);
        if waited_s < RATE_OVER_S {
            return None;
        }
        self.from = Some((stamp_ns, now));
        let rate = stamp_ns.saturating_sub(first_ns) as f64 * 1e-9 / waited_s;
        let was = self.stamps_are_not_time;
        self.stamps_are_not_time = (rate - 1.0).abs() > RATE_WITHIN;
        (self.stamps_are_not_time && !was).then_some(ClockEvent::NotTime(rate))
    }

    /// Whether a session of so much motion came in `passed_s`: a recording that is caught up with, too short for its rate to
    /// be seen. Its date is not that of now. Pauses and stamps that jump are no motion.
    pub(super) fn is_caught_up(motion_s: f64, passed_s: f64) -> bool {
        motion_s - passed_s > RATE_WITHIN * RATE_OVER_S && motion_s > (1.0 + RATE_WITHIN) * passed_s
    }

    /// Stamps begin anew: a gap, another start of the robot.
    pub(super) fn restart(&mut self) {
        self.from = None;
    }

    /// A session begins.
    pub(super) fn begin(&mut self) {
        self.stepped = false;
    }

    /// Which clock the session's date is of.
    pub(super) fn clock(&self, now: Instant) -> Clock {
        if self.choice == ClockChoice::Stamp || self.stamps_are_not_time {
            Clock::Stamp
        } else if self.stepped || !CIVIL_S.contains(&now.utc_s()) {
            Clock::Stepped
        } else {
            Clock::Utc
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_civil_clock_that_is_meant_to_run_fast_steps_only_when_it_does() {
        let mut clocks = Clocks::new(ClockChoice::Fast { civil_rate: 3600.0 });
        let start = Instant {
            monotonic_ns: 0,
            utc_ns: 1_800_000_000_000_000_000,
        };
        let at = |s: f64, step_s: f64| Instant {
            monotonic_ns: (1e9 * s) as i64,
            utc_ns: start.utc_ns + (1e9 * (3600.0 * s + step_s)) as i64,
        };
        let told = (0..200).filter_map(|i| clocks.now(at(f64::from(i), 0.0)));
        assert_eq!(told.count(), 0);
        assert_eq!(clocks.clock(at(200.0, 0.0)), Clock::Utc);
        let step = clocks.now(at(200.0, 3600.0));
        assert!(matches!(step, Some(ClockEvent::Step(by_s)) if (by_s - 3600.0).abs() < 1e-3));
    }
}
