//! What a filter does with a block, in slices of about the same work.

use super::filter::Filter;
use super::ring::BlockRing;
use super::workspace::{Workspace, bands};
use crate::offset::equations::estimation_model::EstimationModel;

/// A filter's work on one block, and how far it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Task {
    kind: Kind,
    /// Of the block.
    number: usize,
    /// What the equations go in with: weight times share.
    weight: f64,
    next: Next,
}

/// What is done with the block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// It comes for the first time.
    Update,
    /// It comes in a pass, weighed against where the pass before ended, with this scale.
    Pass { scale: f64 },
    /// It is weighed again.
    Again,
}

/// The slice that is next.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Next {
    Linearise,
    /// From this equation on.
    Project(usize),
    Insert(usize),
    /// `P` is written.
    Write(usize),
    Done,
}

/// Equations that go in within a slice.
const INSERTED: usize = 4;

impl Task {
    pub(super) fn new(kind: Kind, number: usize) -> Self {
        Self {
            kind,
            number,
            weight: 0.0,
            next: Next::Linearise,
        }
    }

    /// The most slices a task takes.
    pub(super) fn slices(joints: usize, dimension: usize) -> usize {
        let n = joints;
        // Linearised; projected joint by joint; put in; written.
        1 + n + (2 * n).div_ceil(INSERTED) + bands(dimension)
    }

    /// One slice; returns whether it was the last.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(d²).
    pub(super) fn advance(
        &mut self,
        filter: &mut Filter,
        model: &EstimationModel,
        work: &mut Workspace,
        ring: &BlockRing,
    ) -> bool {
        let Some((slot, kept)) = ring.get(self.number) else {
            return true;
        };
        let equations = work.equations.list.len();
        self.next = match self.next {
            Next::Linearise => {
                let projected = match self.kind {
                    Kind::Update => {
                        filter.go_on(kept.block.time_s);
                        filter.linearise(model, work, kept);
                        true
                    }
                    Kind::Pass { scale } => {
                        let weight = filter.weigh_in_pass(model, work, kept, scale);
                        self.weight = weight * kept.share;
                        filter.note_new((weight, kept.share), slot)
                    }
                    Kind::Again => {
                        let weight = filter.weigh_again(model, work, kept, slot);
                        self.weight = weight.unwrap_or_default();
                        weight.is_some()
                    }
                };
                work.taken.fill(0.0);
                work.surprising.fill(0.0);
                match projected {
                    true => Next::Project(0),
                    false => Next::Done,
                }
            }
            Next::Project(first) => match work.project(filter.belief(), first) {
                next if next < equations => Next::Project(next),
                _ if self.kind != Kind::Update => Next::Insert(0),
                _ => {
                    let scale = filter.begin_update();
                    let weight = filter.weigh_new(model, work, (kept.share, scale));
                    self.weight = weight * kept.share;
                    match filter.note_new((weight, kept.share), slot) {
                        true => Next::Insert(0),
                        false => Next::Done,
                    }
                }
            },
            Next::Insert(first) => {
                let next = first + INSERTED;
                for k in first..next.min(equations) {
                    filter.insert(work, slot, k, self.weight);
                }
                match next < equations {
                    true => Next::Insert(next),
                    false if work.taken.iter().all(|t| *t == 0.0) => Next::Done,
                    false => Next::Write(0),
                }
            }
            Next::Write(band) => {
                filter.downdate(work, band);
                match band + 1 < bands(filter.belief().mean.len()) {
                    true => Next::Write(band + 1),
                    false => Next::Done,
                }
            }
            Next::Done => Next::Done,
        };
        let is_done = self.next == Next::Done;
        if is_done && self.kind == Kind::Update {
            filter.judge_force(model, ring.in_one_pose(), false);
        }
        is_done
    }
}
