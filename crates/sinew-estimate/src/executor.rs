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

/// Guard that makes the thread it was created in a pool of its own: until it is dropped, [`Pool`] computes one half after the other in
/// this thread. The other processors stay free, for a control loop for example.
#[derive(Debug)]
pub struct Alone {
    _pool: Option<rayon::ThreadPool>,
}

impl Alone {
    /// Makes the calling thread a pool of its own. A thread that belongs to a pool already stays in that pool.
    pub fn new() -> Self {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1);
        let pool = one.use_current_thread().build();
        Self { _pool: pool.ok() }
    }
}

impl Default for Alone {
    fn default() -> Self {
        Self::new()
    }
}
