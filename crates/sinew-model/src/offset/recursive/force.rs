//! Offsets averaged over whether a force from outside acts.

use crate::Gaussian;
use crate::offset::belief::Belief;
use crate::offset::block::copy;
use crate::offset::estimate::ForceEstimate;
use crate::offset::external_force::ForceModel;
use crate::offset::mixture::Mixture;
use crate::vec3::{Mat3, Vec3, cross, dot, rotate, scale, sub};
use alloc::vec::Vec;

/// What a filter knows of the force in its state.
///
/// The state has the force open from the first block on, but while it isn't likely, blocks are weighed, linearised and their noise is
/// found as if there were none: at the posterior on condition that `f = 0`. So a filter that sees no force does what one does that
/// knows of none, and friction that isn't known yet isn't taken for one. With `f, C` of the force in `x, P`:
///
/// ```text
/// x | 0 = x − P_·f C⁻¹ f,     P | 0 = P − P_·f C⁻¹ P_f·
/// ```
///
/// B. Friedland, *Treatment of bias in recursive filtering*, IEEE Transactions on Automatic Control 14, 1969, has the same for a
/// linear filter.
#[derive(Debug, Clone)]
pub(super) struct ForceBelief {
    /// Place of the force in the state.
    first: usize,
    /// Whether blocks are weighed as if it acts.
    acts: bool,
    /// Blocks for which one has been likely, while they aren't.
    likely_blocks: usize,
    /// Whether blocks contradict the force that was stated.
    is_contradicted: bool,
    /// `C⁻¹`.
    inverse: Mat3,
    mixture: Mixture,
    found: ForceEstimate,
    /// The state that blocks are weighed at.
    point: Vec<f64>,
}

/// Blocks are weighed as if a force acts where it has been likelier than this for [`LASTS`] blocks: a contact is over by then.
const LIKELY: f64 = 0.5;
const LASTS: usize = 50;
/// They aren't any more below this.
const UNLIKELY: f64 = 0.05;

/// Three entries from a place on; NaN, which no estimate hides, where there are none.
fn triple(x: &[f64], from: usize) -> Vec3 {
    let three = x.get(from..from + 3).and_then(|x| x.try_into().ok());
    three.unwrap_or([f64::NAN; 3])
}

impl ForceBelief {
    /// Of a filter that starts from `start`, whose force begins at entry `first`; allocates here only.
    pub(super) fn new(model: &ForceModel, start: &Belief, first: usize) -> Self {
        let is_stated = model.believed.is_stated;
        Self {
            first,
            acts: is_stated,
            likely_blocks: 0,
            is_contradicted: false,
            inverse: [[f64::NAN; 3]; 3],
            mixture: Mixture::new(3, 0),
            found: ForceEstimate {
                is_stated,
                probability: if is_stated { 1.0 } else { model.odds().odds },
                force_n: model.believed.force_n,
            },
            point: start.mean.clone(),
        }
    }

    /// The filter forgets all.
    pub(super) fn restart(&mut self) {
        self.acts = self.found.is_stated;
        self.likely_blocks = 0;
        self.is_contradicted = false;
    }

    /// From now on it knows what `other` does. O(d).
    pub(super) fn know_as(&mut self, other: &Self) {
        self.acts = other.acts;
        self.likely_blocks = other.likely_blocks;
        self.is_contradicted = other.is_contradicted;
        self.inverse = other.inverse;
        self.found = other.found;
        copy(&mut self.point, &other.point);
    }

