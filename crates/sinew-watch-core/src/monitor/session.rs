//! A session: some minutes of motion, what ends it, and the stretches of it that wait for their estimate.

use super::clock::Clocks;
use super::config::Times;
use crate::instant::Instant;
use crate::journal::SessionEnd;
use crate::record::Clock;
use sinew_estimate::session::{Poses, Recorded, Recorder};
use sinew_model::offset::Block;
use std::collections::VecDeque;

/// A joint that moved by more since it last stood somewhere moves, rad: what the estimator takes for a stand.
const STAND_RAD: f64 = 0.01;
/// Stretches that wait at most, beside the one that is recorded and the one that is estimated.
const STRETCHES_WAITING: usize = 2;
/// Stretches that wait at most where the next one is a session's last: a record hangs on it.
const ENDS_WAITING: usize = 8;
/// Room for blocks is made for so much time to come, s.
const ROOM_S: f64 = 10.0;
/// A stretch with less motion teaches nothing, s.
const LEAST_MOTION_S: f64 = 2.0;

/// A session, as far as it has come. A copy goes with every stretch of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Session {
    /// Number, since the robot's first.
    pub(super) number: u64,
    pub(super) start: Instant,
    /// Time in motion, s.
    pub(super) motion_s: f64,
    /// Since it last moved, s.
    stands_s: f64,
    pub(super) frames: u64,
    pub(super) frames_lost: u64,
    /// Number of distinct poses.
    pub(super) poses: usize,
    /// Sum and number of the blocks' temperatures, °C.
    celsius: [f64; 2],
    /// Whether its date can be believed.
    pub(super) clock: Clock,
}

impl Session {
    /// Mean temperature, °C, where it was recorded.
    pub(super) fn temperature_c(&self) -> Option<f64> {
        let [sum, count] = self.celsius;
        (count > 0.0).then(|| sum / count)
    }
}

/// Some motion of a session that waits for its estimate.
#[derive(Debug)]
pub(super) struct Stretch {
    pub(super) session: Session,
    pub(super) recorded: Recorded,
    /// Whether it is the session's last.
    pub(super) end: Option<SessionEnd>,
    /// Whether an offset was provisional at its end.
    pub(super) in_doubt: bool,
    /// Whether there is motion enough in it to be estimated.
    pub(super) worth_it: bool,
    /// Motion in it, s.
    pub(super) motion_s: f64,
    /// Whether it is for a baseline: for that of the so-many-th tensioning.
    pub(super) baseline_of: Option<u32>,
}

/// How a stretch ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchEnd {
    /// Why the session ends with it, if it does.
    pub(super) end: Option<SessionEnd>,
    pub(super) in_doubt: bool,
    pub(super) motor_current: bool,
    pub(super) baseline_of: Option<u32>,
}

