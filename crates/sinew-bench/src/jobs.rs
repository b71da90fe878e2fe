//! Work on several threads, with the results handled one by one.

use rayon::prelude::*;
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{Mutex, PoisonError};

/// Processes the items in their order on `jobs` threads (at least one). Every result that `work` passes on is given
/// to `keep`, one at a time. `work` can check whether to continue; after the first error no further item is started.
///
/// # Errors
/// Returns the first error of `work` or `keep`.
pub(crate) fn each<I: Sync, R: Send, E: Send + From<ThreadPoolBuildError>>(
    items: &[I],
    jobs: usize,
    work: impl Fn(&I, &dyn Fn(R) -> bool) -> Result<(), E> + Sync,
    keep: impl FnMut(R) -> Result<(), E> + Send,
) -> Result<(), E> {
    let taken = Mutex::new((keep, None::<E>));
    let lock = || taken.lock().unwrap_or_else(PoisonError::into_inner);
    let give = |result: R| {
        let mut taken = lock();
        if taken.1.is_none() {
            let kept = (taken.0)(result);
            taken.1 = kept.err();
        }
        taken.1.is_none()
    };
    let one = |item: &I| {
        let done = work(item, &give);
        let mut taken = lock();
        if let Err(error) = done {
            taken.1.get_or_insert(error);
        }
        taken.1.is_none().then_some(())
    };
    let pool = ThreadPoolBuilder::new().num_threads(jobs.max(1)).build()?;
    pool.install(|| items.iter().par_bridge().try_for_each(one));
    match taken.into_inner().unwrap_or_else(PoisonError::into_inner).1 {
        Some(error) => Err(error),
        None => Ok(()),
    }
}
