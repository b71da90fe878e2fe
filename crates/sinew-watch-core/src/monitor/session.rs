//! A session: some minutes of motion, and what ends it.

use super::clock::Clocks;
use crate::instant::Instant;
use crate::journal::SessionEnd;
use crate::record::Clock;
use sinew_estimate::session::Poses;

/// A joint that moved by more since it last stood somewhere moves, rad: what the estimator takes for a stand.
const STAND_RAD: f64 = 0.01;

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
    /// Distinct poses.
    pub(super) poses: usize,
    /// Sum and number of the blocks' temperatures, °C.
    celsius: [f64; 2],
    /// Whether its date can be believed.
    pub(super) clock: Clock,
    /// Stretches handed over so far.
    pub(super) stretches: u64,
}

impl Session {
    /// Mean temperature, °C, where it was recorded.
    pub(super) fn temperature_c(&self) -> Option<f64> {
        let [sum, count] = self.celsius;
        (count > 0.0).then(|| sum / count)
    }
}

/// Begins and ends sessions, block by block. Allocates at construction only.
#[derive(Debug, Clone)]
pub(super) struct Sessions {
    block_s: f64,
    motion_s: f64,
    pause_s: f64,
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
}

impl Sessions {
    pub(super) fn new(joints: usize, block_s: f64, count: u64) -> Self {
        Self {
            block_s,
            motion_s: f64::INFINITY,
            pause_s: f64::INFINITY,
            now: None,
            count,
            poses: Poses::new(joints),
            pose_rad: vec![f64::NAN; joints],
            pending: [0; 2],
            fresh: true,
        }
    }

    /// After how much motion and how long a pause a session ends, s.
    pub(super) fn set_length(&mut self, motion_s: f64, pause_s: f64) {
        (self.motion_s, self.pause_s) = (motion_s, pause_s);
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
        (q_rad, temperature_c): (&[f64], f64),
        clocks: &mut Clocks,
        from: Instant,
        now: Instant,
    ) -> Option<bool> {
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
            stretches: 0,
        });
    }

    /// Whether it is over by itself.
    pub(super) fn is_over(&self) -> Option<SessionEnd> {
        let session = self.now?;
        if session.stands_s >= self.pause_s {
            Some(SessionEnd::Stood)
        } else {
            (session.motion_s >= self.motion_s).then_some(SessionEnd::Full)
        }
    }

    /// A stretch of it is handed over.
    pub(super) fn count_stretch(&mut self) {
        if let Some(session) = &mut self.now {
            session.stretches += 1;
        }
    }

    /// The clock its date is of.
    pub(super) fn set_clock(&mut self, clock: Clock) {
        if let Some(session) = &mut self.now {
            session.clock = clock;
        }
    }

    /// Ends it.
    pub(super) fn end(&mut self) -> Option<Session> {
        self.now.take()
    }
}
