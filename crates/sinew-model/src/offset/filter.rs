//! One Kalman filter over blocks, which [`super::RecursiveOffsets`] may run two of.

use super::block::{Block, copy};
use super::equation::{Equation, Equations, Side};
use super::layout::Layout;
use super::map::MapEstimator;
use super::prior::Belief;
use super::sizes::Sizes;
use alloc::vec::Vec;
use core::ops::Range;

/// What a step writes to besides the filter.
#[derive(Debug, Clone)]
pub(super) struct Work {
    equations: Equations,
    /// State the equations were linearised around.
    origin: Vec<f64>,
    /// What a joint's equations share of `P hᵀ`, over their worth.
    carried: Vec<f64>,
    /// `P hᵀ` of the equations at work, a row each.
    gains: Vec<f64>,
    /// What each adds to the information over `1 + information h P hᵀ`: `P` falls by
    /// `Σ taken P hᵀ h P`. 0: it did not go in.
    taken: Vec<f64>,
}

impl Work {
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
}

/// Belief, noise, and how well the blocks have agreed with it.
#[derive(Debug, Clone)]
pub(super) struct Filter {
    belief: Belief,
    /// Noise of link and motor equations.
    noise: [Vec<f64>; 2],
    blocks: f64,
    weight: f64,
    /// Mean weight of late: a filter that leaves most out has no say in what was right.
    trust: f64,
    /// Mean normalised innovation of late of each joint's link equation, cut at [`CUT`]: what lasts is
    /// no noise, and no contact of a few seconds.
    strain: Vec<f64>,
    /// What went in of the last blocks, a ring.
    young: Vec<Young>,
    /// Belief at the end of the pass before.
    reference: Vec<f64>,
    residuals: Sizes,
}

/// Least noise of an equation, rad or N·m.
fn least_noise(estimator: &MapEstimator, joint: usize, side: Side) -> f64 {
    match side {
        Side::Link => estimator.noise_floor_rad(),
        Side::Motor => estimator.motor_floor(joint),
    }
}

/// What a block weighed when it came.
#[derive(Debug, Clone)]
struct Young {
    /// Share of its information that counts; 0: none of it went in.
    share: f64,
    /// Information each of its equations went in with.
    information: Vec<f64>,
}

/// The scale of the weight that decides, standard deviations.
const SCALE: f64 = 3.0;
/// The scale the first block is weighed with.
const WIDE: f64 = 40.0;
/// Blocks in which the scale falls to a third.
const FALL: f64 = 10.0;

/// What counts of an innovation at most, standard deviations.
const CUT: f64 = 5.0;
/// Blocks, of those that tell something new, a joint's strain goes back over.
const STRAINED: f64 = 40.0;

/// Weight of a block whose mean normalised square residual is `chi`.
fn redescending(chi: f64, scale: f64) -> f64 {
    let w = scale * scale / (scale * scale + chi);
    w * w
}

/// Whether information is worth changing.
fn differs(now: f64, before: f64) -> bool {
    const SAME: f64 = 0.1;
    (now - before).abs() > SAME * before
}

/// Equations of `block` around the state `around`.
fn linearise(
    estimator: &MapEstimator,
    work: &mut Work,
    block: &Block,
    belief: &Belief,
    around: &[f64],
) {
    estimator.linearise(block, belief.temperature_c, around, &mut work.equations);
    copy(&mut work.origin, around);
}

impl Filter {
    /// A filter that remembers what went in of `young` blocks; allocates here only.
    pub(super) fn new(belief: &Belief, noise: &[Vec<f64>; 2], young: usize) -> Self {
        let equations = noise.iter().map(Vec::len).sum();
        let none = Young {
            share: 0.0,
            information: alloc::vec![0.0; equations],
        };
        Self {
            belief: belief.clone(),
            noise: noise.clone(),
            blocks: 0.0,
            weight: 1.0,
            trust: 1.0,
            strain: alloc::vec![0.0; equations / 2],
            young: alloc::vec![none; young],
            reference: belief.mean.clone(),
            residuals: Sizes::new(equations / 2, young),
        }
    }

