//! Frames in: their clocks, their health, and what is recorded of them.

use super::clock::{ClockEvent, Clocks};
use super::health::Health;
use super::setup::Setup;
use crate::instant::Instant;
use crate::snapshot::Freshness;
use sinew_estimate::feeder::{Fed, Refusal};
use sinew_estimate::session::Recorder;
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;

/// Frames refused for their stamps one after the other: a clock that jumped back for good.
const BACKWARDS: u32 = 8;

/// Takes frames and makes blocks of them. Allocates at construction only.
#[derive(Debug)]
pub(super) struct Ingest {
    pub(super) clocks: Clocks,
    pub(super) health: Health,
    pub(super) recorder: Recorder,
    /// Frames received, and how many of them were lost, refused or incomplete.
    pub(super) frames: u64,
    pub(super) frames_lost: u64,
    started: Instant,
    /// When the last frame came.
    pub(super) last: Option<Instant>,
    silent: bool,
    /// Stamp of the recording's zero, ns.
    zero_ns: Option<i64>,
    /// When the first frame of what is recorded now came.
    pub(super) recorded_from: Option<Instant>,
    /// Frames refused for their stamps, one after the other.
    backwards: u32,
    pub(super) temperature_c: Option<f64>,
}

/// What came of a frame.
pub(super) struct Arrived {
    /// Stamps were found to run at this rate instead of with time, s in a second.
    pub(super) not_time: Option<f64>,
    pub(super) lost: bool,
    /// Whether it completed a block.
    pub(super) block: bool,
}

impl Ingest {
    pub(super) fn new(setup: &Setup, now: Instant) -> Self {
        let gap_s = setup.config.times.gap_s;
        Self {
            clocks: Clocks::new(setup.config.clock),
            health: Health::new(setup.elastic.clone(), &setup.robot.transmissions),
            recorder: Recorder::new(&setup.robot, &FeatureConfig::default(), gap_s),
            frames: 0,
            frames_lost: 0,
            started: now,
            last: None,
            silent: false,
            zero_ns: None,
            recorded_from: None,
            backwards: 0,
            temperature_c: None,
        }
    }

    /// Notes that data came. Returns for how long none did, s (`None` within: none ever did), where they come again.
    pub(super) fn data_came(&mut self, now: Instant) -> Option<Option<f64>> {
        let last = self.last.replace(now);
        if last.is_some() && !self.silent {
            return None;
        }
        self.silent = false;
        self.restart_stamps();
        Some(last.map(|last| now.since_s(last)))
    }

    /// Takes a frame, after [`Ingest::data_came`].
    pub(super) fn frame(&mut self, frame: &Frame, now: Instant) -> Arrived {
        let not_time = match self.clocks.stamp(frame.time_ns, now) {
            Some(ClockEvent::NotTime(rate)) => Some(rate),
            _ => None,
        };
        let time_s = self.recording_time_s(frame, now);
        let fed = self.recorder.push(frame, time_s);
        self.health.frame(frame, fed, now);
        let lost = matches!(fed, Fed::Refused(_));
        self.frames += 1;
        self.frames_lost += u64::from(lost);
        if frame.temperature_c.is_finite() {
            self.temperature_c = Some(frame.temperature_c);
        }
        match fed {
            Fed::Refused(Refusal::TimeStep) => {
                self.backwards += 1;
                if self.backwards >= BACKWARDS {
                    self.restart_stamps();
                }
            }
            _ => self.backwards = 0,
        }
        Arrived {
            not_time,
            lost,
            block: fed.output() == Some(true),
        }
    }

    /// Counts messages that a full queue dropped before they became frames.
    pub(super) fn dropped(&mut self, messages: u64) {
        self.frames_lost = self.frames_lost.saturating_add(messages);
        self.health.dropped(messages);
    }

    /// Restarts the filters and what stamps say of time.
    fn restart_stamps(&mut self) {
        self.recorder.restart();
        self.clocks.restart();
        self.zero_ns = None;
        self.backwards = 0;
    }

    /// Time of the recording under way, s: stamps give steps, and nothing else. Where they began anew, the clock
    /// that never steps says how long that took.
    fn recording_time_s(&mut self, frame: &Frame, now: Instant) -> f64 {
        let from = *self.recorded_from.get_or_insert(now);
        let zero = *self.zero_ns.get_or_insert_with(|| {
            let passed_ns = now.monotonic_ns.saturating_sub(from.monotonic_ns);
            frame.time_ns.saturating_sub(passed_ns)
        });
        frame.time_ns.saturating_sub(zero) as f64 * 1e-9
    }

    /// Drops what is recorded: the recording begins anew.
    pub(super) fn forget_recorded(&mut self) {
        self.recorder.clear();
        (self.recorded_from, self.zero_ns) = (None, None);
    }

    /// For how long no data came, s.
    pub(super) fn silent_s(&self, now: Instant) -> f64 {
        now.since_s(self.last.unwrap_or(self.started))
    }

    /// Notes that no data come any more; whether that is new.
    pub(super) fn fall_silent(&mut self) -> bool {
        let new = !std::mem::replace(&mut self.silent, true);
        if new {
            self.health.silent();
        }
        new
    }

    /// Whether data come, where those older than `stale_after_s` are of the past.
    pub(super) fn freshness(&self, stale_after_s: f64, now: Instant) -> Freshness {
        match self.last.map(|last| now.since_s(last)) {
            None => Freshness::Never,
            Some(for_s) if for_s < stale_after_s => Freshness::Fresh,
            Some(for_s) => Freshness::Stale { for_s },
        }
    }
}
