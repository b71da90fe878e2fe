//! Two halves of a computation at once, where a processor has nothing to do.

use sinew_model::offset::Executor;

/// Rayon's pool of threads: the one that the caller runs in, else one thread per processor.
#[derive(Debug, Clone, Copy)]
pub struct Pool;

impl Executor for Pool {
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        rayon::join(one, other);
    }
}
