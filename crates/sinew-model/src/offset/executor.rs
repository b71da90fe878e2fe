//! Work that can be done at once.

use alloc::vec::Vec;

/// Runs two independent closures, at once if it can. Results are the same to the last bit with
/// every executor: work is split by what there is to do, never by who is there.
pub trait Executor: core::fmt::Debug + Sync {
    /// Runs both, and returns when both are done.
    fn join(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send));
}

/// One closure after the other.
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
    let (mut even, mut odd) = (Vec::new(), Vec::new());
    executor.join(&mut || every_second(0, &mut even), &mut || {
        every_second(1, &mut odd)
    });
    let mut odd = odd.into_iter();
    let mut out = Vec::with_capacity(items.len());
    for one in even {
        out.push(one);
        out.extend(odd.next());
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
