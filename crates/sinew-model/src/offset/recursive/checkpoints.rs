//! What a filter knew of late.

use super::filter::Filter;
use super::ring::KEPT;

/// A filter as it was.
#[derive(Debug, Clone)]
struct Checkpoint {
    filter: Filter,
    /// Blocks taken by then.
    taken: usize,
}

/// A filter as it was, twice: the older one is from before what is seen now, and from ten to twenty seconds ago.
#[derive(Debug, Clone)]
pub(super) struct Checkpoints {
    newer: Checkpoint,
    older: Checkpoint,
}

/// Blocks between two.
const EVERY: usize = 50;

impl Checkpoints {
    /// Room for those of a filter; allocates here only.
    pub(super) fn new(filter: &Filter) -> Self {
        let begun = Checkpoint {
            filter: filter.clone(),
            taken: 0,
        };
        Self {
            newer: begun.clone(),
            older: begun,
        }
    }

    /// Whether one is due after so many blocks.
    pub(super) fn is_due(taken: usize) -> bool {
        taken.is_multiple_of(EVERY)
    }

    /// The older one.
    pub(super) fn older(&self) -> &Filter {
        &self.older.filter
    }

    /// Keeps what a filter knows after so many blocks, in the place of the older one. O(d²).
    pub(super) fn keep(&mut self, filter: &Filter, taken: usize) {
        core::mem::swap(&mut self.newer, &mut self.older);
        self.newer.filter.know_as(filter);
        self.newer.taken = taken;
    }

    /// A filter that has taken so many blocks knows what the older one does. O(d²).
    pub(super) fn go_back(&self, filter: &mut Filter, taken: usize) {
        filter.know_as(&self.older.filter);
        filter.doubt_what_is_not_finite();
        let since = self.older.taken.max(taken.saturating_sub(KEPT))..taken;
        filter.leave_out(since.map(|number| number % KEPT));
    }
}
