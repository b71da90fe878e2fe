//! Parallel execution of two tasks.

use alloc::vec::Vec;

/// Runs two independent closures, in parallel if possible. Results are bitwise identical with every
/// executor: the work is split by its content, never by the available threads.
pub trait Executor: core::fmt::Debug + Sync {
    /// Runs both, and returns when both are done.
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send));
}

/// Executor that calls one closure after the other.
#[derive(Debug, Clone, Copy)]
pub struct Sequential;

impl Executor for Sequential {
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        one();
        other();
    }
}

/// `of` every item, in their order; every second one in the other closure.
pub(crate) fn map_each<T: Sync, R: Send>(
    executor: &dyn Executor,
    items: &[T],
    of: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let every_second = |from: usize, out: &mut Vec<R>| {
        out.extend(items.iter().skip(from).step_by(2).map(&of));
    };
    let (mut from_0, mut from_1) = (Vec::new(), Vec::new());
    executor.join(&mut || every_second(0, &mut from_0), &mut || {
        every_second(1, &mut from_1)
    });
    let mut from_1 = from_1.into_iter();
    let mut out = Vec::with_capacity(items.len());
    for one in from_0 {
        out.push(one);
        out.extend(from_1.next());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_come_in_the_order_of_the_items() {
        for count in 0..6 {
            let items: Vec<usize> = (0..count).collect();
            let squares: Vec<usize> = items.iter().map(|i| i * i).collect();
            assert_eq!(map_each(&Sequential, &items, |i| i * i), squares);
        }
    }
}
