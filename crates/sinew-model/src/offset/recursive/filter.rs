//! One Kalman filter over blocks, which [`super::RecursiveOffsets`] may run two of.

use super::force::ForceBelief;
use super::ring::{KeptBlock, SEGMENT};
use super::robust_noise::ResidualSizes;
use super::workspace::{Workspace, bands, downdate};
use crate::Gaussian;
use crate::offset::belief::Belief;
use crate::offset::block::copy;
use crate::offset::equations::equation::{Equation, Side};
use crate::offset::equations::estimation_model::EstimationModel;
use crate::offset::equations::robust::redescending_weight;
use alloc::vec::Vec;
use core::ops::Range;

/// Belief, noise, and how well the blocks have agreed with it.
#[derive(Debug, Clone)]
pub(super) struct Filter {
    /// The offsets are those at [`Filter::at_s`], and their rates come last.
    belief: Belief,
    /// Joints that creep: where their offsets are.
    creeps: Vec<usize>,
    /// What is known of a force from outside; `None`: none is looked for.
    force: Option<ForceBelief>,
    /// Time of the last block that came, s; NaN: none has.
    at_s: f64,
    /// Noise of link and motor equations.
    noise: [Vec<f64>; 2],
    /// Size of each joint's link innovations of late, rad: unlike the noise it never settles.
    unexplained_rad: Vec<f64>,
    blocks: f64,
    weight: f64,
    /// Mean weight of the last blocks: a filter that leaves most out is no judge of the others.
    mean_weight: f64,
    /// Mean normalised innovation of late of each joint's link equation, cut at [`INNOVATION_MAX`]: what lasts is
    /// no noise, and no contact of a few seconds.
    mean_innovation: Vec<f64>,
    /// The same by the blocks' weights: what goes in should be off by nothing in the mean, and contacts don't count.
    bias: Vec<f64>,
    /// What went in of the last blocks, a ring.
    recent: Vec<RecentBlock>,
    /// Belief at the end of the pass before.
    reference: Vec<f64>,
    residuals: ResidualSizes,
    /// Whether blocks are weighed only: none goes in.
    is_held: bool,
}

/// Least noise of an equation, rad or N·m.
fn least_noise(model: &EstimationModel, joint: usize, side: Side) -> f64 {
    match side {
        Side::Link => model.noise_floor_rad,
        Side::Motor => model.motor_floor(joint),
    }
}

/// What a block weighed when it came.
#[derive(Debug, Clone)]
struct RecentBlock {
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
const INNOVATION_MAX: f64 = 5.0;
/// Memory of the mean innovation, in blocks that carry new information.
const INNOVATION_MEMORY: f64 = 40.0;
/// The same while nothing goes in: what is asked is whether it agrees again.
const HELD_MEMORY: f64 = 15.0;

/// What goes in is off by more in the mean, standard deviations. Where nothing slips it is off by more than 0.7 in 0.2 % of the time at most
/// (S5, S7, S8, S9). Filters that had taken a second slip in four poses for lost stiffness were off by 0.7 to 1.1.
const BIASED: f64 = 0.8;
/// It agrees again below this.
const UNBIASED: f64 = 0.7;

fn largest(means: &[f64]) -> f64 {
    means.iter().fold(0.0, |most, m| m.abs().max(most))
}

/// Whether information is worth changing.
fn differs(now: f64, before: f64) -> bool {
    const SAME: f64 = 0.1;
    (now - before).abs() > SAME * before
}

impl Filter {
    /// A filter that remembers what went in of `recent` blocks; allocates here only.
    pub(super) fn new(
        (belief, creeps): (&Belief, &[usize]),
        force: Option<ForceBelief>,
        noise: &[Vec<f64>; 2],
        recent: usize,
    ) -> Self {
        let equations = noise.iter().map(Vec::len).sum();
        let none = RecentBlock {
            share: 0.0,
            information: alloc::vec![0.0; equations],
        };
        let mut made = Self {
            belief: belief.clone(),
            creeps: creeps.to_vec(),
            force,
            at_s: f64::NAN,
            noise: noise.clone(),
            unexplained_rad: noise[0].clone(),
            blocks: 0.0,
            weight: 1.0,
            mean_weight: 1.0,
            mean_innovation: alloc::vec![0.0; equations / 2],
            bias: alloc::vec![0.0; equations / 2],
            recent: alloc::vec![none; recent],
            reference: belief.mean.clone(),
            residuals: ResidualSizes::new(equations / 2, recent),
            is_held: false,
        };
        made.settle();
        made
    }