    /// Forgets all.
    pub(super) fn restart(&mut self, belief: &Belief, noise: &[Vec<f64>; 2]) {
        self.expect_noise(noise);
        (self.weight, self.trust) = (1.0, 1.0);
        copy(&mut self.belief.mean, &belief.mean);
        self.begin_pass(belief);
    }

    /// Forgets all but noise, and where the pass before ended.
    pub(super) fn begin_pass(&mut self, belief: &Belief) {
        copy(&mut self.reference, &self.belief.mean);
        copy(&mut self.belief.mean, &belief.mean);
        copy(&mut self.belief.covariance, &belief.covariance);
        self.residuals.forget();
        self.blocks = 0.0;
        self.strain.fill(0.0);
        for young in &mut self.young {
            young.share = 0.0;
        }
    }

    pub(super) fn expect_noise(&mut self, noise: &[Vec<f64>; 2]) {
        for (to, from) in self.noise.iter_mut().zip(noise) {
            copy(to, from);
        }
    }

    pub(super) fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Noise of link and motor equations.
    pub(super) fn noise(&self) -> [&[f64]; 2] {
        let [link, motor] = &self.noise;
        [link, motor]
    }

    /// Weight of the last block.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// Whether most blocks of late counted, and agreed.
    pub(super) fn is_trusted(&self) -> bool {
        self.trust > 0.5 && self.most_strained() < 1.0
    }

    /// Whether hardly a block counted for some six seconds, or a joint reads off for as long.
    pub(super) fn is_doubted(&self) -> bool {
        self.trust < 0.25 || self.most_strained() > 2.0
    }

    fn most_strained(&self) -> f64 {
        self.strain.iter().fold(0.0, |most, m| m.abs().max(most))
    }

    fn scale(&self) -> f64 {
        (WIDE * libm::exp(-self.blocks / FALL)).max(SCALE)
    }

    /// Takes a block, and the share of it that counts, for the first time.
    pub(super) fn take(
        &mut self,
        estimator: &MapEstimator,
        work: &mut Work,
        (block, share): (&Block, f64),
        slot: usize,
    ) {
        linearise(estimator, work, block, &self.belief, &self.belief.mean);
        let scale = self.scale();
        self.blocks += 1.0;
        self.project(work);
        let mut chi = 0.0;
        let gains = work.gains.chunks_exact(self.belief.mean.len().max(1));
        for (e, gain) in work.equations.list.iter().zip(gains) {
            let spread = work.equations.dot(e, gain) + self.variance(e);
            chi += e.residual * e.residual / spread;
            self.follow_noise(estimator, e, spread);
            if let (Side::Link, Some(strain)) = (e.side, self.strain.get_mut(e.joint)) {
                let innovation = (e.residual / libm::sqrt(spread)).clamp(-CUT, CUT);
                *strain += share * estimator.inflation() / STRAINED * (innovation - *strain);
            }
        }
        let chi = chi / work.equations.list.len().max(1) as f64;
        self.put_in_first(work, (redescending(chi, scale), share), slot);
    }

    /// Takes a block in a pass over it, weighed against where the pass before ended.
    pub(super) fn repeat(
        &mut self,
        estimator: &MapEstimator,
        work: &mut Work,
        (block, share): (&Block, f64),
        slot: usize,
        scale: f64,
    ) {
        linearise(estimator, work, block, &self.belief, &self.reference);
        let chi = self.chi(work);
        for e in &work.equations.list {
            // What stands says nothing about noise.
            if e.unsure == 0.0 {
                self.residuals.keep(e);
            }
        }
        self.blocks += 1.0;
        if share > 0.0 {
            self.project(work);
        }
        self.put_in_first(work, (redescending(chi, scale), share), slot);
    }

    /// Noise from the residuals of the pass before.
    pub(super) fn find_noise(&mut self, estimator: &MapEstimator) {
        for (side, noises) in [Side::Link, Side::Motor].into_iter().zip(&mut self.noise) {
            for (joint, noise) in noises.iter_mut().enumerate() {
                if let Some(found) = self.residuals.noise(joint, side) {
                    *noise = found.max(least_noise(estimator, joint, side));
                }
            }
        }
    }

