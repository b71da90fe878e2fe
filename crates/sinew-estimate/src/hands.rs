//! Processors that have nothing to do, for work that two can do at once.

use sinew_model::offset::Executor;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Those of the machine.
static MACHINE: LazyLock<Processors> =
    LazyLock::new(|| Processors::of(std::thread::available_parallelism().map_or(1, usize::from)));

/// Processors that threads of this process take while they are busy.
#[derive(Debug)]
pub struct Processors {
    free: AtomicUsize,
}

impl Processors {
    /// So many; the thread that uses them has its own.
    fn of(count: usize) -> Self {
        Self {
            free: AtomicUsize::new(count.saturating_sub(1)),
        }
    }

    /// Those of the machine, for the whole process.
    pub fn machine() -> &'static Self {
        &MACHINE
    }

    /// One that is free, if there is one.
    fn take(&self) -> Option<Taken<'_>> {
        let less = |free: usize| free.checked_sub(1);
        let had = self
            .free
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, less);
        had.ok().map(|_| Taken(self))
    }

    /// So many, or as many as are free: for threads that are busy for long.
    pub fn take_up_to(&self, count: usize) -> Vec<Taken<'_>> {
        std::iter::from_fn(|| self.take()).take(count).collect()
    }
}

/// A processor, until it is dropped.
#[derive(Debug)]
pub struct Taken<'a>(&'a Processors);

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        self.0.free.fetch_add(1, Ordering::AcqRel);
    }
}

/// A second thread where a processor is free for it.
impl Executor for Processors {
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        match self.take() {
            Some(_taken) => std::thread::scope(|scope| {
                scope.spawn(other);
                one();
            }),
            None => {
                one();
                other();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::{ThreadId, current};

    /// The threads that did one and the other thing.
    fn who(processors: &Processors) -> [Option<ThreadId>; 2] {
        let [mut one, mut other] = [None; 2];
        processors.join(&mut || one = Some(current().id()), &mut || {
            other = Some(current().id())
        });
        [one, other]
    }

    #[test]
    fn a_second_thread_works_where_a_processor_is_free() {
        let here = Some(current().id());
        let [one, other] = who(&Processors::of(2));
        assert!(one == here && other.is_some() && other != here);
        assert_eq!(who(&Processors::of(1)), [here; 2]);
        // Those that are taken are given back.
        let processors = Processors::of(4);
        let taken = processors.take_up_to(8);
        assert_eq!(taken.len(), 3);
        assert_eq!(who(&processors), [here; 2]);
        drop(taken);
        for _ in 0..8 {
            assert_ne!(who(&processors)[1], here);
        }
    }

    #[test]
    fn work_within_work_finds_no_processor_of_two() {
        let processors = Processors::of(2);
        let mut within = [[None; 2]; 2];
        let [one, other] = &mut within;
        processors.join(&mut || *one = who(&processors), &mut || {
            *other = who(&processors)
        });
        let here = Some(current().id());
        assert_eq!(within[0], [here; 2]);
        assert_eq!(within[1][0], within[1][1]);
        assert_ne!(within[1][0], here);
    }
}
