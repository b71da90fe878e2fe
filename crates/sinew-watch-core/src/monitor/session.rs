//! Sessions: some minutes of motion, their end, and segments waiting for their estimate.

use super::clock::Clocks;
use super::config::Times;
use crate::instant::Instant;
use crate::journal::SessionEnd;
use crate::record::Clock;
use sinew_estimate::session::{Poses, Recorded, Recorder};
use sinew_model::offset::Block;
use std::collections::VecDeque;

/// Maximum change of a joint position at rest, rad; the criterion of the estimator for rest phases.
const MAX_REST_RAD: f64 = 0.01;
/// Maximum number of waiting segments, in addition to the ones being recorded and estimated.
const MAX_WAITING_SEGMENTS: usize = 2;
/// Maximum number of waiting segments if the next one ends a session, because a record depends on it.
const MAX_WAITING_AT_END: usize = 8;
/// Time for which memory for blocks is reserved, s.
const RESERVED_S: f64 = 10.0;
/// Minimum duration of motion of a segment to be estimated, s.
const MIN_MOTION_S: f64 = 2.0;

/// State of a session; each of its segments has a copy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Session {
    /// Number of the session, counted from the robot's first.
    pub(super) number: u64,
    pub(super) start: Instant,
    /// Duration of motion, s.
    pub(super) motion_s: f64,
    /// Time since the last motion, s.
    rest_s: f64,
    pub(super) frames: u64,
    pub(super) frames_lost: u64,
    /// Number of distinct poses.
    pub(super) poses: usize,
    /// Sum, °C, and number of the blocks' temperatures.
    celsius: [f64; 2],
    /// Clock of the session's date.
    pub(super) clock: Clock,
}

impl Session {
    /// Returns the mean temperature, °C, if it was recorded.
    pub(super) fn temperature_c(&self) -> Option<f64> {
        let [sum, count] = self.celsius;
        (count > 0.0).then(|| sum / count)
    }
}

/// Segment of a session that waits for its estimate.
#[derive(Debug)]
pub(super) struct Segment {
    pub(super) session: Session,
    pub(super) recorded: Recorded,
    /// Reason for the end of the session, if this is its last segment.
    pub(super) end: Option<SessionEnd>,
    /// Whether an offset was provisional at the end of the segment.
    pub(super) provisional: bool,
    /// Whether the motion is sufficient for an estimate.
    pub(super) has_motion: bool,
    /// Duration of motion in the segment, s.
    pub(super) motion_s: f64,
    /// Number of the tensioning whose baseline the segment belongs to, if any.
    pub(super) baseline_of: Option<u32>,
}

impl Segment {
    /// Whether the segment has motion to estimate.
    pub(super) fn is_estimable(&self) -> bool {
        self.has_motion && !self.recorded.blocks.is_empty()
    }
}

/// End of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct SegmentEnd {
    /// Reason for the end of the session, if it ends with this segment.
    pub(super) end: Option<SessionEnd>,
    pub(super) provisional: bool,
    pub(super) motor_current: bool,
    pub(super) baseline_of: Option<u32>,
}

/// Sessions, started and ended with each block, and the segments waiting for their estimate.
#[derive(Debug)]
pub(super) struct Sessions {
    pub(super) block_s: f64,
    times: Times,
    now: Option<Session>,
    /// Number of sessions so far.
    count: u64,
    poses: Poses,
    /// Last pose at rest, rad.
    pose_rad: Vec<f64>,
    /// Number of frames since the last block, and of those not usable.
    pending: [u64; 2],
    /// Whether the next block starts a session even at rest, because data arrive again.
    fresh: bool,
    /// Number of blocks in the present segment, and of those with motion.
    blocks: usize,
    moved_blocks: usize,
    /// Segments waiting for their estimate, the oldest first.
    waiting: VecDeque<Segment>,
    /// Buffer for the next segment.
    empty: Option<Recorded>,
}

impl Sessions {
    pub(super) fn new(joints: usize, block_s: f64, count: u64, times: Times) -> Self {
        Self {
            block_s,
            times,
            now: None,
            count,
            poses: Poses::new(joints),
            pose_rad: vec![f64::NAN; joints],
            pending: [0; 2],
            fresh: true,
            blocks: 0,
            moved_blocks: 0,
            waiting: VecDeque::with_capacity(MAX_WAITING_AT_END + 1),
            empty: None,
        }
    }

    /// Sets the time limits of sessions and segments.
    pub(super) fn set_times(&mut self, times: Times) {
        self.times = times;
    }

