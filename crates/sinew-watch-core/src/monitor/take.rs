//! Frames in: what is recorded, and where a stretch ends.

use super::clock::{ClockEvent, Clocks};
use super::job::Stretch;
use super::{Feed, Monitor};
use crate::instant::Instant;
use crate::journal::{Event, SessionEnd};
use crate::record::Clock;
use sinew_estimate::feeder::{Fed, Refusal};
use sinew_log::Frame;
use sinew_model::offset::FeatureConfig;

/// Stretches that wait at most, beside the one that is recorded and the one that is estimated.
pub(super) const STRETCHES_WAITING: usize = 2;
/// The same of a session's last stretch.
pub(super) const ENDS_WAITING: usize = 8;
/// Room for blocks is made for so much time to come, s.
const ROOM_S: f64 = 10.0;
/// Frames refused for their stamps one after the other: a clock that jumped back for good.
const BACKWARDS: u32 = 8;
/// A stretch with less motion teaches nothing, s.
const LEAST_MOTION_S: f64 = 2.0;

impl Monitor {
    /// Takes a frame of the robot's joints, in the order of [`MonitorConfig::robot`](crate::MonitorConfig).
    ///
    /// # Realtime
    /// No allocation in steady motion, lock or clock; see [`Monitor`].
    pub fn frame(&mut self, frame: &Frame, now: Instant) {
        self.watch_clock(now);
        self.data_came(now);
        if let Some(ClockEvent::NotTime(rate)) = self.clocks.stamp(frame.time_ns, now) {
            self.event(Event::StampsNotTime { rate }, now);
        }
        let time_s = self.recording_time_s(frame, now);
        let fed = self.recorder.push(frame, time_s);
        self.health.frame(frame, fed, now);
        let lost = matches!(fed, Fed::Refused(_));
        self.feed.frames += 1;
        self.feed.frames_lost += u64::from(lost);
        self.sessions.frames(1, u64::from(lost));
        if frame.temperature_c.is_finite() {
            self.feed.temperature_c = Some(frame.temperature_c);
        }
        match fed {
            Fed::Refused(Refusal::TimeStep) => {
                self.feed.backwards += 1;
                if self.feed.backwards >= BACKWARDS {
                    self.restart_stamps();
                }
            }
            _ => self.feed.backwards = 0,
        }
        if fed.output() == Some(true) {
            self.block(now);
        }
    }

    /// Messages were dropped before they became frames, by a full queue.
    pub fn dropped(&mut self, messages: u64, now: Instant) {
        self.feed.dropped = self.feed.dropped.saturating_add(messages);
        self.feed.frames_lost = self.feed.frames_lost.saturating_add(messages);
        self.sessions.frames(messages, messages);
        self.health.dropped(messages);
        self.watch_clock(now);
    }

    /// The civil clock against the one that never steps.
    pub(super) fn watch_clock(&mut self, now: Instant) {
        if let Some(ClockEvent::Step(by_s)) = self.clocks.now(now) {
            self.event(Event::ClockStep { by_s }, now);
            self.sessions.set_clock(Clock::Stepped);
            self.end_session(SessionEnd::ClockStep, now);
        }
    }

    fn data_came(&mut self, now: Instant) {
        let last = self.feed.last.replace(now);
        if last.is_some() && !self.feed.silent {
            return;
        }
        self.feed.first.get_or_insert(now);
        self.feed.silent = false;
        let after_s = last.map(|last| now.since_s(last));
        self.event(Event::Back { after_s }, now);
        self.restart_stamps();
        if self.sessions.now().is_none() {
            self.sessions.back();
            self.live.forget();
        }
    }

    /// What comes next is a start: of the filters, and of what stamps say of time.
    fn restart_stamps(&mut self) {
        self.recorder.restart();
        self.clocks.restart();
        self.feed.zero_ns = None;
        self.feed.backwards = 0;
    }

