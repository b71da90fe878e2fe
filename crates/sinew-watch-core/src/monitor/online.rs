//! Online offsets: a window over the last blocks, and its successor. Only this file handles windows.

use crate::instant::Instant;
use crate::transaction::MonitorState;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::online::{OnlineAnswer, OnlineJoint, Provisional, Window};
use sinew_estimate::session::{Recorded, Recorder, SessionError, SessionOptions, Since, Verdict};
use sinew_model::offset::ForceEstimate;
use sinew_model::robot::Robot;
use std::sync::Arc;

/// Time for which memory for blocks is reserved, s.
const RESERVED_S: f64 = 10.0;
/// Maximum number of blocks waiting for a job: the size of a window.
const MAX_WAITING_BLOCKS: usize = 600;
/// Number of waiting blocks from which the answer is outdated: as many as fit into [`RESERVED_S`].
const MIN_OUTDATED_BLOCKS: usize = 50;

fn window(
    robot: &Arc<Robot>,
    baseline: Option<&Baseline>,
    options: &SessionOptions,
) -> Result<Box<Window>, SessionError> {
    let baseline = baseline.map(|baseline| (baseline.clone(), "the stored posterior".to_owned()));
    let window = Window::new(Arc::clone(robot), baseline, options, "session")?;
    // Each window starts from the posterior of other sessions, with the prior variance of the offsets reset.
    Ok(Box::new(window.following(Since::Days(1.0))))
}

/// Window that starts from the posterior of a session.
#[derive(Debug)]
pub(super) struct Successor(Box<Window>);

impl Successor {
    pub(super) fn new(
        robot: &Arc<Robot>,
        posterior: &Baseline,
        options: &SessionOptions,
    ) -> Result<Self, SessionError> {
        window(robot, Some(posterior), options).map(Self)
    }
}

/// Windows of a robot, which check blocks and estimate offsets.
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
        let is_conclusive = |joint: &OnlineJoint| !Verdict::is_inconclusive(joint.offset_rad);
        let joints = now.joints.iter().zip(&next.joints);
        // An arm at rest does not inform the successor: the present window stays in use.
        let next_is_less_informed = joints
            .clone()
            .any(|(now, next)| is_conclusive(now) && !is_conclusive(next));
        if !next.is_provisional() && !next_is_less_informed {
            self.replace(None);
        }
    }

    /// Replaces the present window by `by`, otherwise by the waiting successor.
    fn replace(&mut self, by: Option<Box<Window>>) {
        if let Some(next) = by.or_else(|| self.next.take()) {
            self.now = next;
        }
    }
}

/// Online job, run outside the frame thread.
#[derive(Debug)]
pub(super) struct OnlineJob {
    windows: Windows,
    successor: Option<(Successor, bool)>,
    part: Recorded,
    generation: u32,
}

/// Result of an [`OnlineJob`].
#[derive(Debug)]
pub(super) struct OnlineResult {
    windows: Windows,
    part: Recorded,
    generation: u32,
}

impl OnlineJob {
    /// Checks new blocks and solves the windows that are due.
    pub(super) fn run(self) -> OnlineResult {
        let Self {
            mut windows,
            successor,
            mut part,
            generation,
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
        OnlineResult {
            windows,
            part,
            generation,
        }
    }
}

/// Location of the windows.
#[derive(Debug)]
enum WindowLocation {
    /// No windows: a baseline is being acquired.
    None,
    Here(Windows),
    /// The windows belong to a running job.
    Away,
}

/// Online offsets. Each session creates a successor that starts from its posterior and takes over once its offsets are
/// settled.
#[derive(Debug)]
pub(super) struct Online {
    location: WindowLocation,
    /// Successor for the next job, and whether it takes over immediately.
    successor: Option<(Successor, bool)>,
    /// Blocks since the last job, and the buffer for the following ones.
    part: Recorded,
    empty: Option<Recorded>,
    /// Zero of the windows' time.
    zero: Option<Instant>,
    /// Number of times that the windows were discarded; results of older jobs are ignored.
    generation: u32,
    answer: Option<OnlineAnswer>,
    /// Time before which no solution is valid, s.
    from_s: f64,
    /// Time of the last block, s, and the same in s since 1970 UTC.
    last_s: f64,
    last_utc_s: f64,
    /// Duration of motion for which offsets have been provisional, s.
    provisional_s: f64,
}

impl Online {
    pub(super) fn new(
        robot: &Arc<Robot>,
        options: &SessionOptions,
        state: &MonitorState,
        recorder: &Recorder,
    ) -> Result<Self, SessionError> {
        let location = match &state.learns {
            Some(_) => WindowLocation::None,
            None => WindowLocation::Here(Windows {
                now: window(robot, state.baseline.as_ref(), options)?,
                next: None,
            }),
        };
        Ok(Self {
            location,
            successor: None,
            part: recorder.room(RESERVED_S),
            empty: Some(recorder.room(RESERVED_S)),
            zero: None,
            generation: 0,
            answer: None,
            from_s: f64::NEG_INFINITY,
            last_s: f64::NEG_INFINITY,
            last_utc_s: 0.0,
            provisional_s: 0.0,
        })
    }