    /// Forgets all; the offsets will be those at `at_s`.
    pub(super) fn restart(&mut self, belief: &Belief, noise: &[Vec<f64>; 2], at_s: f64) {
        self.at_s = at_s;
        self.expect_noise(noise);
        (self.weight, self.mean_weight) = (1.0, 1.0);
        copy(&mut self.belief.mean, &belief.mean);
        copy(&mut self.belief.covariance, &belief.covariance);
        if let Some(force) = &mut self.force {
            force.restart();
        }
        self.settle();
        self.begin_pass(belief);
    }

    /// From now on it knows what `other` does, and what of the last blocks went in; how they agreed stays. O(d²).
    pub(super) fn know_as(&mut self, other: &Self) {
        copy(&mut self.belief.mean, &other.belief.mean);
        copy(&mut self.belief.covariance, &other.belief.covariance);
        self.belief.temperature_c = other.belief.temperature_c;
        self.at_s = other.at_s;
        self.blocks = other.blocks;
        for (to, from) in self.noise.iter_mut().zip(&other.noise) {
            copy(to, from);
        }
        copy(&mut self.unexplained_rad, &other.unexplained_rad);
        if let Some((to, from)) = self.force.as_mut().zip(other.force.as_ref()) {
            to.know_as(from);
        }
        for (to, from) in self.recent.iter_mut().zip(&other.recent) {
            to.share = from.share;
            copy(&mut to.information, &from.information);
        }
    }

    /// Agreement that can't be told is none.
    pub(super) fn doubt_what_is_not_finite(&mut self) {
        let innovations = self.mean_innovation.iter_mut().chain(&mut self.bias);
        for (value, none) in core::iter::once((&mut self.mean_weight, 0.0))
            .chain(innovations.map(|m| (m, INNOVATION_MAX)))
        {
            if !value.is_finite() {
                *value = none;
            }
        }
    }

    /// Nothing of the blocks at these slots went in.
    pub(super) fn leave_out(&mut self, slots: impl Iterator<Item = usize>) {
        for slot in slots {
            if let Some(recent) = self.recent.get_mut(slot) {
                recent.share = 0.0;
            }
        }
    }

    /// Whether blocks are only weighed from now on: nothing of them goes in.
    pub(super) fn hold(&mut self, is_held: bool) {
        self.is_held = is_held;
    }

    /// The offsets are taken for those at `at_s`.
    pub(super) fn refer_to(&mut self, at_s: f64) {
        self.at_s = at_s;
    }

    /// Offsets may have jumped, `0 ± jump_rad` each, compliances by `0 ± softer`, and what is held by as much as it was unknown at the
    /// `start`.
    pub(super) fn open(
        &mut self,
        (start, payload): (&Belief, Range<usize>),
        jump_rad: f64,
        (compliances, softer): (&[usize], f64),
    ) {
        let d = self.belief.mean.len();
        let offsets = self.creeps.iter().map(|offset| (offset, jump_rad));
        let compliances = compliances.iter().map(|compliance| (compliance, softer));
        for (place, deviation) in offsets.chain(compliances) {
            if let Some(p) = self.belief.covariance.get_mut(place * (d + 1)) {
                *p += deviation * deviation;
            }
        }
        for row in payload.clone() {
            let own = row * d + payload.start..row * d + payload.end;
            let unknown = start.covariance.get(own.clone()).unwrap_or_default();
            let known = self.belief.covariance.get_mut(own).unwrap_or_default();
            for (p, more) in known.iter_mut().zip(unknown) {
                *p += more;
            }
        }
        self.settle();
    }

    /// Forgets all but noise, and where the pass before ended.
    pub(super) fn begin_pass(&mut self, belief: &Belief) {
        let point = self.force.as_ref().map(ForceBelief::point);
        copy(&mut self.reference, point.unwrap_or(&self.belief.mean));
        copy(&mut self.belief.mean, &belief.mean);
        copy(&mut self.belief.covariance, &belief.covariance);
        self.settle();
        self.residuals.clear();
        self.blocks = 0.0;
        self.mean_innovation.fill(0.0);
        self.bias.fill(0.0);
        for recent in &mut self.recent {
            recent.share = 0.0;
        }
    }

    pub(super) fn expect_noise(&mut self, noise: &[Vec<f64>; 2]) {
        for (to, from) in self.noise.iter_mut().zip(noise) {
            copy(to, from);
        }
        let [link, _] = noise;
        copy(&mut self.unexplained_rad, link);
    }

