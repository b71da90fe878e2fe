//! What is done with a block: in which order, and slice by slice.
//!
//! A slice costs `O(d²)` at most: a block's equations, a joint's rows times `P`, two bands of `P` written. So a loop with
//! little time does some per sample, and all of them within the time of a block.

use super::force::{ForceAverage, ForceBelief};
use super::{
    AGAIN, COARSE, KEPT, Kind, NOISE_SEEN, RecursiveOffsets, SCALES, SEGMENT, SOFTER, Stage, Task,
};
use crate::StepError;
use crate::offset::block::Block;

/// Blocks the challenger goes over while one comes.
const AT_ONCE: usize = 10;

/// What is done next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Next {
    /// Nothing is left.
    Rest,
    /// The incumbent takes the new block.
    Incumbent(Taking),
    /// The challenger decides what to do.
    Challenge,
    /// The challenger takes the new block.
    Track(Taking),
    /// The challenger goes over so many blocks more.
    Replay(usize),
    /// One of these in a pass.
    Pass(usize, Task),
    /// One of these after the last pass.
    CatchUp(usize, Taking),
    /// Which one explains the blocks better: what they cost the challenger and the incumbent up to block `at`.
    Compare {
        at: usize,
        costs: [f64; 2],
        tracking: bool,
    },
    /// Whether the challenger began too early.
    Tracked,
    /// What is known is kept, so often.
    Keep(usize),
    /// What was known before something was amiss is known again.
    GoBack,
    /// Averages over whether a force acts and over lost stiffness: this slice of it.
    Average(usize),
}

/// A filter takes a block: it weighs again those that came [`AGAIN`] blocks before, then the new one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Taking {
    number: usize,
    /// Of [`AGAIN`]; behind its end: the new one.
    nth: usize,
    task: Task,
}

impl Taking {
    fn new(number: usize) -> Self {
        Self::nth(number, 0)
    }

    /// The first that is there, from the `nth` on.
    fn nth(number: usize, nth: usize) -> Self {
        let mut ages = AGAIN.iter().enumerate().skip(nth);
        let old = ages.find_map(|(k, age)| Some((k, number.checked_sub(*age)?)));
        let (nth, task) = match old {
            Some((k, old)) => (k, Task::new(Kind::Again, old)),
            None => (AGAIN.len(), Task::new(Kind::Update, number)),
        };
        Self { number, nth, task }
    }

    /// What follows the task at work.
    fn following(self) -> Option<Self> {
        (self.nth < AGAIN.len()).then(|| Self::nth(self.number, self.nth + 1))
    }
}

impl RecursiveOffsets {
    /// Takes a block; its work is done by [`RecursiveOffsets::advance`]. `false`: the block is left out, as work on the
    /// one before isn't done; nothing has changed.
    ///
    /// # Errors
    /// [`StepError`] when the block is of another arm or not finite; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(n r): the block is copied.
    pub fn begin(&mut self, block: &Block) -> Result<bool, StepError> {
        if self.is_busy() {
            return Ok(false);
        }
        let number = self.ring.push(&self.model, block)?;
        if self.stated_c.is_finite() {
            self.ring.state_temperature(number, self.stated_c);
        }
        self.temperature_known = self.stated_c.is_finite() || block.temperature_c.is_finite();
        self.next = Next::Incumbent(Taking::new(number));
        Ok(true)
    }

    /// Does so many slices of the work that is left; returns how many it did: fewer mean that nothing is left, and that the
    /// offsets are those of the last block.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(d²) a slice.
    pub fn advance(&mut self, slices: usize) -> usize {
        for done in 0..slices {
            if !self.is_busy() {
                return done;
            }
            self.slice();
        }
        slices
    }

    /// Whether work on the last block is left.
    pub fn is_busy(&self) -> bool {
        self.next != Next::Rest
    }

    /// The most slices a block takes.
    pub fn slices_per_block(&self) -> usize {
        let task = Task::slices(self.model.reduced.layout.joints, self.start.mean.len());
        let taking = (AGAIN.len() + 1) * task;
        // The incumbent's, the decision, ten of the challenger's with a slice between, the comparison with its verdict and the two
        // that follow it, the average.
        let compared = KEPT + 3;
        taking + 1 + AT_ONCE * (taking + 1) + 1 + compared + self.average_slices()
    }

    /// Does all that is left.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. Not bounded as [`RecursiveOffsets::advance`] is.
    pub fn finish(&mut self) {
        while self.is_busy() {
            self.slice();
        }
    }