    /// Whether a force is likely and hasn't been for long, or one that was stated is another: something isn't as it was thought to be.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.is_contradicted || !self.acts && self.likely_blocks > 0
    }

    /// The state that blocks are weighed at.
    pub(super) fn point(&self) -> &[f64] {
        &self.point
    }

    pub(super) fn found(&self) -> ForceEstimate {
        self.found
    }

    /// The force and its covariance in a posterior.
    fn of(&self, now: &Belief) -> (Vec3, Mat3) {
        let d = now.mean.len().max(1);
        let row = |k: usize| triple(&now.covariance, (self.first + k) * d + self.first);
        (triple(&now.mean, self.first), [row(0), row(1), row(2)])
    }

    /// The posterior has changed: blocks are weighed at another state. O(d).
    pub(super) fn settle(&mut self, now: &Belief) {
        let (force_n, own) = self.of(now);
        let [r0, r1, r2] = own;
        let determinant = dot(r0, cross(r1, r2));
        self.inverse =
            [cross(r1, r2), cross(r2, r0), cross(r0, r1)].map(|row| scale(row, 1.0 / determinant));
        if self.acts {
            copy(&mut self.point, &now.mean);
            return;
        }
        let moved = rotate(&self.inverse, force_n);
        let rows = now.covariance.chunks_exact(now.mean.len().max(1));
        for ((to, x), row) in self.point.iter_mut().zip(&now.mean).zip(rows) {
            *to = x - dot(triple(row, self.first), moved);
        }
        for to in self.point.iter_mut().skip(self.first).take(3) {
            *to = 0.0;
        }
    }

    /// What of the variance of an equation, `h P hᵀ`, comes of a force that isn't thought to act.
    ///
    /// * `gain`: `P hᵀ`.
    pub(super) fn added_variance(&self, gain: &[f64]) -> f64 {
        if self.acts {
            return 0.0;
        }
        let shared = triple(gain, self.first);
        dot(shared, rotate(&self.inverse, shared))
    }

    /// An entry of the posterior that blocks are weighed at.
    pub(super) fn entry(&self, now: &Belief, place: usize) -> Gaussian {
        let mut entry = now.entry(place);
        if !self.acts {
            let d = now.mean.len().max(1);
            let row = now.covariance.get(place * d..(place + 1) * d);
            let variance = entry.deviation * entry.deviation;
            let less = self.added_variance(row.unwrap_or_default());
            entry.deviation = libm::sqrt((variance - less).max(0.0));
            entry.mean = self.point.get(place).copied().unwrap_or(f64::NAN);
        }
        entry
    }

    /// How likely the force of a posterior is, of an arm that was in one pose for such a share of the time. O(1).
    pub(super) fn judge(&mut self, model: &ForceModel, now: &Belief, in_one_pose: f64) {
        let (force_n, own) = self.of(now);
        let mut all = self.found.force_n.iter_mut().zip(model.believed.force_n);
        for ((to, before), (x, (k, row))) in
            (&mut all).zip(force_n.into_iter().zip(own.iter().enumerate()))
        {
            let variance = row.get(k).copied().unwrap_or(f64::NAN);
            *to = Gaussian::new(before.mean + x, libm::sqrt(variance));
        }
        self.is_contradicted = model.contradicts(force_n);
        if self.found.is_stated {
            return;
        }
        self.found.probability = 0.0;
        if model.is_credible(force_n, in_one_pose) {
            self.mixture
                .weigh(&force_n, own.as_flattened(), model.odds());
            let likely = self.mixture.probability.first();
            self.found.probability = likely.copied().unwrap_or_default();
        }
    }

    /// Whether blocks are weighed as if the force acts follows from what was [judged](ForceBelief::judge): of a block that has come, or,
    /// `at_once`, of all blocks of a pass.
    pub(super) fn decide(&mut self, at_once: bool) {
        let is_likely = self.found.probability > LIKELY;
        self.likely_blocks = if is_likely { self.likely_blocks + 1 } else { 0 };
        self.acts = if self.acts {
            self.found.is_stated || self.found.probability > UNLIKELY
        } else {
            is_likely && (at_once || self.likely_blocks >= LASTS)
        };
    }

    /// Mean and covariance of the force, averaged over whether it acts.
    fn averaged(&self, (force_n, own): (Vec3, Mat3)) -> (Vec3, Mat3) {
        if self.found.is_stated {
            return (force_n, own);
        }
        if !self.acts {
            return ([0.0; 3], [[0.0; 3]; 3]);
        }
        let row = |k: usize| triple(&self.mixture.spread, 3 * k);
        (triple(&self.mixture.mean, 0), [row(0), row(1), row(2)])
    }
}