    pub(super) fn now(&self) -> Option<&Session> {
        self.now.as_ref()
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Counts frames, of which `lost` are not usable.
    pub(super) fn frames(&mut self, frames: u64, lost: u64) {
        self.pending[0] += frames;
        self.pending[1] += lost;
    }

    /// Notes that data arrive again.
    pub(super) fn back(&mut self) {
        self.fresh = true;
    }

    /// Adds a block of the recording that started at `from`; returns whether the arm moved. `None`: no session is in
    /// progress, and the block is not needed.
    pub(super) fn block(
        &mut self,
        block: &Block,
        clocks: &mut Clocks,
        from: Instant,
        now: Instant,
    ) -> Option<bool> {
        let (q_rad, temperature_c) = (block.q.as_slice(), block.temperature_c);
        let apart = |(pose, q): (&f64, &f64)| !((pose - q).abs() <= MAX_REST_RAD);
        // The first pose is not the result of a motion.
        let has_pose = self.pose_rad.iter().all(|x| x.is_finite());
        let moved = self.pose_rad.iter().zip(q_rad).any(apart);
        if moved {
            for (pose, q) in self.pose_rad.iter_mut().zip(q_rad) {
                *pose = *q;
            }
        }
        let moved = moved && has_pose;
        if self.now.is_none() {
            if !(moved || self.fresh) {
                self.pending = [0; 2];
                return None;
            }
            self.begin(clocks, from);
        }
        self.fresh = false;
        let session = self.now.as_mut()?;
        if moved {
            session.motion_s += self.block_s;
            session.rest_s = 0.0;
        } else {
            session.rest_s += self.block_s;
        }
        session.frames += self.pending[0] - self.pending[1];
        session.frames_lost += self.pending[1];
        self.pending = [0; 2];
        if temperature_c.is_finite() {
            session.celsius[0] += temperature_c;
            session.celsius[1] += 1.0;
        }
        self.poses.push(q_rad);
        session.poses = self.poses.count();
        session.clock = clocks.clock(now);
        self.blocks += 1;
        self.moved_blocks += usize::from(moved);
        Some(moved)
    }

    fn begin(&mut self, clocks: &mut Clocks, now: Instant) {
        clocks.begin();
        self.count += 1;
        self.poses.clear();
        self.now = Some(Session {
            number: self.count,
            start: now,
            motion_s: 0.0,
            rest_s: 0.0,
            frames: 0,
            frames_lost: 0,
            poses: 0,
            celsius: [0.0; 2],
            clock: clocks.clock(now),
        });
    }

    /// Returns the reason for the end of the session, if a time limit is reached.
    pub(super) fn is_over(&self) -> Option<SessionEnd> {
        let session = self.now?;
        if session.rest_s >= self.times.session_pause_s {
            Some(SessionEnd::Stood)
        } else {
            (session.motion_s >= self.times.session_motion_s).then_some(SessionEnd::Full)
        }
    }

    /// Whether the present segment has its maximum length.
    pub(super) fn is_segment_over(&self) -> bool {
        self.blocks as f64 * self.block_s >= self.times.stretch_s
    }

    /// Sets the clock of the session's date.
    pub(super) fn set_clock(&mut self, clock: Clock) {
        if let Some(session) = &mut self.now {
            session.clock = clock;
        }
    }

    /// Ends the present session.
    pub(super) fn end(&mut self) {
        self.now = None;
        self.restart_segment();
    }

    /// Restarts the present segment.
    pub(super) fn restart_segment(&mut self) {
        (self.blocks, self.moved_blocks) = (0, 0);
    }

    /// Queues the recording as a segment for its estimate. Returns the duration of motion, s, that is dropped because
    /// too many segments wait; otherwise 0.
    pub(super) fn end_segment(&mut self, recorder: &mut Recorder, how: SegmentEnd) -> f64 {
        let motion_s = self.moved_blocks as f64 * self.block_s;
        self.restart_segment();
        let has_motion = motion_s >= MIN_MOTION_S;
        if !has_motion && how.end.is_none() {
            // Long rest within a session: one block contains the information of all.
            recorder.clear();
            return 0.0;
        }
        let Some(session) = self.now else { return 0.0 };
        let most = match how.end {
            None => MAX_WAITING_SEGMENTS,
            Some(_) => MAX_WAITING_AT_END,
        };
        if self.waiting.len() >= most {
            recorder.clear();
            return motion_s;
        }
        let empty = self.empty.take();
        let empty = empty.unwrap_or_else(|| recorder.room(0.0));
        let mut recorded = recorder.exchange(empty);
        recorded.motor_current = how.motor_current;
        self.waiting.push_back(Segment {
            session,
            recorded,
            end: how.end,
            has_motion,
            provisional: how.provisional,
            motion_s,
            baseline_of: how.baseline_of,
        });
        0.0
    }

    /// Returns the oldest waiting segment.
    pub(super) fn next_segment(&mut self) -> Option<Segment> {
        self.waiting.pop_front()
    }

    /// Puts a segment back, to be estimated next.
    pub(super) fn give_back(&mut self, segment: Segment) {
        self.waiting.push_front(segment);
    }

    /// Assigns the waiting segments to the baseline of another tensioning, or to none.
    pub(super) fn set_baseline(&mut self, baseline_of: Option<u32>) {
        for segment in &mut self.waiting {
            segment.baseline_of = baseline_of;
        }
    }

    /// Returns the start of the oldest session with a waiting segment, s since 1970 UTC.
    pub(super) fn waiting_from_utc_s(&self) -> Option<f64> {
        self.waiting.front().map(|s| s.session.start.utc_s())
    }

    /// Whether a segment is waiting that does not belong to a baseline.
    pub(super) fn has_waiting(&self) -> bool {
        self.waiting.iter().any(|s| s.baseline_of.is_none())
    }

    /// Reserves memory for coming blocks, outside the frame path.
    pub(super) fn make_room(&mut self, recorder: &mut Recorder) {
        recorder.make_room(RESERVED_S);
        if self.empty.is_none() {
            self.empty = Some(recorder.room(RESERVED_S));
        }
    }
}