    /// Adds the last block of the recording that started at `from`; the block is complete at `now`.
    ///
    /// # Realtime
    /// No allocation while the reserved memory suffices; no lock and no clock access.
    pub(super) fn block(
        &mut self,
        recorded: &Recorded,
        [from, now]: [Instant; 2],
        moved: bool,
        block_s: f64,
    ) {
        if matches!(self.location, WindowLocation::None) {
            return;
        }
        if self.part.blocks.len() >= MAX_WAITING_BLOCKS {
            // The delay of the jobs exceeds the window length: the waiting blocks are outdated.
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
            // The window of a successor starts here.
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

    /// Reserves memory for coming blocks, outside the frame path.
    pub(super) fn make_room(&mut self, recorder: &Recorder) {
        recorder.make_room_in(&mut self.part, RESERVED_S);
        if self.empty.is_none() && !matches!(self.location, WindowLocation::Away) {
            self.empty = Some(recorder.room(RESERVED_S));
        }
    }

    /// Returns the next job, if blocks wait.
    pub(super) fn next_job(&mut self) -> Option<OnlineJob> {
        if self.part.blocks.is_empty() || !matches!(self.location, WindowLocation::Here(_)) {
            return None;
        }
        let empty = self.empty.take()?;
        let WindowLocation::Here(windows) =
            std::mem::replace(&mut self.location, WindowLocation::Away)
        else {
            return None;
        };
        Some(OnlineJob {
            windows,
            successor: self.successor.take(),
            part: std::mem::replace(&mut self.part, empty),
            generation: self.generation,
        })
    }

    /// Accepts the result of a job; `None`: it failed, and there are no offsets until the next session ends.
    pub(super) fn made(&mut self, result: Option<OnlineResult>) {
        match result {
            Some(result) if result.generation == self.generation => {
                self.answer = Some(result.windows.now.answer().clone());
                self.location = WindowLocation::Here(result.windows);
                self.empty = Some(result.part);
            }
            Some(result) => self.empty = Some(result.part),
            None => self.stop(),
        }
    }

    /// Sets the successor that a session created. If `immediate`, there is no answer until it is settled.
    pub(super) fn succeed(&mut self, successor: Successor, immediate: bool) {
        if matches!(self.location, WindowLocation::None) {
            self.location = WindowLocation::Here(Windows {
                now: successor.0,
                next: None,
            });
            return;
        }
        self.successor = Some((successor, immediate));
        if immediate {
            self.discard_answer();
        }
    }

    /// Invalidates the answer until a window with later blocks has been solved.
    pub(super) fn discard_answer(&mut self) {
        (self.from_s, self.provisional_s) = (self.last_s, 0.0);
    }

    /// Discards windows and offsets because a baseline is acquired first.
    pub(super) fn stop(&mut self) {
        self.location = WindowLocation::None;
        self.generation += 1;
        (self.answer, self.successor, self.zero) = (None, None, None);
        self.last_s = f64::NEG_INFINITY;
        self.part.clear();
        self.discard_answer();
    }

    /// Restarts from another posterior; without one that can be used, there are no offsets until the next session ends.
    pub(super) fn restart(
        &mut self,
        robot: &Arc<Robot>,
        options: &SessionOptions,
        state: &MonitorState,
    ) {
        self.stop();
        if state.learns.is_none()
            && let Ok(now) = window(robot, state.baseline.as_ref(), options)
        {
            self.location = WindowLocation::Here(Windows { now, next: None });
        }
    }

    /// Returns the answer, if it is up to date.
    fn answer(&self) -> Option<&OnlineAnswer> {
        let is_late = self.part.blocks.len() >= MIN_OUTDATED_BLOCKS;
        let answer = self.answer.as_ref().filter(|_| !is_late);
        answer.filter(|answer| answer.solved_s > self.from_s)
    }

    /// Whether all offsets are available and none is provisional.
    pub(super) fn is_settled(&self) -> bool {
        self.answer().is_some_and(|answer| !answer.is_provisional())
    }

    /// Whether there has been an answer since data arrived.
    pub(super) fn has_answer(&self) -> bool {
        self.answer().is_some()
    }

    /// Returns the duration of motion for which offsets have been provisional, s; `None`: no windows.
    pub(super) fn provisional_s(&self) -> Option<f64> {
        (!matches!(self.location, WindowLocation::None)).then_some(self.provisional_s)
    }

    /// Returns the constant external force at the tool, N, if it is probable.
    pub(super) fn external_force(&self) -> Option<ForceEstimate> {
        self.answer()?.external_force
    }

    /// Returns the online estimate of a joint, and the reason for which it is provisional, with times in s since 1970
    /// UTC.
    pub(super) fn joint(&self, joint: usize) -> Option<(&OnlineJoint, Option<Provisional>)> {
        let estimate = self.answer()?.joint(joint)?;
        // The conversion refers to the last block: after a step of the clock, or with an accelerated clock, it is
        // correct for recent times.
        let by_s = self.last_utc_s - self.last_s;
        let provisional = estimate.provisional.map(|reason| reason.on_clock(by_s));
        estimate
            .offset_rad
            .is_finite()
            .then_some((estimate, provisional))
    }
}