/// A posterior averaged over whether the force in it acts.
///
/// With mean `m` and covariance `V` of the mixture of `f, C` and no force
///
/// ```text
/// x ← x + P_·f C⁻¹ (m − f),     P ← P + P_·f C⁻¹ (V − C) C⁻¹ P_f·
/// ```
///
/// as [`crate::offset::mixture::average`] has it.
#[derive(Debug, Clone)]
pub(super) struct ForceAverage {
    /// `P_·f C⁻¹`, a row per entry of the state.
    moves: Vec<Vec3>,
    /// `V − C`.
    wider: Mat3,
    averaged: Belief,
}

/// Slices in which `P` is written.
const WRITES: usize = 16;

impl ForceAverage {
    /// Of a filter that starts from `start`; allocates here only.
    pub(super) fn new(start: &Belief) -> Self {
        Self {
            moves: alloc::vec![[0.0; 3]; start.mean.len()],
            wider: [[0.0; 3]; 3],
            averaged: start.clone(),
        }
    }

    /// The posterior of the last [slices](ForceAverage::slices).
    pub(super) fn averaged(&self) -> &Belief {
        &self.averaged
    }

    /// Slices of work that an average takes.
    pub(super) fn slices(&self) -> usize {
        1 + WRITES
    }

    /// One of the slices of averaging `now`, with what its filter knows of the force in it.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock. O(d²).
    pub(super) fn slice(&mut self, slice: usize, force: &ForceBelief, now: &Belief) {
        match slice.checked_sub(1) {
            None => self.weigh(force, now),
            Some(nth) => self.write(nth, now),
        }
    }

    /// What the average moves. O(d).
    fn weigh(&mut self, force: &ForceBelief, now: &Belief) {
        let (force_n, own) = force.of(now);
        let (mean, spread) = force.averaged((force_n, own));
        let ([r0, r1, r2], [s0, s1, s2]) = (own, spread);
        let further = sub(mean, force_n);
        self.wider = [sub(s0, r0), sub(s1, r1), sub(s2, r2)];
        self.averaged.temperature_c = now.temperature_c;
        let rows = now.covariance.chunks_exact(now.mean.len().max(1));
        let from = now.mean.iter().zip(rows);
        let to = self.moves.iter_mut().zip(&mut self.averaged.mean);
        for ((moves, to), (x, row)) in to.zip(from) {
            *moves = rotate(&force.inverse, triple(row, force.first));
            *to = x + dot(*moves, further);
        }
    }

