//! Ingestion of frames: clocks, health and recording.

use super::clock::{ClockEvent, Clocks};
use super::health::Health;
use super::setup::Setup;
use crate::instant::Instant;
use crate::snapshot::Freshness;
use sinew_estimate::feeder::{FeedOutcome, RejectionReason};
use sinew_estimate::session::Recorder;
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;

/// Number of consecutive frames rejected for their time stamps after which the filters restart: the clock jumped back
/// permanently.
const MAX_REJECTED_STAMPS: u32 = 8;

/// Converts frames into blocks. Allocates at construction only.
#[derive(Debug)]
pub(super) struct Ingest {
    pub(super) clocks: Clocks,
    pub(super) health: Health,
    pub(super) recorder: Recorder,
    /// Number of frames received, and of those lost, rejected or incomplete.
    pub(super) frames: u64,
    pub(super) frames_lost: u64,
    started: Instant,
    /// Arrival of the last frame.
    pub(super) last: Option<Instant>,
    silent: bool,
    /// Time stamp of the start of the recording, ns.
    zero_ns: Option<i64>,
    /// Arrival of the first frame of the present recording.
    pub(super) recorded_from: Option<Instant>,
    /// Number of consecutive frames rejected for their time stamps.
    backwards: u32,
    pub(super) temperature_c: Option<f64>,
    /// Whether the last frame was accepted.
    accepted: bool,
}

/// Result of ingesting a frame.
pub(super) struct Arrived {
    /// Rate of the time stamps relative to real time, s/s, if they are found not to be real time.
    pub(super) not_time: Option<f64>,
    pub(super) lost: bool,
    /// Whether the frame completed a block.
    pub(super) block: bool,
}

impl Ingest {
    pub(super) fn new(setup: &Setup, now: Instant) -> Self {
        let gap_s = setup.config.times.gap_s;
        Self {
            clocks: Clocks::new(setup.config.clock, gap_s),
            health: Health::new(setup.elastic.clone(), &setup.robot.transmissions),
            recorder: Recorder::new(&setup.robot, &FeatureConfig::default(), gap_s)
                .with_limits(&setup.robot),
            frames: 0,
            frames_lost: 0,
            started: now,
            last: None,
            silent: false,
            zero_ns: None,
            recorded_from: None,
            backwards: 0,
            temperature_c: None,
            accepted: false,
        }
    }

    /// Notes the arrival of data. After an interruption, returns its duration, s (inner `None`: first data ever).
    pub(super) fn data_arrived(&mut self, now: Instant) -> Option<Option<f64>> {
        let last = self.last.replace(now);
        if last.is_some() && !self.silent {
            return None;
        }
        self.silent = false;
        self.restart_stamps();
        Some(last.map(|last| now.since_s(last)))
    }

    /// Ingests a frame, after [`Ingest::data_arrived`].
    pub(super) fn frame(&mut self, frame: &Frame, now: Instant) -> Arrived {
        let not_time = match self.clocks.stamp(frame.time_ns, now) {
            Some(ClockEvent::NotTime(rate)) => Some(rate),
            _ => None,
        };
        let time_s = self.recording_time_s(frame, now);
        let fed = self.recorder.push(frame, time_s);
        self.health.frame(frame, fed, now);
        let lost = matches!(fed, FeedOutcome::Rejected(_));
        self.frames += 1;
        self.frames_lost += u64::from(lost);
        self.accepted = !lost;
        if frame.temperature_c.is_finite() {
            self.temperature_c = Some(frame.temperature_c);
        }
        match fed {
            FeedOutcome::Rejected(RejectionReason::TimeStep) => {
                self.backwards += 1;
                if self.backwards >= MAX_REJECTED_STAMPS {
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

    /// Returns `theta − q` of an axis in `frame`, rad, if it is the last frame and was accepted.
    pub(super) fn motor_minus_joint_rad(&self, axis: usize, frame: &Frame) -> Option<f64> {
        let theta = self.recorder.theta().get(axis).filter(|_| self.accepted)?;
        Some(theta - frame.q.get(axis)?)
    }

    /// Counts messages that a full queue dropped before they became frames.
    pub(super) fn dropped(&mut self, messages: u64) {
        self.frames_lost = self.frames_lost.saturating_add(messages);
        self.health.dropped(messages);
    }

    /// Restarts the filters and the measurement of time.
    fn restart_stamps(&mut self) {
        self.recorder.restart();
        self.clocks.restart();
        self.zero_ns = None;
        self.backwards = 0;
    }

    /// Returns the time within the present recording, s. Time stamps give time differences only; after a restart, the
    /// monotonic clock gives the elapsed time.
    fn recording_time_s(&mut self, frame: &Frame, now: Instant) -> f64 {
        let from = *self.recorded_from.get_or_insert(now);
        let zero = *self.zero_ns.get_or_insert_with(|| {
            let passed_ns = now.monotonic_ns.saturating_sub(from.monotonic_ns);
            frame.time_ns.saturating_sub(passed_ns)
        });
        frame.time_ns.saturating_sub(zero) as f64 * 1e-9
    }

    /// Discards the recording and starts a new one.
    pub(super) fn discard_recording(&mut self) {
        self.recorder.clear();
        (self.recorded_from, self.zero_ns) = (None, None);
    }

    /// Returns the time since the last data, s.
    pub(super) fn silent_s(&self, now: Instant) -> f64 {
        now.since_s(self.last.unwrap_or(self.started))
    }

    /// Notes that no more data arrive; returns whether that is new.
    pub(super) fn fall_silent(&mut self) -> bool {
        let new = !std::mem::replace(&mut self.silent, true);
        if new {
            self.health.silent();
        }
        new
    }

    /// Returns the freshness of the data; data older than `stale_after_s` are stale.
    pub(super) fn freshness(&self, stale_after_s: f64, now: Instant) -> Freshness {
        match self.last.map(|last| now.since_s(last)) {
            None => Freshness::Never,
            Some(for_s) if for_s < stale_after_s => Freshness::Fresh,
            Some(for_s) => Freshness::Stale { for_s },
        }
    }
}
