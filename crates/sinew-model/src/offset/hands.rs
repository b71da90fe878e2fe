//! Work that can be done at once.

use alloc::vec::Vec;

/// Who does two things that have nothing to do with each other. What comes out is the same to the
/// last bit, whoever does which: work is split by what there is to do, never by who is there.
pub trait Hands: core::fmt::Debug + Sync {
    /// Does both, and returns when both are done.
    fn both(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send));
}

/// One thing after the other.
#[derive(Debug, Clone, Copy)]
pub struct OneHand;

impl Hands for OneHand {
    fn both(&self, one: &mut (dyn FnMut() + Send), other: &mut (dyn FnMut() + Send)) {
        one();
        other();
    }
}

/// What `of` says of every item, in their order; every second one by another hand.
pub(super) fn each<T: Sync, R: Send>(
    hands: &dyn Hands,
    items: &[T],
    of: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let every_second = |from: usize, out: &mut Vec<R>| {
        out.extend(items.iter().skip(from).step_by(2).map(&of));
    };
    let (mut even, mut odd) = (Vec::new(), Vec::new());
    hands.both(&mut || every_second(0, &mut even), &mut || {
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
            assert_eq!(each(&OneHand, &items, |i| i * i), squares);
        }
    }
}
