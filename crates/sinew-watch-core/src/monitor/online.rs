//! The offsets of now: a window over the last blocks, and its successor. No other file of the monitor knows windows.

use crate::instant::Instant;
use crate::transaction::Belief;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::online::{OnlineAnswer, OnlineJoint, Provisional, Window};
use sinew_estimate::session::{Recorded, Recorder, SessionError, SessionOptions, Since, Verdict};
use sinew_model::offset::ForceEstimate;
use sinew_model::robot::Robot;
use std::sync::Arc;

/// Room for blocks is made for so much time to come, s.
const ROOM_S: f64 = 10.0;
/// Blocks that wait for a job at most: a window holds no more.
const MOST: usize = 600;
/// Where so many blocks wait, the answer is not one of now: as many as [`ROOM_S`] has.
const LATE: usize = 50;

fn window(
    robot: &Arc<Robot>,
    baseline: Option<&Baseline>,
    options: &SessionOptions,
) -> Result<Box<Window>, SessionError> {
    let baseline = baseline.map(|known| (known.clone(), "what was learned".to_owned()));
    let window = Window::new(Arc::clone(robot), baseline, options, "session")?;
    // Each window begins with what is known of other sessions, and with no offset of theirs.
    Ok(Box::new(window.following(Since::Days(1.0))))
}

/// A window that begins with what a session taught.
#[derive(Debug)]
pub(super) struct Successor(Box<Window>);

impl Successor {
    pub(super) fn new(
        robot: &Arc<Robot>,
        learned: &Baseline,
        options: &SessionOptions,
    ) -> Result<Self, SessionError> {
        window(robot, Some(learned), options).map(Self)
    }
}

/// The windows of a robot, where blocks are checked and windows solved.
#[derive(Debug)]
pub(super) struct Windows {
    now: Box<Window>,
    next: Option<Box<Window>>,
}

impl Windows {
    fn push(&mut self, part: &Recorded) {
        for window in [Some(&mut self.now), self.next.as_mut()]
            .into_iter()
            .flatten()
        {
            window.push(part);
            if window.is_due() {
                window.solve();
            }
        }
        let Some(next) = &self.next else { return };
        let (now, next) = (self.now.answer(), next.answer());
        let can_tell = |joint: &OnlineJoint| Verdict::of(joint.offset_rad) != Verdict::CannotTell;
        let joints = now.joints.iter().zip(&next.joints);
        // An arm that stands teaches its successor nothing: the offset of before stays.
        let tells_less = joints
            .clone()
            .any(|(now, next)| can_tell(now) && !can_tell(next));
        if !next.is_provisional() && !tells_less {
            self.replace(None);
        }
    }

    /// Another window takes over: this one, or the one that waits.
    fn replace(&mut self, by: Option<Box<Window>>) {
        if let Some(next) = by.or_else(|| self.next.take()) {
            self.now = next;
        }
    }
}

/// What is to be done with windows, away from the thread that takes frames.
#[derive(Debug)]
pub(super) struct OnlineWork {
    windows: Windows,
    successor: Option<(Successor, bool)>,
    part: Recorded,
    of: u32,
}

/// What became of an [`OnlineWork`].
#[derive(Debug)]
pub(super) struct OnlineMade {
    windows: Windows,
    part: Recorded,
    of: u32,
}

impl OnlineWork {
    /// Checks blocks that came, and solves the windows where that is due.
    pub(super) fn run(self) -> OnlineMade {
        let Self {
            mut windows,
            successor,
            mut part,
            of,
        } = self;
        match successor {
            Some((Successor(next), true)) => {
                windows.next = None;
                windows.replace(Some(next));
            }
            Some((Successor(next), false)) => windows.next = Some(next),
            None => {}
        }
        windows.push(&part);
        part.clear();
        OnlineMade { windows, part, of }
    }
}

/// Where the windows are.
#[derive(Debug)]
enum Place {
    /// There are none: a baseline is learned first.
    None,
    Here(Windows),
    /// A job has them.
    Away,
}

/// The offsets of now. Every session leaves a successor that begins with what it taught, and takes over once its offsets are settled.
#[derive(Debug)]
pub(super) struct Online {
    place: Place,
    /// A successor for the next job, and whether it takes over at once.
    successor: Option<(Successor, bool)>,
    /// Blocks since the last job, and the part to go on with.
    part: Recorded,
    empty: Option<Recorded>,
    /// When the windows' clock began.
    zero: Option<Instant>,
    /// How often windows were given up: a job of before gives nothing.
    given_up: u32,
    answer: Option<OnlineAnswer>,
    /// Time of the windows before which no solution counts, s.
    from_s: f64,
    /// Time of the last block, s, and the same since 1970.
    last_s: f64,
    last_utc_s: f64,
    /// Motion for which offsets have been provisional, s.
    provisional_s: f64,
}

impl Online {
    pub(super) fn new(
        robot: &Arc<Robot>,
        options: &SessionOptions,
        belief: &Belief,
        recorder: &Recorder,
    ) -> Result<Self, SessionError> {
        let place = match &belief.learns {
            Some(_) => Place::None,
            None => Place::Here(Windows {
                now: window(robot, belief.baseline.as_ref(), options)?,
                next: None,
            }),
        };
        Ok(Self {
            place,
            successor: None,
            part: recorder.room(ROOM_S),
            empty: Some(recorder.room(ROOM_S)),
            zero: None,
            given_up: 0,
            answer: None,
            from_s: f64::NEG_INFINITY,
            last_s: f64::NEG_INFINITY,
            last_utc_s: 0.0,
            provisional_s: 0.0,
        })
    }