    /// Time of the recording under way, s: stamps give steps, and nothing else. Where they began anew, the clock
    /// that never steps says how long that took.
    fn recording_time_s(&mut self, frame: &Frame, now: Instant) -> f64 {
        let Feed {
            zero_ns,
            stamp_ns,
            recorded_from,
            ..
        } = &mut self.feed;
        let from = *recorded_from.get_or_insert(now);
        let zero = *zero_ns.get_or_insert_with(|| {
            let passed_ns = now.monotonic_ns.saturating_sub(from.monotonic_ns);
            frame.time_ns.saturating_sub(passed_ns)
        });
        *stamp_ns = frame.time_ns;
        frame.time_ns.saturating_sub(zero) as f64 * 1e-9
    }

    fn block(&mut self, now: Instant) {
        let block = self.recorder.observer().block();
        let from = self.feed.recorded_from.unwrap_or(now);
        let taken = (block.q.as_slice(), block.temperature_c);
        let moved = self.sessions.block(taken, &mut self.clocks, from, now);
        let block_s = FeatureConfig::default().block_s;
        self.live.step(block, moved == Some(true), block_s);
        let Some(moved) = moved else {
            // Nobody needs what a standing arm says again and again.
            self.forget_recorded();
            return;
        };
        self.feed.blocks += 1;
        self.feed.moved_blocks += usize::from(moved);
        if let Some(end) = self.sessions.is_over() {
            self.end_session(end, now);
            return;
        }
        if let Some(learning) = &mut self.learning {
            learning.block(self.recorder.observer().block(), moved, block_s);
            if learning.hand_over() {
                self.end_session(SessionEnd::Baseline, now);
                return;
            }
        }
        if self.feed.blocks as f64 * block_s >= self.config.times.stretch_s {
            self.end_stretch(None);
        }
    }

    /// Drops what is recorded: the recording begins anew.
    fn forget_recorded(&mut self) {
        self.recorder.clear();
        (self.feed.recorded_from, self.feed.zero_ns) = (None, None);
        (self.feed.blocks, self.feed.moved_blocks) = (0, 0);
    }

    /// The session under way ends, if there is one.
    pub(super) fn end_session(&mut self, end: SessionEnd, now: Instant) {
        if let (Some(session), Some(last)) = (self.sessions.now(), self.feed.last)
            && Clocks::is_caught_up(session.motion_s, last.since_s(session.start))
        {
            self.sessions.set_clock(Clock::Stamp);
        }
        let Some(session) = self.sessions.now().copied() else {
            return;
        };
        if session.motion_s > 0.0 {
            self.end_stretch(Some(end));
            let duration_s = session.motion_s;
            self.event(Event::Session { duration_s, end }, now);
        }
        self.sessions.end();
        self.forget_recorded();
    }

    /// What is recorded becomes a stretch that waits for its estimate.
    fn end_stretch(&mut self, end: Option<SessionEnd>) {
        let block_s = FeatureConfig::default().block_s;
        let motion_s = self.feed.moved_blocks as f64 * block_s;
        (self.feed.blocks, self.feed.moved_blocks) = (0, 0);
        let worth_it = motion_s >= LEAST_MOTION_S;
        if !worth_it && end.is_none() {
            // A long stand amid a session: one block says what all of them say.
            self.recorder.clear();
            return;
        }
        let Some(session) = self.sessions.now().copied() else {
            return;
        };
        let most = match end {
            None => STRETCHES_WAITING,
            // A record hangs on it.
            Some(_) => ENDS_WAITING,
        };
        if self.waiting.len() >= most {
            self.feed.behind_s += motion_s;
            self.recorder.clear();
            return;
        }
        let empty = self.empty.take();
        let empty = empty.unwrap_or_else(|| self.recorder.room(0.0));
        let mut recorded = self.recorder.exchange(empty);
        recorded.motor_current = self.config.estimate.motor_current;
        self.waiting.push_back(Stretch {
            session,
            recorded,
            end,
            worth_it,
            in_doubt: !self.live.is_sure(),
            motion_s,
            baseline_of: self.learning.as_ref().map(|_| self.tensionings),
        });
        self.sessions.count_stretch();
    }

    /// Room for what comes, off the path of frames.
    pub(super) fn make_room(&mut self) {
        self.recorder.make_room(ROOM_S);
        if self.empty.is_none() {
            self.empty = Some(self.recorder.room(ROOM_S));
        }
        self.live.tidy();
    }
}