    /// A slice of work.
    fn slice(&mut self) {
        self.next = match self.next {
            Next::Rest => Next::Rest,
            Next::Incumbent(mut taking) => {
                let (model, work) = (&self.model, &mut self.work);
                if !(taking.task).advance(&mut self.incumbent, model, work, &self.ring) {
                    Next::Incumbent(taking)
                } else {
                    taking.following().map_or(Next::Challenge, Next::Incumbent)
                }
            }
            Next::Challenge => self.challenge(),
            Next::Track(taking) => match self.challenger_takes(taking) {
                Some(taking) => Next::Track(taking),
                None => {
                    let since = self.ring.taken().saturating_sub(self.from);
                    match since.is_multiple_of(AT_ONCE) {
                        true => self.compare(true),
                        false => Next::Tracked,
                    }
                }
            },
            Next::Replay(left) => self.replay(left),
            Next::Pass(left, mut task) => {
                let (model, work) = (&self.model, &mut self.work);
                match task.advance(&mut self.challenger, model, work, &self.ring) {
                    false => Next::Pass(left, task),
                    true => self.passed(left),
                }
            }
            Next::CatchUp(left, taking) => match self.challenger_takes(taking) {
                Some(taking) => Next::CatchUp(left, taking),
                None => self.caught_up(left),
            },
            Next::Compare {
                at,
                costs,
                tracking,
            } => self.compare_block(at, costs, tracking),
            Next::Tracked => {
                // It began with blocks from before what it should explain.
                if self.stage == Stage::Tracking && self.challenger_fails() {
                    self.await_segment();
                }
                Next::Average(0)
            }
            Next::Keep(times) => {
                self.keep();
                match times {
                    0 | 1 => Next::Average(0),
                    times => Next::Keep(times - 1),
                }
            }
            Next::GoBack => {
                self.go_back();
                Next::Average(0)
            }
            Next::Average(slice) => {
                self.average(slice);
                if slice + 1 < self.average_slices() {
                    Next::Average(slice + 1)
                } else {
                    self.tell();
                    Next::Rest
                }
            }
        };
    }

    /// Slices of the averages.
    fn average_slices(&self) -> usize {
        self.force.as_ref().map_or(0, ForceAverage::slices) + self.stiffness.slices()
    }

    /// One of them: over whether a force acts, then over lost stiffness.
    fn average(&mut self, slice: usize) {
        let now = self.incumbent.belief();
        let Some((average, force)) = self.force.as_mut().zip(self.incumbent.force()) else {
            self.stiffness.slice(slice, &self.start, now);
            return;
        };
        match slice.checked_sub(average.slices()) {
            None => average.slice(slice, force, now),
            Some(slice) => (self.stiffness).slice(slice, &self.start, average.averaged()),
        }
    }

    /// What the challenger does while a block comes.
    fn challenge(&mut self) -> Next {
        match self.stage {
            Stage::Idle => {
                if self.ring.taken() == SEGMENT {
                    self.begin_replay();
                } else if self.ring.taken() > SEGMENT && self.is_disturbed() {
                    self.await_segment();
                    return Next::GoBack;
                } else if self.is_to_be_kept() {
                    return Next::Keep(1);
                }
            }
            // What disturbed it is over.
            Stage::Waiting { .. } | Stage::Replaying { .. } if self.opened && self.agrees() => {
                self.rest();
            }
            Stage::Waiting { until } => {
                if self.ring.taken() >= until {
                    self.begin_replay();
                }
            }
            Stage::Replaying { .. } => return Next::Replay(AT_ONCE),
            Stage::Tracking => return Next::Track(Taking::new(self.ring.taken() - 1)),
        }
        Next::Average(0)
    }

    /// A slice of the challenger's taking a block; what is left of it.
    fn challenger_takes(&mut self, mut taking: Taking) -> Option<Taking> {
        let (model, work) = (&self.model, &mut self.work);
        match (taking.task).advance(&mut self.challenger, model, work, &self.ring) {
            false => Some(taking),
            true => taking.following(),
        }
    }

    /// One block for the challenger, of `left`.
    fn replay(&self, left: usize) -> Next {
        let Stage::Replaying { pass, at, .. } = self.stage else {
            return Next::Average(0);
        };
        match (left.checked_sub(1), SCALES.get(pass)) {
            (None, _) => Next::Average(0),
            (Some(left), Some(&scale)) => Next::Pass(left, Task::new(Kind::Pass { scale }, at)),
            (Some(left), None) => Next::CatchUp(left, Taking::new(at)),
        }
    }

