//! What a step of the recursive filter computes with.

use crate::offset::belief::Belief;
use crate::offset::block::{Block, copy};
use crate::offset::equations::equation::Equations;
use crate::offset::equations::estimation_model::EstimationModel;
use crate::offset::layout::Layout;
use alloc::vec::Vec;
use core::ops::Range;

/// What a step writes to besides the filter.
#[derive(Debug, Clone)]
pub(super) struct Workspace {
    pub(super) equations: Equations,
    /// State the equations were linearised around.
    pub(super) origin: Vec<f64>,
    /// What a joint's equations share of `P hᵀ`, over their torque gain.
    carried: Vec<f64>,
    /// `P hᵀ` of the equations at work, a row each.
    pub(super) gains: Vec<f64>,
    /// What each adds to the information over `1 + information h P hᵀ`: `P` falls by
    /// `Σ taken P hᵀ h P`. 0: it did not go in.
    pub(super) taken: Vec<f64>,
}

impl Workspace {
    pub(super) fn new(layout: Layout) -> Self {
        let (n, d) = (layout.joints, layout.dimension());
        Self {
            equations: Equations::new(layout, &[]),
            origin: alloc::vec![0.0; d],
            carried: alloc::vec![0.0; d],
            gains: alloc::vec![0.0; 2 * n * d],
            taken: alloc::vec![0.0; 2 * n],
        }
    }

    /// Equations of `block` around the state `around`.
    pub(super) fn linearise(
        &mut self,
        model: &EstimationModel,
        block: &Block,
        reference_c: f64,
        around: &[f64],
    ) {
        model.linearise(block, reference_c, &[], around, &mut self.equations);
        copy(&mut self.origin, around);
    }

    /// `P hᵀ` of the equations at self.
    pub(super) fn project(&mut self, belief: &Belief) {
        let d = belief.mean.len().max(1);
        let layout = self.equations.layout();
        let lines = |range: Range<usize>| {
            let lines = belief.covariance.get(range.start * d..range.end * d);
            lines.unwrap_or_default().chunks_exact(d)
        };
        let add = |to: &mut [f64], factor: f64, line: &[f64]| {
            for (to, p) in to.iter_mut().zip(line) {
                *to += factor * p;
            }
        };
        let mut at_work = None;
        let gains = self.gains.chunks_exact_mut(d);
        for (e, gain) in self.equations.list.iter().zip(gains) {
            // Link and motor row of a joint are the same over bodies and load, but for their torque gain.
            if at_work != Some(e.joint) {
                at_work = Some(e.joint);
                self.carried.fill(0.0);
                let carried = self.equations.carried(e.joint);
                for (value, line) in carried.iter().zip(lines(layout.carried())) {
                    if *value != 0.0 {
                        add(&mut self.carried, *value, line);
                    }
                }
            }
            gain.fill(0.0);
            add(gain, e.torque_gain, &self.carried);
            for (value, line) in e.own.iter().zip(lines(layout.own(e.joint))) {
                if *value != 0.0 {
                    add(gain, *value, line);
                }
            }
        }
    }
}

/// `P ← P − Σ taken P hᵀ h P`, four at a time: a row of `P` is read and written once for four.
pub(super) fn downdate(belief: &mut Belief, gains: &[f64], taken: &[f64]) {
    const FOUR: usize = 4;
    let d = belief.mean.len().max(1);
    let fours = gains.chunks_exact(FOUR * d).zip(taken.chunks_exact(FOUR));
    for (gains, taken) in fours {
        let (Some((g0, gains)), [t0, t1, t2, t3]) = (gains.split_at_checked(d), taken) else {
            return;
        };
        let Some((g1, gains)) = gains.split_at_checked(d) else {
            return;
        };
        let Some((g2, g3)) = gains.split_at_checked(d) else {
            return;
        };
        let rows = belief.covariance.chunks_exact_mut(d);
        let own = g0.iter().zip(g1).zip(g2.iter().zip(g3));
        for (line, ((a0, a1), (a2, a3))) in rows.zip(own) {
            let (a0, a1, a2, a3) = (a0 * t0, a1 * t1, a2 * t2, a3 * t3);
            let columns = g0.iter().zip(g1).zip(g2.iter().zip(g3));
            for (p, ((g0, g1), (g2, g3))) in line.iter_mut().zip(columns) {
                *p -= (a0 * g0 + a1 * g1) + (a2 * g2 + a3 * g3);
            }
        }
    }
    let left = FOUR * (taken.len() / FOUR);
    let gains = gains.get(left * d..).unwrap_or_default().chunks_exact(d);
    let left = gains.zip(taken.get(left..).unwrap_or_default());
    for (gain, taken) in left {
        let rows = belief.covariance.chunks_exact_mut(d);
        for (line, own) in rows.zip(gain) {
            let scaled = own * taken;
            for (p, g) in line.iter_mut().zip(gain) {
                *p -= scaled * g;
            }
        }
    }
}