    /// Takes the last block of what is recorded since `from`, which is complete `now`.
    ///
    /// # Realtime
    /// No allocation where there is room, lock or clock.
    pub(super) fn block(
        &mut self,
        recorded: &Recorded,
        [from, now]: [Instant; 2],
        moved: bool,
        block_s: f64,
    ) {
        if matches!(self.place, Place::None) {
            return;
        }
        if self.part.blocks.len() >= MOST {
            // Jobs are later than a window is long: what waits would be none of it any more.
            self.part.clear();
        }
        let (is_first, begins) = (self.zero.is_none(), self.part.blocks.is_empty());
        let zero = *self.zero.get_or_insert(from);
        self.part.append_last(recorded, from.since_s(zero));
        self.last_s = self.part.blocks.last().map_or(self.last_s, |b| b.time_s);
        self.last_utc_s = now.utc_s() - 0.5 * block_s;
        let utc_ns = |time_s: f64| zero.utc_ns.saturating_add((1e9 * time_s) as i64);
        self.part.end_time_ns = utc_ns(self.last_s + 0.5 * block_s);
        if begins {
            // A successor's window begins here.
            let begun_s = if is_first {
                0.0
            } else {
                self.last_s - 0.5 * block_s
            };
            self.part.start_time_ns = utc_ns(begun_s);
        }
        match self.is_settled() {
            true => self.provisional_s = 0.0,
            false if moved => self.provisional_s += block_s,
            false => {}
        }
    }

    /// Makes room for what comes, off the path of frames.
    pub(super) fn make_room(&mut self, recorder: &Recorder) {
        recorder.make_room_in(&mut self.part, ROOM_S);
        if self.empty.is_none() && !matches!(self.place, Place::Away) {
            self.empty = Some(recorder.room(ROOM_S));
        }
    }

    /// What is to be done, where blocks wait.
    pub(super) fn work(&mut self) -> Option<OnlineWork> {
        if self.part.blocks.is_empty() || !matches!(self.place, Place::Here(_)) {
            return None;
        }
        let empty = self.empty.take()?;
        let Place::Here(windows) = std::mem::replace(&mut self.place, Place::Away) else {
            return None;
        };
        Some(OnlineWork {
            windows,
            successor: self.successor.take(),
            part: std::mem::replace(&mut self.part, empty),
            of: self.given_up,
        })
    }

    /// Takes what a job made; `None`: it failed, and there are no offsets until a session has left a successor.
    pub(super) fn made(&mut self, made: Option<OnlineMade>) {
        match made {
            Some(made) if made.of == self.given_up => {
                self.answer = Some(made.windows.now.answer().clone());
                self.place = Place::Here(made.windows);
                self.empty = Some(made.part);
            }
            Some(made) => self.empty = Some(made.part),
            None => self.stop(),
        }
    }

    /// A session left this successor. Where `at_once`, nothing is known until it is settled.
    pub(super) fn succeed(&mut self, successor: Successor, at_once: bool) {
        if matches!(self.place, Place::None) {
            self.place = Place::Here(Windows {
                now: successor.0,
                next: None,
            });
            return;
        }
        self.successor = Some((successor, at_once));
        if at_once {
            self.forget();
        }
    }

    /// Nothing is known until a window that ends later has been solved.
    pub(super) fn forget(&mut self) {
        (self.from_s, self.provisional_s) = (self.last_s, 0.0);
    }

    /// There are no windows, and no offsets: a baseline is learned first.
    pub(super) fn stop(&mut self) {
        self.place = Place::None;
        self.given_up += 1;
        (self.answer, self.successor, self.zero) = (None, None, None);
        self.last_s = f64::NEG_INFINITY;
        self.part.clear();
        self.forget();
    }

    /// The answer, where one of now has been solved.
    fn answer(&self) -> Option<&OnlineAnswer> {
        let is_late = self.part.blocks.len() >= LATE;
        let answer = self.answer.as_ref().filter(|_| !is_late);
        answer.filter(|answer| answer.solved_s > self.from_s)
    }

    /// Whether all offsets are known and none is provisional.
    pub(super) fn is_settled(&self) -> bool {
        self.answer().is_some_and(|answer| !answer.is_provisional())
    }

    /// Whether something has been known since data came.
    pub(super) fn is_known(&self) -> bool {
        self.answer().is_some()
    }

    /// Motion for which offsets have been provisional, s; `None`: there are no windows.
    pub(super) fn provisional_s(&self) -> Option<f64> {
        (!matches!(self.place, Place::None)).then_some(self.provisional_s)
    }

    /// A constant force from outside at the tool, where one is likely.
    pub(super) fn external_force(&self) -> Option<ForceEstimate> {
        self.answer()?.external_force
    }

    /// What is known of a joint's tendon, and why that is provisional, with times in s since 1970.
    pub(super) fn joint(&self, joint: usize) -> Option<(&OnlineJoint, Option<Provisional>)> {
        let own = self.answer()?.joint(joint)?;
        // From now back: a clock that stepped, or that runs faster than stamps, is right for what is recent.
        let by_s = self.last_utc_s - self.last_s;
        let provisional = own.provisional.map(|why| why.on_clock(by_s));
        own.offset_rad.is_finite().then_some((own, provisional))
    }
}