    /// What these blocks have against the belief, `Σ ½ m c² χ/(c² + χ) + Σ ln σ`, of `m` equations
    /// each.
    pub(super) fn cost<'a>(
        &self,
        estimator: &MapEstimator,
        work: &mut Work,
        blocks: impl Iterator<Item = (&'a Block, f64)>,
    ) -> f64 {
        let mut cost = 0.0;
        for (block, share) in blocks {
            if share > 0.0 {
                linearise(estimator, work, block, &self.belief, &self.belief.mean);
                let chi = self.chi(work);
                let of_all = SCALE * SCALE * chi / (SCALE * SCALE + chi);
                for e in &work.equations.list {
                    cost += 0.5 * share * (of_all + libm::log(self.variance(e)));
                }
            }
        }
        cost
    }

    /// Mean normalised square of the equations at work.
    fn chi(&self, work: &Work) -> f64 {
        let squares = work.equations.list.iter();
        let sum: f64 = squares
            .map(|e| e.residual * e.residual / self.variance(e))
            .sum();
        sum / work.equations.list.len().max(1) as f64
    }

    /// The equations at work go in for the first time.
    fn put_in_first(&mut self, work: &mut Work, (weight, share): (f64, f64), slot: usize) {
        self.weight = weight;
        self.trust += 0.05 * (weight - self.trust);
        if let Some(young) = self.young.get_mut(slot) {
            young.share = share;
            young.information.fill(0.0);
        }
        if share > 0.0 {
            self.put_in(work, slot, weight * share);
        }
    }

    /// Weighs a block again that went in at `slot`, with what is known by now.
    pub(super) fn again(
        &mut self,
        estimator: &MapEstimator,
        work: &mut Work,
        block: &Block,
        slot: usize,
    ) {
        let Some(young) = self.young.get_mut(slot) else {
            return;
        };
        let share = young.share;
        if !(share > 0.0 && self.is_trusted()) {
            return;
        }
        linearise(estimator, work, block, &self.belief, &self.belief.mean);
        let weight = redescending(self.chi(work), SCALE) * share;
        let young = self.young.get(slot);
        let inside = young.map(|y| y.information.as_slice()).unwrap_or_default();
        let mut pairs = work.equations.list.iter().zip(inside);
        if pairs.any(|(e, before)| differs(weight / self.variance(e), *before)) {
            self.project(work);
            self.put_in(work, slot, weight);
        }
    }

    /// Equations at work, projected, go in with `weight`, less what they went in with before: one
    /// scalar measurement after the other, whose information may be less than nothing. `P` is
    /// written once, after the last.
    fn put_in(&mut self, work: &mut Work, slot: usize, weight: f64) {
        /// Nothing can take back more than is known.
        const LEAST: f64 = 0.5;
        let d = self.belief.mean.len().max(1);
        work.taken.fill(0.0);
        let Work {
            equations,
            origin,
            gains,
            taken,
            ..
        } = work;
        for (k, e) in equations.list.iter().enumerate() {
            let information = weight / self.variance(e);
            let young = self.young.get(slot);
            let Some(before) = young.and_then(|y| y.information.get(k)).copied() else {
                break;
            };
            let (Some((done, open)), Some((taken, open_taken))) = (
                gains.split_at_mut_checked(k * d),
                taken.split_at_mut_checked(k),
            ) else {
                break;
            };
            let (Some(gain), Some(own)) = (open.get_mut(..d), open_taken.first_mut()) else {
                break;
            };
            if !differs(information, before) {
                continue;
            }
            // What those before it have taken off `P`, and moved.
            for (gain_before, taken) in done.chunks_exact(d).zip(taken.iter()) {
                if *taken != 0.0 {
                    let share = taken * equations.dot(e, gain_before);
                    for (g, before) in gain.iter_mut().zip(gain_before) {
                        *g -= share * before;
                    }
                }
            }
            let moved = equations.dot(e, &self.belief.mean) - equations.dot(e, origin);
            let residual = e.residual - moved;
            let more = information - before;
            let left = 1.0 + more * equations.dot(e, gain);
            if !(left > LEAST && left.is_finite()) {
                continue;
            }
            *own = more / left;
            for (x, g) in self.belief.mean.iter_mut().zip(gain.iter()) {
                *x += g * residual * *own;
            }
            let young = self.young.get_mut(slot);
            if let Some(inside) = young.and_then(|y| y.information.get_mut(k)) {
                *inside = information;
            }
        }
        self.take_off(gains, taken);
    }