    /// Some rows of the averaged covariance.
    fn write(&mut self, nth: usize, now: &Belief) {
        let d = now.mean.len().max(1);
        let rows = d.div_ceil(WRITES);
        let to = self.averaged.covariance.chunks_exact_mut(d);
        let from = now.covariance.chunks_exact(d).zip(&self.moves);
        for (to, (from, own)) in to.zip(from).skip(nth * rows).take(rows) {
            let half = rotate(&self.wider, *own);
            for ((to, p), other) in to.iter_mut().zip(from).zip(&self.moves) {
                *to = p + dot(half, *other);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::belief::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::offset::block::Block;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::external_force::ExternalForce;
    use crate::offset::fixtures::{pushable, pushed, random};
    use crate::offset::mixture;
    use crate::offset::parameter::JointParameter as P;
    use crate::offset::recursive::RecursiveOffsets;

    const ACTS_N: [f64; 3] = [2.4, -1.2, 4.0];

    fn looked_for() -> EstimationModel {
        pushable(ExternalForce::possible(2.0).unwrap())
    }

    fn filter(model: &EstimationModel) -> RecursiveOffsets {
        let belief = model.prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let mut filter = RecursiveOffsets::of(model.clone(), belief).unwrap();
        filter.expect_creep(0.0).unwrap();
        filter
    }

    /// Twice as many [`pushed`]: until offsets aren't provisional any more.
    fn worked(model: &EstimationModel, force_n: [f64; 3], seed: u64) -> Vec<Block> {
        let mut blocks = pushed(model, force_n, seed);
        let later_s = blocks.len() as f64;
        for mut block in pushed(model, force_n, seed + 100) {
            block.time_s += later_s;
            blocks.push(block);
        }
        blocks
    }

    /// Joints of [`pushable`].
    fn offsets(mut entry: impl FnMut(usize) -> Gaussian) -> [Gaussian; 2] {
        let layout = looked_for().reduced.layout;
        [0, 1].map(|joint| entry(layout.place(joint, P::Offset)))
    }

    #[test]
    fn a_filter_that_sees_no_force_does_what_one_does_that_knows_of_none() {
        let model = looked_for();
        let mut plain = model.clone();
        plain.force = None;
        for seed in 1..4 {
            let (mut with, mut without) = (filter(&model), filter(&plain));
            let mut likely = 0.0_f64;
            for block in worked(&model, [0.0; 3], seed) {
                with.step(&block).unwrap();
                without.step(&block).unwrap();
                let pair = [&with, &without].map(|f| offsets(|place| f.incumbent.entry(place)));
                let [a, b] = pair;
                for (a, b) in a.into_iter().zip(b) {
                    assert!((a.mean - b.mean).abs() < 1e-6 * b.deviation, "{a:?} {b:?}");
                    assert!(
                        (a.deviation / b.deviation - 1.0).abs() < 1e-6,
                        "{a:?} {b:?}"
                    );
                }
                likely = with.external_force().unwrap().probability;
            }
            // What is told is that, too, once it is clear.
            assert!(likely < UNLIKELY && !with.is_provisional(), "{likely}");
            for joint in 0..2 {
                let (a, b) = (with.offset(joint), without.offset(joint));
                assert!((a.mean - b.mean).abs() < 1e-6 * b.deviation, "{a:?} {b:?}");
                assert!(
                    (a.deviation / b.deviation - 1.0).abs() < 1e-6,
                    "{a:?} {b:?}"
                );
            }
        }
    }

    #[test]
    fn a_force_that_nobody_stated_is_found_and_is_in_no_offset() {
        let model = looked_for();
        let mut plain = model.clone();
        plain.force = None;
        for seed in 1..4 {
            let (mut with, mut without) = (filter(&model), filter(&plain));
            for block in worked(&model, ACTS_N, seed) {
                with.step(&block).unwrap();
                without.step(&block).unwrap();
            }
            let force = with.external_force().unwrap();
            assert!(!force.is_stated && force.probability > 0.99, "{force:?}");
            for (is, should) in force.force_n.into_iter().zip(ACTS_N).take(2) {
                assert!(is.deviation < 0.4, "{is:?}");
                assert!((is.mean - should).abs() < 3.0 * is.deviation, "{is:?}");
            }
            for (joint, offset_rad) in [1e-3, 2e-3].into_iter().enumerate() {
                let told = with.offset(joint);
                assert!(told.deviation < 1e-3, "{told:?}");
                assert!(
                    (told.mean - offset_rad).abs() < 3.0 * told.deviation,
                    "{told:?}"
                );
            }
            assert_eq!(without.external_force(), None);
            let missed = [(0, 1e-3), (1, 2e-3)].map(|(joint, offset_rad)| {
                let told = without.offset(joint);
                (told.mean - offset_rad).abs() / told.deviation.min(1e-3)
            });
            assert!(missed.iter().any(|z| *z > 3.0), "{missed:?}");
        }
    }

    #[test]
    fn a_stated_force_acts_from_the_first_block_on() {
        let stated = ACTS_N.map(|mean| Gaussian::new(mean, 0.1));
        let model = pushable(ExternalForce {
            force_n: stated,
            is_stated: true,
        });
        let mut filter = filter(&model);
        for block in pushed(&model, ACTS_N, 5).into_iter().take(10) {
            filter.step(&block).unwrap();
            let force = filter.external_force().unwrap();
            assert!(force.is_stated && force.probability == 1.0, "{force:?}");
            for (is, should) in force.force_n.into_iter().zip(ACTS_N) {
                assert!(is.deviation <= 0.1 + 1e-12, "{is:?}");
                assert!((is.mean - should).abs() < 0.3, "{is:?}");
            }
        }
        // No average moves it.
        let told = filter.averaged_force();
        assert_eq!(told.mean, filter.incumbent.belief().mean);
    }

    /// However sure whoever stated it is.
    #[test]
    fn a_force_that_is_stated_wrongly_leaves_the_offsets_in_doubt() {
        for (stated_n, is_right) in [(ACTS_N, true), ([0.0, -1.2, 4.0], false)] {
            for deviation in [1e-6, 0.1] {
                let model = pushable(ExternalForce {
                    force_n: stated_n.map(|mean| Gaussian::new(mean, deviation)),
                    is_stated: true,
                });
                let mut filter = filter(&model);
                for block in worked(&model, ACTS_N, 7) {
                    filter.step(&block).unwrap();
                }
                assert_eq!(filter.is_provisional(), !is_right, "{deviation}");
            }
        }
    }

    const D: usize = 7;
    const FIRST: usize = 2;

    fn posterior(seed: &mut u64, force_n: f64) -> Belief {
        let a: Vec<f64> = (0..D * D).map(|_| random(seed)).collect();
        let mut covariance = alloc::vec![0.0; D * D];
        for i in 0..D {
            for k in 0..D {
                covariance[i * D + k] = (0..D).map(|j| a[i * D + j] * a[k * D + j]).sum();
            }
            covariance[i * (D + 1)] += 0.2;
        }
        let mut mean: Vec<f64> = (0..D).map(|_| random(seed)).collect();
        for x in &mut mean[FIRST..FIRST + 3] {
            *x *= force_n;
        }
        Belief {
            mean,
            covariance,
            temperature_c: 20.0,
        }
    }

    /// Three forces: one that is hardly likely, one that may act, one that does.
    #[test]
    fn the_average_is_the_one_of_the_batch() {
        let model = looked_for();
        let model = model.force.as_ref().unwrap();
        let mut seen = [0; 2];
        for (seed, force_n) in (1..9).flat_map(|seed| [(seed, 0.1), (seed, 4.0), (seed, 12.0)]) {
            let now = posterior(&mut { seed }, force_n);
            let mut force = ForceBelief::new(model, &now, FIRST);
            force.settle(&now);
            force.judge(model, &now, 0.0);
            force.decide(true);
            let mut average = ForceAverage::new(&now);
            (0..average.slices()).for_each(|slice| average.slice(slice, &force, &now));
            let told = average.averaged();
            let (mut mean, mut covariance) = (now.mean.clone(), now.covariance.clone());
            let columns = [FIRST, FIRST + 1, FIRST + 2];
            let likely =
                mixture::average(&columns, model.odds(), &mut mean, &mut covariance).unwrap();
            let found = force.found().probability;
            assert!((found - likely[0]).abs() < 1e-12, "{found} {likely:?}");
            seen[usize::from(found > LIKELY)] += 1;
            if found > LIKELY {
                for (a, b) in told.mean.iter().zip(&mean) {
                    assert!((a - b).abs() < 1e-10, "{a} {b}");
                }
                for (a, b) in told.covariance.iter().zip(&covariance) {
                    assert!((a - b).abs() < 1e-10, "{a} {b}");
                }
            } else {
                // That there is none: what blocks are weighed at.
                for place in (0..D).filter(|place| !columns.contains(place)) {
                    let (a, b) = (told.entry(place), force.entry(&now, place));
                    assert!((a.mean - b.mean).abs() < 1e-10, "{a:?} {b:?}");
                    assert!((a.deviation - b.deviation).abs() < 1e-10, "{a:?} {b:?}");
                }
                assert!(columns.iter().all(|k| told.mean[*k].abs() < 1e-10));
            }
        }
        assert!(seen.iter().all(|n| *n > 3), "{seen:?}");
    }
}
