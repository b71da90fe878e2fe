//! The number of now: a recursive filter, and its successor. No other file of the monitor knows the filter.

use super::config::MonitorError;
use crate::transaction::Belief;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::session::{SessionError, SessionOptions, Verdict, live, live_without_baseline};
use sinew_model::Gaussian;
use sinew_model::offset::{Block, ForceEstimate, RecursiveOffsets};
use sinew_model::robot::Robot;

/// An estimate of now that begins with what a session taught. Made away from the thread that takes frames.
#[derive(Debug)]
pub(super) struct Successor(Box<RecursiveOffsets>);

impl Successor {
    pub(super) fn new(
        robot: &Robot,
        learned: &Baseline,
        options: &SessionOptions,
    ) -> Result<Self, SessionError> {
        let filter = live(robot, (learned, "what was learned"), options)?;
        Ok(Self(Box::new(filter)))
    }
}

/// The number of now. A filter that runs for days grows surer than a rope is steady, so every session leaves a
/// successor that begins with what its batch estimate taught, and takes over once it is out of doubt itself.
#[derive(Debug)]
pub(super) struct Online {
    filter: Option<Box<RecursiveOffsets>>,
    next: Option<Box<RecursiveOffsets>>,
    /// Joints of the robot.
    joints: usize,
    /// Freed at the next tick: not in a frame.
    retired: Option<Box<RecursiveOffsets>>,
    /// Whether the present filter has been out of doubt since data came.
    known: bool,
    /// Motion for which it has been in doubt, s.
    doubt_s: f64,
}

impl Online {
    pub(super) fn new(
        robot: &Robot,
        options: &SessionOptions,
        belief: &Belief,
    ) -> Result<Self, MonitorError> {
        let filter = match (&belief.learns, &belief.baseline) {
            (Some(_), _) => None,
            (None, Some(baseline)) => Some(live(robot, (baseline, "what was stored"), options)?),
            (None, None) => Some(live_without_baseline(robot, options)?),
        };
        Ok(Self {
            filter: filter.map(Box::new),
            next: None,
            joints: robot.arm.dof(),
            retired: None,
            known: false,
            doubt_s: 0.0,
        })
    }

    /// Takes a block.
    pub(super) fn step(&mut self, block: &Block, moved: bool, block_s: f64) {
        if let Some(filter) = &mut self.filter {
            // A block that isn't finite is refused, and changes nothing.
            let _refused = filter.step(block);
            match filter.is_provisional() {
                true if moved => self.doubt_s += block_s,
                true => {}
                false => (self.known, self.doubt_s) = (true, 0.0),
            }
        }
        let Some(next) = &mut self.next else { return };
        let _refused = next.step(block);
        let joints = 0..self.joints;
        let is_told = |filter: &RecursiveOffsets, i: usize| {
            Verdict::of(filter.offset(i)) != Verdict::CannotTell
        };
        let tells_less = |now: &RecursiveOffsets| {
            let mut joints = joints.clone();
            joints.any(|i| is_told(now, i) && !is_told(next, i))
        };
        // An arm that stands tells its successor nothing: the number of before stays.
        let ready = !next.is_provisional() && !self.filter.as_deref().is_some_and(tells_less);
        // The room of a filter that waits to be freed is needed first.
        if ready && self.retired.is_none() {
            self.retired = std::mem::replace(&mut self.filter, self.next.take());
            (self.known, self.doubt_s) = (true, 0.0);
        }
    }

    /// A session left this successor. Where `at_once`, nothing is known until it is out of doubt.
    pub(super) fn succeed(&mut self, Successor(next): Successor, at_once: bool) {
        if at_once || self.filter.is_none() {
            self.filter = Some(next);
            self.next = None;
            self.forget();
        } else {
            self.next = Some(next);
        }
    }

    /// Nothing is known until a filter is out of doubt.
    pub(super) fn forget(&mut self) {
        (self.known, self.doubt_s) = (false, 0.0);
    }

    /// A baseline is learned first: there is no number.
    pub(super) fn stop(&mut self) {
        (self.filter, self.next) = (None, None);
        self.forget();
    }

    /// Frees what is no longer needed.
    pub(super) fn tidy(&mut self) {
        self.retired = None;
    }

    /// Whether there is a number that can be believed.
    pub(super) fn is_sure(&self) -> bool {
        let filter = self.filter.as_ref();
        self.known && filter.is_some_and(|filter| !filter.is_provisional())
    }

    /// Whether something has been known since data came.
    pub(super) fn is_known(&self) -> bool {
        self.known
    }

    /// Motion for which it has been in doubt, s; `None`: there is no estimate.
    pub(super) fn doubt_s(&self) -> Option<f64> {
        self.filter.is_some().then_some(self.doubt_s)
    }

    /// A constant force from outside at the tool, where one is likely.
    pub(super) fn external_force(&self) -> Option<ForceEstimate> {
        let filter = self.filter.as_ref().filter(|_| self.is_sure())?;
        filter
            .external_force()
            .filter(ForceEstimate::is_worth_a_word)
    }

    /// What a temperature that isn't known adds to the deviation of a joint's offset, rad; `None`: it is known.
    pub(super) fn unknown_temperature_rad(&self, joint: usize) -> Option<f64> {
        let filter = self.filter.as_ref()?;
        Some(filter.unknown_temperature_rad(joint)).filter(|added| *added > 0.0)
    }

    /// Offset of a joint, rad.
    pub(super) fn offset(&self, joint: usize) -> Option<Gaussian> {
        let offset = self.filter.as_ref()?.offset(joint);
        offset.is_finite().then_some(offset)
    }
}