    pub(super) fn belief(&self) -> &Belief {
        &self.belief
    }

    pub(super) fn belief_mut(&mut self) -> &mut Belief {
        &mut self.belief
    }

    /// What is known of a force from outside; `None`: none is looked for.
    pub(super) fn force(&self) -> Option<&ForceBelief> {
        self.force.as_ref()
    }

    /// An entry of the posterior that blocks are weighed at.
    pub(super) fn entry(&self, place: usize) -> Gaussian {
        match &self.force {
            Some(force) => force.entry(&self.belief, place),
            None => self.belief.entry(place),
        }
    }

    /// The state that blocks are weighed at.
    fn point(&self) -> &[f64] {
        let point = self.force.as_ref().map(ForceBelief::point);
        point.unwrap_or(&self.belief.mean)
    }

    /// The belief has changed.
    fn settle(&mut self) {
        if let Some(force) = &mut self.force {
            force.settle(&self.belief);
        }
    }

    /// Whether a force acts, by what is known now, of an arm that was in one pose for such a share of the time; `at_once`: all blocks
    /// of a pass say so.
    pub(super) fn judge_force(&mut self, model: &EstimationModel, in_one_pose: f64, at_once: bool) {
        let Some((force, model)) = self.force.as_mut().zip(model.force.as_ref()) else {
            return;
        };
        force.judge(model, &self.belief, in_one_pose);
        if self.blocks >= SEGMENT as f64 {
            force.decide(at_once);
            force.settle(&self.belief);
        }
    }

    /// Noise of link and motor equations.
    pub(super) fn noise(&self) -> [&[f64]; 2] {
        let [link, motor] = &self.noise;
        [link, motor]
    }

    /// What is left of late of a joint's link equation, robust standard deviation, rad.
    pub(super) fn unexplained_rad(&self, joint: usize) -> f64 {
        self.unexplained_rad.get(joint).copied().unwrap_or_default()
    }

    /// Weight of the last block.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// Whether most blocks of late counted, and agreed.
    pub(super) fn is_consistent(&self) -> bool {
        self.mean_weight > 0.5 && largest(&self.mean_innovation) < 1.0
    }

    /// Whether hardly a block counted for some six seconds, or a joint reads off for as long.
    pub(super) fn is_inconsistent(&self) -> bool {
        self.mean_weight < 0.25 || largest(&self.mean_innovation) > 2.0
    }

    /// Whether what goes in is off in the mean.
    pub(super) fn is_biased(&self) -> bool {
        largest(&self.bias) > BIASED
    }

    /// Whether it no longer is.
    pub(super) fn is_unbiased(&self) -> bool {
        largest(&self.bias) < UNBIASED
    }

    /// From now on the offsets are those at the time of a block that comes.
    ///
    /// ```text
    /// x ← F x,   P ← F P Fᵀ,   F: offset ← offset + rate (t − t₀)
    /// ```
    pub(super) fn go_on(&mut self, time_s: f64) {
        let passed_s = time_s - self.at_s;
        self.at_s = time_s;
        if !(passed_s > 0.0 && passed_s.is_finite()) {
            return;
        }
        let d = self.belief.mean.len();
        let first = d.saturating_sub(self.creeps.len());
        for (k, &offset) in self.creeps.iter().enumerate() {
            let rate = first + k;
            let at = |x: &[f64], place: usize| x.get(place).copied().unwrap_or_default();
            let moved = passed_s * at(&self.belief.mean, rate);
            if let Some(x) = self.belief.mean.get_mut(offset) {
                *x += moved;
            }
            // A row, then a column.
            let p = &mut self.belief.covariance;
            for column in 0..d {
                let more = passed_s * at(p, rate * d + column);
                if let Some(to) = p.get_mut(offset * d + column) {
                    *to += more;
                }
            }
            for row in p.chunks_exact_mut(d.max(1)) {
                let more = passed_s * at(row, rate);
                if let Some(to) = row.get_mut(offset) {
                    *to += more;
                }
            }
        }
        self.settle();
    }

    /// Equations of a block around what is known.
    pub(super) fn linearise(
        &self,
        model: &EstimationModel,
        work: &mut Workspace,
        kept: &KeptBlock,
    ) {
        let known = (self.point(), self.at_s);
        work.linearise(model, kept, self.belief.temperature_c, known);
    }

