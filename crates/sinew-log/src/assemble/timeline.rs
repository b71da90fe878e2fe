//! Time of the frames: the time stamps, continued over steps of their clock.
//!
//! A clock that is set while it is in use (time synchronisation, a simulation that is restarted) does not change how much
//! time has passed. The frame after the step follows the one before it by the difference of the recorder's clock if
//! that clock has run like the time stamps so far, else by the last period.

use super::key::Key;

/// Ratios of the recorder's clock to the time stamps between which the recorder's clock measures durations.
const CLOCK_RATIOS: std::ops::RangeInclusive<f64> = 0.5..=2.0;
/// Period after a step if there is none before it, ns.
const PERIOD_NS: i64 = 1_000_000;

/// Step from one frame to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// Time that passed, ns.
    Passed(i64),
    /// Step of the clock by `by_ns`, negative if it stepped back, while `passed_ns` passed.
    Clock { by_ns: i64, passed_ns: i64 },
}

/// Sample of both clocks.
#[derive(Debug, Clone, Copy)]
struct Reading {
    key: Key,
    received_ns: Option<i64>,
}

/// Continues time stamps over steps of their clock.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timeline {
    gap_ns: i64,
    /// First frame since the last step of the clock, and the last frame.
    since: Option<(Reading, Reading)>,
    period_ns: i64,
    /// Time of a frame minus its time stamp, ns.
    shift_ns: i64,
}

impl Timeline {
    /// Time stamps of which a longer step than `gap_ns` is a pause, or a step of the clock.
    pub(crate) fn new(gap_ns: i64) -> Self {
        Self {
            gap_ns,
            since: None,
            period_ns: PERIOD_NS,
            shift_ns: 0,
        }
    }

    /// Time of the last frame, ns, continued over the steps of the clock before it.
    pub(crate) fn time_ns(&self) -> i64 {
        let stamp_ns = self.since.map_or(0, |(_, last)| last.key.time_ns);
        stamp_ns.saturating_add(self.shift_ns)
    }

    /// Takes the next frame; `None`: it is the first.
    pub(crate) fn frame(&mut self, key: Key, received_ns: Option<i64>) -> Option<Step> {
        let now = Reading { key, received_ns };
        let Some((first, last)) = self.since else {
            self.since = Some((now, now));
            return None;
        };
        let stamps_ns = key.time_ns.saturating_sub(last.key.time_ns);
        let recorder_ns = self.recorder_ns(&first, &last, received_ns);
        let is_back = key.epoch != last.key.epoch;
        let is_ahead = |recorder_ns: i64| {
            stamps_ns > self.gap_ns && stamps_ns.saturating_sub(recorder_ns) > self.gap_ns
        };
        if !is_back && !recorder_ns.is_some_and(is_ahead) {
            if stamps_ns <= self.gap_ns {
                self.period_ns = stamps_ns.max(1);
            }
            self.since = Some((first, now));
            return Some(Step::Passed(stamps_ns));
        }
        let passed_ns = recorder_ns.filter(|ns| *ns > 0).unwrap_or(self.period_ns);
        let by_ns = stamps_ns.saturating_sub(passed_ns);
        self.shift_ns = self.shift_ns.saturating_sub(by_ns);
        self.since = Some((now, now));
        Some(Step::Clock { by_ns, passed_ns })
    }

    /// Time that passed since the last frame by the recorder's clock, ns; `None` if that clock is not recorded, or
    /// has not run like the time stamps since the last step.
    fn recorder_ns(
        &self,
        first: &Reading,
        last: &Reading,
        received_ns: Option<i64>,
    ) -> Option<i64> {
        let (first_ns, last_ns) = (first.received_ns?, last.received_ns?);
        let stamps_ns = last.key.time_ns.saturating_sub(first.key.time_ns);
        let recorder_ns = last_ns.saturating_sub(first_ns);
        let ratio = recorder_ns as f64 / stamps_ns as f64;
        CLOCK_RATIOS
            .contains(&ratio)
            .then(|| received_ns.map(|now_ns| now_ns.saturating_sub(last_ns)))
            .flatten()
    }
}