    /// `P ← P − Σ taken P hᵀ h P`, four at a time: a row of `P` is read and written once for four.
    fn take_off(&mut self, gains: &[f64], taken: &[f64]) {
        const FOUR: usize = 4;
        let d = self.belief.mean.len().max(1);
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
            let rows = self.belief.covariance.chunks_exact_mut(d);
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
            let rows = self.belief.covariance.chunks_exact_mut(d);
            for (line, own) in rows.zip(gain) {
                let scaled = own * taken;
                for (p, g) in line.iter_mut().zip(gain) {
                    *p -= scaled * g;
                }
            }
        }
    }

    fn variance(&self, e: &Equation) -> f64 {
        let [link, motor] = &self.noise;
        let noise = match e.side {
            Side::Link => link.get(e.joint),
            Side::Motor => motor.get(e.joint),
        };
        let noise = noise.copied().unwrap_or(1.0);
        noise * noise + e.unsure * e.unsure
    }

    /// `P hᵀ` of the equations at work.
    fn project(&self, work: &mut Work) {
        let d = self.belief.mean.len().max(1);
        let layout = work.equations.layout();
        let lines = |range: Range<usize>| {
            let lines = self.belief.covariance.get(range.start * d..range.end * d);
            lines.unwrap_or_default().chunks_exact(d)
        };
        let add = |to: &mut [f64], factor: f64, line: &[f64]| {
            for (to, p) in to.iter_mut().zip(line) {
                *to += factor * p;
            }
        };
        let mut at_work = None;
        let gains = work.gains.chunks_exact_mut(d);
        for (e, gain) in work.equations.list.iter().zip(gains) {
            // Link and motor row of a joint are the same over bodies and load, but for their worth.
            if at_work != Some(e.joint) {
                at_work = Some(e.joint);
                work.carried.fill(0.0);
                let carried = work.equations.carried(e.joint);
                for (value, line) in carried.iter().zip(lines(layout.carried())) {
                    if *value != 0.0 {
                        add(&mut work.carried, *value, line);
                    }
                }
            }
            gain.fill(0.0);
            add(gain, e.worth, &work.carried);
            for (value, line) in e.own.iter().zip(lines(layout.own(e.joint))) {
                if *value != 0.0 {
                    add(gain, *value, line);
                }
            }
        }
    }

    /// The noise moves towards the median of the innovations that are mostly noise.
    fn follow_noise(&mut self, estimator: &MapEstimator, e: &Equation, spread: f64) {
        /// The step falls to a tenth of the first, so that the noise settles.
        const STEP: f64 = 0.03;
        const SETTLED: f64 = 0.003;
        let step = (STEP / (1.0 + 0.02 * self.blocks)).max(SETTLED);
        const MEDIAN: f64 = 0.6745;
        let variance = self.variance(e);
        if e.unsure > 0.0 || variance < 0.5 * spread {
            return;
        }
        let floor = least_noise(estimator, e.joint, e.side);
        let [link, motor] = &mut self.noise;
        let noise = match e.side {
            Side::Link => link.get_mut(e.joint),
            Side::Motor => motor.get_mut(e.joint),
        };
        if let Some(noise) = noise {
            let above = e.residual * e.residual > MEDIAN * MEDIAN * spread;
            let factor = if above { 1.0 + step } else { 1.0 - step };
            *noise = (*noise * factor).max(floor);
        }
    }
}
