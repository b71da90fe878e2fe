//! What a step of the recursive filter computes with.

use super::ring::KeptBlock;
use crate::offset::belief::Belief;
use crate::offset::block::copy;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::equations::equation::{Creeping, Equations};
use crate::offset::equations::estimation_model::EstimationModel;
use crate::offset::parameter::FORCE;
use alloc::vec::Vec;
use core::ops::Range;

/// Entries of a filter's state: the model's, those of a force where one is looked for, the rates of what creeps.
pub(super) fn dimension(model: &EstimationModel, creeps: usize) -> usize {
    model.reduced.layout.dimension() + model.force.as_ref().map_or(0, |_| FORCE) + creeps
}

/// What a step writes to besides the filter.
#[derive(Debug, Clone)]
pub(super) struct Workspace {
    pub(super) equations: Equations,
    /// A force from outside, where one is looked for.
    changes: Vec<ChangePoint>,
    /// Joints whose offsets creep.
    creeps: Vec<usize>,
    /// State the equations were linearised around.
    pub(super) origin: Vec<f64>,
    /// What a joint's equations share of `P hᵀ`, over their torque gain.
    carried: Vec<f64>,
    /// `P hᵀ` of the equations at work, a row each.
    pub(super) gains: Vec<f64>,
    /// What each adds to the information over `1 + information h P hᵀ`: `P` falls by
    /// `Σ taken P hᵀ h P`. 0: it did not go in.
    pub(super) taken: Vec<f64>,
    /// What the equations at work add to their noise as they surprise, rad² or N²m².
    pub(super) surprising: Vec<f64>,
}

impl Workspace {
    /// Of a robot on which the offsets of these joints creep.
    pub(super) fn new(model: &EstimationModel, creeps: Vec<usize>) -> Self {
        let layout = model.reduced.layout;
        let (n, d) = (layout.joints, dimension(model, creeps.len()));
        let at_s = f64::MIN;
        let force = model.force.as_ref().map(|_| ChangePoint {
            kind: ChangeKind::Force,
            at_s,
        });
        let changes: Vec<ChangePoint> = force.into_iter().collect();
        let mut all = changes.clone();
        all.extend(creeps.iter().map(|joint| ChangePoint {
            kind: ChangeKind::Creep(*joint),
            at_s,
        }));
        Self {
            equations: Equations::new(layout, &all),
            changes,
            creeps,
            origin: alloc::vec![0.0; d],
            carried: alloc::vec![0.0; d],
            gains: alloc::vec![0.0; 2 * n * d],
            taken: alloc::vec![0.0; 2 * n],
            surprising: alloc::vec![0.0; 2 * n],
        }
    }

    /// Equations of a block around the state `around`, whose offsets are those at `at_s`.
    pub(super) fn linearise(
        &mut self,
        model: &EstimationModel,
        kept: &KeptBlock,
        reference_c: f64,
        (around, at_s): (&[f64], f64),
    ) {
        let creep = Creeping {
            joints: &self.creeps,
            at_s,
        };
        let block = (&kept.block, kept.forces.as_slice());
        let besides = (self.changes.as_slice(), creep);
        model.linearise(block, reference_c, besides, around, &mut self.equations);
        copy(&mut self.origin, around);
    }

    /// `P hᵀ` of the equations at work of one joint, from the `first` on; returns the first of the next joint.
    pub(super) fn project(&mut self, belief: &Belief, first: usize) -> usize {
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
        let of_joint = self.equations.list.get(first..).unwrap_or_default();
        let Some(joint) = of_joint.first().map(|e| e.joint) else {
            return first + 1;
        };
        // Link and motor row of a joint are the same over bodies and load, but for their torque gain.
        self.carried.fill(0.0);
        let carried = self.equations.carried(joint);
        for (value, line) in carried.iter().zip(lines(layout.carried())) {
            if *value != 0.0 {
                add(&mut self.carried, *value, line);
            }
        }
        let mut next = first;
        let gains = self.gains.chunks_exact_mut(d).skip(first);
        for (e, gain) in of_joint
            .iter()
            .zip(gains)
            .take_while(|(e, _)| e.joint == joint)
        {
            next += 1;
            gain.fill(0.0);
            add(gain, e.torque_gain, &self.carried);
            for (value, line) in e.own.iter().zip(lines(layout.own(joint))) {
                if *value != 0.0 {
                    add(gain, *value, line);
                }
            }
            for (rate, value) in self.equations.changes(e) {
                for line in lines(rate..rate + 1) {
                    add(gain, value, line);
                }
            }
        }
        next.max(first + 1)
    }
}