    /// The challenger has gone over a block in a pass.
    fn passed(&mut self, left: usize) -> Next {
        let Stage::Replaying {
            to,
            mut pass,
            mut at,
        } = self.stage
        else {
            return Next::Average(0);
        };
        at += if pass < COARSE { 2 } else { 1 };
        if at >= to {
            pass += 1;
            if pass > NOISE_SEEN {
                // Blocks from before and after a second slip would look like noise.
                if !self.goes_on() {
                    self.challenger.find_noise(&self.model);
                }
                let in_one_pose = self.ring.in_one_pose();
                (self.challenger).judge_force(&self.model, in_one_pose, true);
            }
            if pass < SCALES.len() {
                at = self.from;
                self.begin_pass();
            }
        }
        self.replayed(left, (to, pass, at))
    }

    /// The challenger has taken a block after the last pass.
    fn caught_up(&mut self, left: usize) -> Next {
        let Stage::Replaying { to, pass, at } = self.stage else {
            return Next::Average(0);
        };
        self.replayed(left, (to, pass, at + 1))
    }

    fn replayed(&mut self, left: usize, (to, pass, at): (usize, usize, usize)) -> Next {
        self.stage = Stage::Replaying { to, pass, at };
        if pass == SCALES.len() && at >= self.ring.taken() {
            self.stage = Stage::Tracking;
            return self.compare(false);
        }
        Next::Replay(left)
    }

    /// The comparison begins, after a block of `tracking` or of a replay.
    fn compare(&self, tracking: bool) -> Next {
        Next::Compare {
            at: self.ring.taken().saturating_sub(KEPT).max(self.from),
            costs: [0.0; 2],
            tracking,
        }
    }

    /// One block of it, or the verdict.
    fn compare_block(&mut self, at: usize, mut costs: [f64; 2], tracking: bool) -> Next {
        if at >= self.ring.taken() {
            return match (self.judge(costs), tracking) {
                // What was known before what is settled now no longer holds.
                (true, _) => Next::Keep(2),
                (false, true) => Next::Tracked,
                (false, false) => Next::Average(0),
            };
        }
        if let Some((_, kept)) = self.ring.get(at)
            && kept.share > 0.0
        {
            let filters = [&self.challenger, &self.incumbent];
            for (filter, cost) in filters.into_iter().zip(&mut costs) {
                filter.add_cost(&self.model, &mut self.work, kept, cost);
            }
        }
        Next::Compare {
            at: at + 1,
            costs,
            tracking,
        }
    }

    /// Whether the challenger replaces the incumbent, or rests; whether the incumbent is to be kept as it is now.
    fn judge(&mut self, [challenger, incumbent]: [f64; 2]) -> bool {
        /// By how much it must explain its blocks better, half chi-square: it has every entry to
        /// itself. A slip of a millirad is worth more in 15 s.
        const BETTER: f64 = 60.0;
        /// The first time it may be worse by as much: its noise is found, the incumbent's is on the way there.
        const NO_WORSE: f64 = 10.0;
        /// After so many blocks it needn't: nothing goes into the incumbent meanwhile.
        const LONG: usize = 3 * SEGMENT;
        /// From so many blocks that carry new information: two or three stands say little of an arm.
        const ENOUGH: f64 = 15.0;
        let opening = self.from == 0;
        let taken = self.ring.taken();
        let seen = taken.saturating_sub(KEPT).max(self.from)..taken;
        let news: f64 = seen
            .filter_map(|number| self.ring.get(number))
            .map(|(_, kept)| kept.share)
            .sum();
        let fits = news * self.model.inflation > ENOUGH && self.challenger_fits();
        let is_long = taken.saturating_sub(self.from) > LONG;
        let margin = match (opening, is_long) {
            (true, _) => -NO_WORSE,
            (false, true) => 0.0,
            (false, false) => BETTER,
        };
        let better = (opening || fits) && challenger + margin < incumbent;
        if better {
            core::mem::swap(&mut self.challenger, &mut self.incumbent);
            if !opening {
                self.settle();
            }
        }
        self.opened |= opening;
        if better || opening || self.agrees() {
            self.rest();
        }
        better || opening
    }

    /// From now on the offsets are those of the last block.
    pub(super) fn tell(&mut self) {
        for joint in 0..self.told.len() {
            let offset = self.offset_now(joint);
            if let Some(told) = self.told.get_mut(joint) {
                *told = offset;
            }
        }
        if self.seen == 0 {
            for (joint, softer) in self.softer_before.iter_mut().enumerate() {
                *softer = self
                    .stiffness
                    .probability(joint)
                    .is_some_and(|p| p > SOFTER);
            }
        }
        self.told_force = self.incumbent.force().map(ForceBelief::found);
        self.told_provisional = self.is_provisional_now();
    }

    /// The same if no work is left: else its last slice does it.
    pub(super) fn tell_at_rest(&mut self) {
        if !self.is_busy() {
            self.tell();
        }
    }
}