    fn scale(&self) -> f64 {
        (WIDE * libm::exp(-self.blocks / FALL)).max(SCALE)
    }

    /// The scale a block is weighed with that comes now: one block more.
    pub(super) fn begin_update(&mut self) -> f64 {
        let scale = self.scale();
        self.blocks += 1.0;
        scale
    }

    /// Weight of the projected equations at work of a block that comes for the first time; noise and innovations follow
    /// them, and what surprises is worth less than its noise.
    pub(super) fn weigh_new(
        &mut self,
        model: &EstimationModel,
        work: &mut Workspace,
        (share, scale): (f64, f64),
    ) -> f64 {
        let memory = if self.is_held {
            HELD_MEMORY
        } else {
            INNOVATION_MEMORY
        };
        let step = share * model.inflation / memory;
        let cut = |x: f64| x.clamp(-INNOVATION_MAX, INNOVATION_MAX);
        let mut chi = 0.0;
        let gains = work.gains.chunks_exact(self.belief.mean.len().max(1));
        let equations = work.equations.list.iter().zip(gains);
        for ((e, gain), surprising) in equations.zip(&mut work.surprising) {
            let of_force = self.force.as_ref().map_or(0.0, |f| f.added_variance(gain));
            let known = work.equations.dot(e, gain) - of_force;
            *surprising = known.max(0.0);
            let spread = known + self.variance(e);
            chi += e.residual * e.residual / spread;
            self.follow_noise(model, e, spread);
            if let (Side::Link, Some(mean)) = (e.side, self.mean_innovation.get_mut(e.joint)) {
                *mean += step * (cut(e.residual / libm::sqrt(spread)) - *mean);
            }
        }
        let chi = chi / work.equations.list.len().max(1) as f64;
        let weight = redescending_weight(chi, scale);
        for (e, surprising) in work.equations.list.iter().zip(&mut work.surprising) {
            let spread = *surprising + self.variance(e);
            if let (Side::Link, Some(bias)) = (e.side, self.bias.get_mut(e.joint)) {
                *bias += weight * step * (cut(e.residual / libm::sqrt(spread)) - *bias);
            }
            *surprising *= 1.0 - weight;
        }
        weight
    }

    /// Equations of a block in a pass over it, around where the pass before ended; returns its weight.
    pub(super) fn weigh_in_pass(
        &mut self,
        model: &EstimationModel,
        work: &mut Workspace,
        kept: &KeptBlock,
        scale: f64,
    ) -> f64 {
        let around = (self.reference.as_slice(), self.at_s);
        work.linearise(model, kept, self.belief.temperature_c, around);
        let chi = self.chi(work);
        for e in &work.equations.list {
            // What stands says nothing about noise.
            if e.added_deviation == 0.0 {
                self.residuals.keep(e);
            }
        }
        self.blocks += 1.0;
        redescending_weight(chi, scale)
    }

    /// Noise from the residuals of the pass before.
    pub(super) fn find_noise(&mut self, model: &EstimationModel) {
        for (side, noises) in [Side::Link, Side::Motor].into_iter().zip(&mut self.noise) {
            for (joint, noise) in noises.iter_mut().enumerate() {
                if let Some(found) = self.residuals.noise(joint, side) {
                    *noise = found.max(least_noise(model, joint, side));
                }
            }
        }
    }

    /// Adds the cost of a block, `½ m c² χ/(c² + χ) + Σ ln σ`, of `m` equations.
    pub(super) fn add_cost(
        &self,
        model: &EstimationModel,
        work: &mut Workspace,
        kept: &KeptBlock,
        cost: &mut f64,
    ) {
        self.linearise(model, work, kept);
        let chi = self.chi(work);
        let of_all = SCALE * SCALE * chi / (SCALE * SCALE + chi);
        for e in &work.equations.list {
            *cost += 0.5 * kept.share * (of_all + libm::log(self.variance(e)));
        }
    }

    /// Mean normalised square of the equations at work.
    fn chi(&self, work: &Workspace) -> f64 {
        let squares = work.equations.list.iter();
        let sum: f64 = squares
            .map(|e| e.residual * e.residual / self.variance(e))
            .sum();
        sum / work.equations.list.len().max(1) as f64
    }

    /// A block of this weight goes in for the first time; whether it has anything to say.
    pub(super) fn note_new(&mut self, (weight, share): (f64, f64), slot: usize) -> bool {
        self.weight = weight;
        self.mean_weight += 0.05 * (weight - self.mean_weight);
        let share = if self.is_held { 0.0 } else { share };
        if let Some(recent) = self.recent.get_mut(slot) {
            recent.share = share;
            recent.information.fill(0.0);
        }
        share > 0.0
    }