/// Rows of `P` that are written at once.
const BAND: usize = 8;

/// Slices a [`downdate`] of a covariance of `d` rows takes.
pub(super) fn bands(d: usize) -> usize {
    d.div_ceil(BAND).div_ceil(2)
}

/// `P ← P − Σ taken P hᵀ h P`, the `slice`-th of [`bands`]: a band of rows from the top and one from the bottom, so that all
/// slices are as much work. Of every row what lies left of the diagonal is computed, and copied to its mirror place.
pub(super) fn downdate(belief: &mut Belief, (gains, taken): (&[f64], &[f64]), slice: usize) {
    let d = belief.mean.len().max(1);
    let last = d.div_ceil(BAND).saturating_sub(1);
    let mirror = last.saturating_sub(slice);
    downdate_band(&mut belief.covariance, d, (gains, taken), slice);
    if mirror != slice {
        downdate_band(&mut belief.covariance, d, (gains, taken), mirror);
    }
}

/// Four equations at a time over a tile of a band, which stays in the processor's first cache.
fn downdate_band(covariance: &mut [f64], d: usize, (gains, taken): (&[f64], &[f64]), band: usize) {
    const FOUR: usize = 4;
    const TILE: usize = 64;
    let (first, end) = (band * BAND, d.min((band + 1) * BAND));
    let Some((above, below)) = covariance.split_at_mut_checked(first * d) else {
        return;
    };
    let rows = below.get_mut(..end.saturating_sub(first) * d);
    let rows = rows.unwrap_or_default();
    for tile in (0..end).step_by(TILE) {
        let columns = tile..end.min(tile + TILE);
        for (four, taken) in gains.chunks(FOUR * d).zip(taken.chunks(FOUR)) {
            let gain = |k: usize| four.get(k * d..(k + 1) * d).unwrap_or_default();
            let of_tile = |k: usize| gain(k).get(columns.clone()).unwrap_or_default();
            let factor = |k: usize| taken.get(k).copied().unwrap_or_default();
            if taken.iter().all(|t| *t == 0.0) {
                continue;
            }
            for (i, line) in rows.chunks_exact_mut(d).enumerate() {
                let own = |k: usize| {
                    let own = gain(k).get(first + i).copied().unwrap_or_default();
                    own * factor(k)
                };
                let (a0, a1, a2, a3) = (own(0), own(1), own(2), own(3));
                let line = line.get_mut(columns.clone()).unwrap_or_default();
                if taken.len() == FOUR {
                    let pairs = of_tile(0).iter().zip(of_tile(1));
                    let pairs = pairs.zip(of_tile(2).iter().zip(of_tile(3)));
                    for (p, ((g0, g1), (g2, g3))) in line.iter_mut().zip(pairs) {
                        *p -= (a0 * g0 + a1 * g1) + (a2 * g2 + a3 * g3);
                    }
                } else {
                    for (k, a) in [a0, a1, a2].into_iter().enumerate().take(taken.len()) {
                        for (p, g) in line.iter_mut().zip(of_tile(k)) {
                            *p -= a * g;
                        }
                    }
                }
            }
        }
    }
    // What lies right of the diagonal, above the band and in it.
    for (j, line) in above.chunks_exact_mut(d).enumerate() {
        let to = line.get_mut(first..end).unwrap_or_default();
        for (to, row) in to.iter_mut().zip(rows.chunks_exact(d)) {
            *to = row.get(j).copied().unwrap_or_default();
        }
    }
    for i in 0..end.saturating_sub(first) {
        for j in 0..i {
            let below = rows.get(i * d + first + j).copied();
            if let (Some(to), Some(below)) = (rows.get_mut(j * d + first + i), below) {
                *to = below;
            }
        }
    }
}
