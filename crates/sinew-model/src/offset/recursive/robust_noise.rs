//! Robust noise of equations by medians, without an allocation.

use crate::offset::equations::equation::{Equation, Side};
use crate::offset::equations::robust::DEVIATION_PER_MEDIAN;
use alloc::vec::Vec;

/// ResidualSizes of the residuals of a pass, smallest first: their median is the noise.
#[derive(Debug, Clone)]
pub(super) struct ResidualSizes {
    /// Link equations of all joints, then motor equations.
    of: [Vec<SortedSizes>; 2],
}

/// The smallest of the numbers it was given, ascending.
#[derive(Debug, Clone)]
struct SortedSizes {
    sizes: Vec<f64>,
    count: usize,
}

impl ResidualSizes {
    pub(super) fn new(joints: usize, most: usize) -> Self {
        let none = SortedSizes {
            sizes: alloc::vec![f64::INFINITY; most],
            count: 0,
        };
        Self {
            of: [alloc::vec![none.clone(); joints], alloc::vec![none; joints]],
        }
    }

    pub(super) fn clear(&mut self) {
        for sorted in self.of.iter_mut().flatten() {
            sorted.sizes.fill(f64::INFINITY);
            sorted.count = 0;
        }
    }

    pub(super) fn keep(&mut self, e: &Equation) {
        let [link, motor] = &mut self.of;
        let sorted = match e.side {
            Side::Link => link.get_mut(e.joint),
            Side::Motor => motor.get_mut(e.joint),
        };
        if let Some(sorted) = sorted {
            let mut size = e.residual.abs();
            sorted.count += 1;
            for slot in sorted.sizes.iter_mut().take(sorted.count) {
                if size < *slot {
                    core::mem::swap(slot, &mut size);
                }
            }
        }
    }

    /// Noise by the median size; `None` of too few.
    pub(super) fn noise(&self, joint: usize, side: Side) -> Option<f64> {
        const FEW: usize = 10;
        let [link, motor] = &self.of;
        let sorted = match side {
            Side::Link => link.get(joint),
            Side::Motor => motor.get(joint),
        }?;
        let median = *sorted.sizes.get(sorted.count / 2)?;
        (sorted.count >= FEW && median.is_finite()).then_some(DEVIATION_PER_MEDIAN * median)
    }
}