    /// Weighs a block again that went in at `slot`, with what is known by now: the weight of its equations, which are at work;
    /// `None` where that isn't worth a change.
    pub(super) fn weigh_again(
        &mut self,
        model: &EstimationModel,
        work: &mut Workspace,
        kept: &KeptBlock,
        slot: usize,
    ) -> Option<f64> {
        let share = self.recent.get(slot)?.share;
        if !(share > 0.0 && self.is_consistent()) {
            return None;
        }
        self.linearise(model, work, kept);
        let weight = redescending_weight(self.chi(work), SCALE) * share;
        let inside = self.recent.get(slot)?.information.as_slice();
        let mut pairs = work.equations.list.iter().zip(inside);
        let changes = pairs.any(|(e, before)| differs(weight / self.variance(e), *before));
        changes.then_some(weight)
    }

    /// One of the equations at work, projected, goes in with `weight`, less what it went in with before: a scalar
    /// measurement, whose information may be less than nothing. `P` is written once, after the last.
    pub(super) fn insert(&mut self, work: &mut Workspace, slot: usize, k: usize, weight: f64) {
        /// Nothing can take back more than is known, force or none.
        const LEAST: f64 = 0.5;
        const LEAST_WITH_FORCE: f64 = 0.1;
        let d = self.belief.mean.len().max(1);
        let Workspace {
            equations,
            origin,
            gains,
            taken,
            surprising,
            ..
        } = work;
        let Some((e, surprising)) = equations.list.get(k).zip(surprising.get(k)) else {
            return;
        };
        let information = weight / (self.variance(e) + surprising);
        let recent = self.recent.get(slot);
        let Some(before) = recent.and_then(|y| y.information.get(k)).copied() else {
            return;
        };
        let (Some((done, open)), Some((taken, open_taken))) = (
            gains.split_at_mut_checked(k * d),
            taken.split_at_mut_checked(k),
        ) else {
            return;
        };
        let (Some(gain), Some(own)) = (open.get_mut(..d), open_taken.first_mut()) else {
            return;
        };
        if !differs(information, before) {
            return;
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
        let of_force = self.force.as_ref().map_or(0.0, |f| f.added_variance(gain));
        let is_known = left - more * of_force > LEAST && left > LEAST_WITH_FORCE;
        if !(is_known && left.is_finite()) {
            return;
        }
        *own = more / left;
        for (x, g) in self.belief.mean.iter_mut().zip(gain.iter()) {
            *x += g * residual * *own;
        }
        let recent = self.recent.get_mut(slot);
        if let Some(inside) = recent.and_then(|y| y.information.get_mut(k)) {
            *inside = information;
        }
    }

    /// A band of `P` falls by what went in.
    pub(super) fn downdate(&mut self, work: &Workspace, band: usize) {
        downdate(&mut self.belief, (&work.gains, &work.taken), band);
        if band + 1 == bands(self.belief.mean.len()) {
            self.settle();
        }
    }

    fn variance(&self, e: &Equation) -> f64 {
        let [link, motor] = &self.noise;
        let noise = match e.side {
            Side::Link => link.get(e.joint),
            Side::Motor => motor.get(e.joint),
        };
        let noise = noise.copied().unwrap_or(1.0);
        noise * noise + e.added_deviation * e.added_deviation
    }

    /// The noise moves towards the median of the innovations that are mostly noise.
    fn follow_noise(&mut self, model: &EstimationModel, e: &Equation, spread: f64) {
        /// The step falls to a tenth of the first, so that the noise settles.
        const STEP: f64 = 0.03;
        const SETTLED: f64 = 0.003;
        let step = (STEP / (1.0 + 0.02 * self.blocks)).max(SETTLED);
        const MEDIAN: f64 = 0.6745;
        let variance = self.variance(e);
        if e.added_deviation > 0.0 || variance < 0.5 * spread {
            return;
        }
        let floor = least_noise(model, e.joint, e.side);
        if let (Side::Link, Some(size)) = (e.side, self.unexplained_rad.get_mut(e.joint)) {
            let above = e.residual.abs() > MEDIAN * *size;
            let factor = if above { 1.0 + STEP } else { 1.0 - STEP };
            *size = (*size * factor).max(floor);
        }
        if self.is_held {
            return;
        }
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
