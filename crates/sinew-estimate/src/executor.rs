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

/// While it lives, this thread is a pool of its own: [`Pool`] computes one half after the other in it, and other processors are left to
/// others, such as a control loop.
#[derive(Debug)]
pub struct Alone {
    _pool: Option<rayon::ThreadPool>,
}

impl Alone {
    /// Of the calling thread; where the thread belongs to a pool already, that pool stays.
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
