//! Parallel processing of many items, in the order of the items.

use rayon::prelude::*;
use sinew_files::interrupt;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Processes items on all processors and returns results in their order; `done` is called with the
/// number of finished items.
pub fn each<I: Sync, T: Send>(
    items: &[I],
    work: impl Fn(&I) -> T + Sync,
    done: impl Fn(usize) + Sync,
) -> Vec<T> {
    let finished = AtomicUsize::new(0);
    items
        .par_iter()
        .with_max_len(1)
        .map(|item| {
            interrupt::check();
            let result = work(item);
            done(finished.fetch_add(1, Ordering::Relaxed) + 1);
            result
        })
        .collect()
}