/// Begins and ends sessions, block by block, and keeps the stretches of them that wait for their estimate.
#[derive(Debug)]
pub(super) struct Sessions {
    pub(super) block_s: f64,
    times: Times,
    now: Option<Session>,
    /// Sessions begun so far.
    count: u64,
    poses: Poses,
    /// Where the arm last stood, rad.
    pose_rad: Vec<f64>,
    /// Frames since the last block, and how many of them were of no use.
    pending: [u64; 2],
    /// Whether the next block begins a session even if the arm stands: data came again.
    fresh: bool,
    /// Blocks of the stretch under way, and how many of them moved.
    blocks: usize,
    moved_blocks: usize,
    /// Stretches that wait for their estimate, the oldest first.
    waiting: VecDeque<Stretch>,
    /// What the next stretch is recorded into.
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
            waiting: VecDeque::with_capacity(ENDS_WAITING + 1),
            empty: None,
        }
    }

    /// Sets when sessions and stretches end.
    pub(super) fn set_times(&mut self, times: Times) {
        self.times = times;
    }

    pub(super) fn now(&self) -> Option<&Session> {
        self.now.as_ref()
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Frames came, of which some can't be used.
    pub(super) fn frames(&mut self, frames: u64, lost: u64) {
        self.pending[0] += frames;
        self.pending[1] += lost;
    }

    /// Data come again.
    pub(super) fn back(&mut self) {
        self.fresh = true;
    }

    /// Takes a block, recorded since `from`; `None`: no session is under way, and it is of no use. Whether the arm
    /// moved.
    pub(super) fn block(
        &mut self,
        block: &Block,
        clocks: &mut Clocks,
        from: Instant,
        now: Instant,
    ) -> Option<bool> {
        let (q_rad, temperature_c) = (block.q.as_slice(), block.temperature_c);
        let apart = |(pose, q): (&f64, &f64)| !((pose - q).abs() <= STAND_RAD);
        // The first pose there is was not come to.
        let known = self.pose_rad.iter().all(|x| x.is_finite());
        let moved = self.pose_rad.iter().zip(q_rad).any(apart);
        if moved {
            for (pose, q) in self.pose_rad.iter_mut().zip(q_rad) {
                *pose = *q;
            }
        }
        let moved = moved && known;
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
            session.stands_s = 0.0;
        } else {
            session.stands_s += self.block_s;
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
            stands_s: 0.0,
            frames: 0,
            frames_lost: 0,
            poses: 0,
            celsius: [0.0; 2],
            clock: clocks.clock(now),
        });
    }

    /// Whether it is over by itself.
    pub(super) fn is_over(&self) -> Option<SessionEnd> {
        let session = self.now?;
        if session.stands_s >= self.times.session_pause_s {
            Some(SessionEnd::Stood)
        } else {
            (session.motion_s >= self.times.session_motion_s).then_some(SessionEnd::Full)
        }
    }

    /// Whether the stretch under way is as long as one may be.
    pub(super) fn is_stretch_over(&self) -> bool {
        self.blocks as f64 * self.block_s >= self.times.stretch_s
    }

    /// Marks whether the session's date can be believed.
    pub(super) fn set_clock(&mut self, clock: Clock) {
        if let Some(session) = &mut self.now {
            session.clock = clock;
        }
    }

    /// Ends the session under way.
    pub(super) fn end(&mut self) {
        self.now = None;
        self.forget_blocks();
    }

    /// Begins the stretch under way anew.
    pub(super) fn forget_blocks(&mut self) {
        (self.blocks, self.moved_blocks) = (0, 0);
    }

    /// Makes what is recorded a stretch that waits for its estimate. Returns the motion of it, s, where it is left out
    /// because too much waits already; else 0.
    pub(super) fn end_stretch(&mut self, recorder: &mut Recorder, how: StretchEnd) -> f64 {
        let motion_s = self.moved_blocks as f64 * self.block_s;
        self.forget_blocks();
        let worth_it = motion_s >= LEAST_MOTION_S;
        if !worth_it && how.end.is_none() {
            // A long stand amid a session: one block says what all of them say.
            recorder.clear();
            return 0.0;
        }
        let Some(session) = self.now else { return 0.0 };
        let most = match how.end {
            None => STRETCHES_WAITING,
            Some(_) => ENDS_WAITING,
        };
        if self.waiting.len() >= most {
            recorder.clear();
            return motion_s;
        }
        let empty = self.empty.take();
        let empty = empty.unwrap_or_else(|| recorder.room(0.0));
        let mut recorded = recorder.exchange(empty);
        recorded.motor_current = how.motor_current;
        self.waiting.push_back(Stretch {
            session,
            recorded,
            end: how.end,
            worth_it,
            in_doubt: how.in_doubt,
            motion_s,
            baseline_of: how.baseline_of,
        });
        0.0
    }

    /// The oldest stretch that waits.
    pub(super) fn next_stretch(&mut self) -> Option<Stretch> {
        self.waiting.pop_front()
    }

    /// Whether a stretch waits that isn't for a baseline.
    pub(super) fn has_waiting(&self) -> bool {
        self.waiting.iter().any(|s| s.baseline_of.is_none())
    }

    /// Makes room for what comes, off the path of frames.
    pub(super) fn make_room(&mut self, recorder: &mut Recorder) {
        recorder.make_room(ROOM_S);
        if self.empty.is_none() {
            self.empty = Some(recorder.room(ROOM_S));
        }
    }
}
