//! Parallel execution of two halves of a computation on idle processors.

use sinew_files::interrupt;
use sinew_model::offset::Executor;

/// Thread pool of Rayon: the pool of the caller, otherwise one thread per processor. An [interruption](interrupt) is checked before
/// each computation.
#[derive(Debug, Clone, Copy)]
pub struct Pool;

impl Executor for Pool {
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        interrupt::check();
        rayon::join(one, other);
    }
}

/// Guard that turns its thread into a pool of one thread. Until it is dropped, [`Pool`] computes both halves in
/// sequence in this thread, and the other processors stay free, for example for a control loop.
#[derive(Debug)]
pub struct Alone {
    _pool: Option<rayon::ThreadPool>,
}

impl Alone {
    /// Turns the calling thread into a pool of one thread. A thread that already belongs to a pool stays in that pool.
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
