//! Whether it was the rope or an encoder: which reading jumped, and how fast.
//!
//! From positions alone a slip of the rope and one of an encoder are the same step of
//! `theta − q` at every torque. The moment itself tells them apart. Masses can't jump: when a rope
//! slips by `Δ`, the spring's torque drops by `K Δ` at once and both ends follow with finite
//! accelerations, so that within one sample `h` no reading moves by more than
//!
//! ```text
//! 1.4 K Δ h² max(1/J, (M⁻¹)ᵢᵢ)          (J: motor, M: mass matrix of the arm)
//! ```
//!
//! beyond its course. A reading that moves by all of `Δ` between two samples has itself slipped;
//! a joint's encoder does so downwards. The jump of a reading `x` between two samples is measured
//! against a line through the four samples on either side (least squares; a common curvature
//! cancels),
//!
//! ```text
//! s = Σₖ wₖ (x₊ₖ − x₋ₖ),     w = 0.85, 0.45, 0.05, −0.35
//! ```
//!
//! and compared with what noise and quantisation do every second. Where that is too much, where
//! samples are missing, or the arm is too quick for the rate of the recording, it can't be told.
//! An encoder that creeps over tens of milliseconds looks like a rope.

use crate::cause::{Cause, UnknownCause};
use sinew_model::Gaussian;
use sinew_model::arm::{Arm, ArmWorkspace};
use std::ops::Range;

/// Samples on either side of a jump.
const SIDE: usize = 4;
/// `w`, the oldest sample first.
const WEIGHTS: [f64; 2 * SIDE] = [0.35, -0.05, -0.45, -0.85, 0.85, 0.45, 0.05, -0.35];
/// Over this time the largest jump is kept, s.
const SLOT_S: f64 = 1.0;
/// A found change's moment is known to this, s.
const WITHIN_S: f64 = 2.5;
/// A jump counts from so many times on what is usual.
const CLEAR: f64 = 3.0;
/// Samples whose distance differs by more than this share of it can't be compared.
const UNEVEN: f64 = 0.5;

/// The largest jump of a reading in a slot of time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Jump {
    time_s: f64,
    size_rad: f64,
}

/// The jumps of a recording's readings, sample by sample. Memory: `32 n` bytes a second.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Jumps {
    joints: usize,
    /// How many of the last samples came one after the other.
    samples: usize,
    /// The last `2 SIDE` of every reading, motor readings first, the oldest sample first.
    readings: Vec<[f64; 2 * SIDE]>,
    times: [f64; 2 * SIDE],
    /// When slots of time began, s.
    slots_s: Vec<f64>,
    /// The largest jump of every reading in every slot: motor readings, then joint readings, `2 n` a slot.
    largest: Vec<Jump>,
    /// When samples were missing or came unevenly, s.
    blind: Vec<[f64; 2]>,
    /// Sum and number of the samples' distances, s.
    sum_s: f64,
    steps: u64,
    last_s: Option<f64>,
}

impl Jumps {
    /// For an arm of `joints`.
    pub fn new(joints: usize) -> Self {
        Self {
            joints,
            readings: vec![[0.0; 2 * SIDE]; 2 * joints],
            ..Self::default()
        }
    }

    /// Room for so many seconds: taking them allocates nothing.
    pub fn reserve(&mut self, duration_s: f64) {
        let slots = (duration_s / SLOT_S).ceil().max(0.0) as usize + 1;
        self.slots_s.reserve(slots);
        self.largest.reserve(2 * self.joints * slots);
        // Two are at least a tenth of a second apart.
        self.blind.reserve(10 * slots);
    }

    /// Forgets all but the room.
    pub fn clear(&mut self) {
        self.slots_s.clear();
        self.largest.clear();
        self.blind.clear();
        (self.samples, self.sum_s, self.steps, self.last_s) = (0, 0.0, 0, None);
    }

    /// Goes on where `before` ended: the last samples, and the slot of time under way.
    ///
    /// # Realtime
    /// No allocation where there is [room](Jumps::reserve), lock, panic or clock.
    pub(crate) fn go_on_from(&mut self, before: &mut Self) {
        self.clear();
        self.joints = before.joints;
        std::mem::swap(&mut self.readings, &mut before.readings);
        (self.samples, self.times) = (before.samples, before.times);
        (self.sum_s, self.steps, self.last_s) = (before.sum_s, before.steps, before.last_s);
        if let Some(slot_s) = before.slots_s.last() {
            self.slots_s.push(*slot_s);
            self.largest.resize(2 * self.joints, Jump::default());
        }
    }

    /// Appends what [goes on](Jumps::go_on_from) from here.
    pub(crate) fn append(&mut self, next: &Self) {
        let width = 2 * self.joints;
        let mut largest = next.largest.as_slice();
        let mut slots_s = next.slots_s.as_slice();
        if let (Some(last), Some((first, more))) = (self.slots_s.last(), slots_s.split_first())
            && last == first
        {
            let (own, rest) = largest.split_at(width);
            let from = self.largest.len() - width;
            for (known, jump) in self.largest[from..].iter_mut().zip(own) {
                if jump.size_rad.abs() > known.size_rad.abs() {
                    *known = *jump;
                }
            }
            (slots_s, largest) = (more, rest);
        }
        self.slots_s.extend_from_slice(slots_s);
        self.largest.extend_from_slice(largest);
        for [from_s, to_s] in &next.blind {
            self.mark_blind(*from_s, *to_s);
        }
        (self.sum_s, self.steps, self.last_s) = (next.sum_s, next.steps, next.last_s);
    }

    /// Appends slots and gaps of `from` that ended after a time, s, or are under way, `by_s` later on another clock. Those there are already
    /// are brought up to date.
    ///
    /// # Realtime
    /// No allocation where there is [room](Jumps::reserve), lock, panic or clock.
    pub(crate) fn append_since(&mut self, from: &Self, since_s: f64, by_s: f64) {
        let width = 2 * self.joints;
        let slots = from
            .slots_s
            .iter()
            .zip(from.largest.chunks_exact(width.max(1)));
        for (slot_s, own) in slots.filter(|(slot_s, _)| **slot_s + SLOT_S > since_s) {
            let slot_s = slot_s + by_s;
            if self.slots_s.last() != Some(&slot_s) {
                self.slots_s.push(slot_s);
                let length = self.largest.len() + width;
                self.largest.resize(length, Jump::default());
            }
            let at = self.largest.len() - width;
            for (known, jump) in self.largest[at..].iter_mut().zip(own) {
                if jump.size_rad.abs() > known.size_rad.abs() {
                    *known = Jump {
                        time_s: jump.time_s + by_s,
                        ..*jump
                    };
                }
            }
        }
        for [from_s, to_s] in from.blind.iter().filter(|[_, to_s]| *to_s > since_s) {
            self.mark_blind(from_s + by_s, to_s + by_s);
        }
        (self.sum_s, self.steps) = (from.sum_s, from.steps);
        self.last_s = from.last_s.map(|last_s| last_s + by_s);
    }

    /// Whether another slot and another gap have [room](Jumps::reserve).
    pub(crate) fn has_room(&self) -> bool {
        let fits = |length: usize, more: usize, capacity: usize| length + more <= capacity;
        fits(self.slots_s.len(), 1, self.slots_s.capacity())
            && fits(self.largest.len(), 2 * self.joints, self.largest.capacity())
            && fits(self.blind.len(), 1, self.blind.capacity())
    }

    /// Forgets slots and gaps that lie within a time, s.
    pub(crate) fn forget_within(&mut self, time_s: Range<f64>) {
        let is_within = |from_s: f64, to_s: f64| from_s >= time_s.start && to_s < time_s.end;
        let width = 2 * self.joints;
        let slots = std::mem::take(&mut self.slots_s);
        let kept = slots.iter().enumerate();
        let kept: Vec<usize> = kept
            .filter(|(_, from_s)| !is_within(**from_s, **from_s + SLOT_S))
            .map(|(k, _)| k)
            .collect();
        if kept.len() < slots.len() {
            let own = |k: &usize| self.largest[k * width..(k + 1) * width].iter().copied();
            self.largest = kept.iter().flat_map(own).collect();
        }
        self.slots_s = kept.iter().map(|k| slots[*k]).collect();
        self.blind
            .retain(|[from_s, to_s]| !is_within(*from_s, *to_s));
    }

    /// Forgets slots and gaps that ended before a time, s.
    pub(crate) fn forget_before(&mut self, time_s: f64) {
        let over = self
            .slots_s
            .partition_point(|from_s| from_s + SLOT_S < time_s);
        self.slots_s.drain(..over);
        self.largest.drain(..over * 2 * self.joints);
        self.blind.retain(|[_, to_s]| *to_s >= time_s);
    }

    /// Slots that ended after one time and up to another, s, and gaps alike.
    pub(crate) fn between(&self, from_s: f64, to_s: f64) -> Self {
        let range = from_s..to_s;
        let slots = || {
            let ended = |(_, slot_s): &(usize, &f64)| range.contains(&(**slot_s + SLOT_S));
            self.slots_s.iter().enumerate().filter(ended)
        };
        let width = 2 * self.joints;
        Self {
            slots_s: slots().map(|(_, slot_s)| *slot_s).collect(),
            largest: slots()
                .flat_map(|(k, _)| self.largest[k * width..(k + 1) * width].iter().copied())
                .collect(),
            blind: (self.blind.iter().copied())
                .filter(|[_, to_s]| range.contains(to_s))
                .collect(),
            readings: self.readings.clone(),
            ..*self
        }
    }

    /// Takes a sample at `time_s`: motor and joint readings, rad.
    pub fn push(&mut self, time_s: f64, theta: &[f64], q: &[f64]) {
        if let Some(last_s) = self.last_s {
            let step_s = time_s - last_s;
            let usual_s = self.step_s();
            if self.steps > 20 && (step_s - usual_s).abs() > UNEVEN * usual_s {
                self.mark_blind(last_s, time_s);
                self.samples = 0;
            }
            // A gap is no step.
            if step_s > 0.0 && (self.steps < 20 || step_s < 10.0 * usual_s) {
                self.sum_s += step_s;
                self.steps += 1;
            }
        }
        self.last_s = Some(time_s);
        let next = |kept: &mut [f64; 2 * SIDE], newest: f64| {
            kept.copy_within(1.., 0);
            kept[2 * SIDE - 1] = newest;
        };
        next(&mut self.times, time_s);
        for (reading, x) in self.readings.iter_mut().zip(theta.iter().chain(q)) {
            next(reading, *x);
        }
        self.samples += 1;
        if self.samples >= 2 * SIDE {
            self.measure();
        }
    }

    fn measure(&mut self) {
        let time_s = 0.5 * (self.times[SIDE - 1] + self.times[SIDE]);
        let width = 2 * self.joints;
        let is_over = |from_s: &f64| time_s >= from_s + SLOT_S;
        if self.slots_s.last().is_none_or(is_over) {
            self.slots_s.push(time_s);
            let length = self.largest.len() + width;
            self.largest.resize(length, Jump::default());
        }
        let from = self.largest.len() - width;
        for (largest, reading) in self.largest[from..].iter_mut().zip(&self.readings) {
            let size_rad: f64 = WEIGHTS.iter().zip(reading).map(|(w, x)| w * x).sum();
            if size_rad.abs() > largest.size_rad.abs() {
                *largest = Jump { time_s, size_rad };
            }
        }
    }

    fn mark_blind(&mut self, from_s: f64, to_s: f64) {
        match self.blind.last_mut() {
            Some(last) if from_s - last[1] < 0.1 => last[1] = to_s,
            _ => self.blind.push([from_s, to_s]),
        }
    }

    /// Mean distance of samples, s.
    fn step_s(&self) -> f64 {
        self.sum_s / self.steps.max(1) as f64
    }

    /// What noise, quantisation and motion usually make in a second, rad: the upper quartile.
    fn usual_rad(&self, reading: usize) -> f64 {
        let jumps = self.jumps(reading);
        let mut sizes: Vec<f64> = jumps.map(|j| j.size_rad.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
            .get(3 * sizes.len() / 4)
            .copied()
            .unwrap_or(f64::INFINITY)
    }

    /// A jump of `size_rad`, to `unsure_rad`, of a reading around `at_s`.
    fn jumped(&self, reading: usize, at_s: f64, size_rad: f64, unsure_rad: f64) -> bool {
        self.jumps(reading).any(|j| {
            (j.time_s - at_s).abs() < WITHIN_S && (j.size_rad - size_rad).abs() < unsure_rad
        })
    }

    /// The largest jumps of a reading, slot by slot.
    fn jumps(&self, reading: usize) -> impl Iterator<Item = &Jump> {
        let slots = self.largest.chunks_exact((2 * self.joints).max(1));
        slots.filter_map(move |slot| slot.get(reading))
    }

    /// What made the offset of a joint change by `change_rad` around `at_s`.
    ///
    /// `quickness`: acceleration per deflection of the joint's spring, `K max(1/J, (M⁻¹)ᵢᵢ)`,
    /// 1/s² (see [`quickness`]).
    pub fn cause(&self, joint: usize, at_s: f64, change_rad: Gaussian, quickness: f64) -> Cause {
        /// Share of a slip that the arm may follow by within a sample.
        const FOLLOWS: f64 = 0.3;
        const PER_STEP: f64 = 1.4;
        let (size_rad, unsure_rad) = (change_rad.mean, change_rad.half_width_95());
        let (theta, q) = (joint, self.joints + joint);
        if joint >= self.joints || self.slots_s.is_empty() {
            return Cause::Unknown(UnknownCause::Missing);
        }
        let near = |[from_s, to_s]: &[f64; 2]| *from_s < at_s + WITHIN_S && *to_s > at_s - WITHIN_S;
        if self.blind.iter().any(near) {
            return Cause::Unknown(UnknownCause::Missing);
        }
        let usual = [theta, q].map(|reading| self.usual_rad(reading));
        let clear = usual.map(|usual| size_rad.abs() > CLEAR * usual);
        let step_s = self.step_s();
        // Not a number where the arm is none: nothing is claimed then.
        if !(PER_STEP * quickness * step_s * step_s < FOLLOWS) {
            return Cause::Unknown(UnknownCause::Rate);
        }
        let tolerance = |usual: f64| unsure_rad.max(0.25 * size_rad.abs()).max(1.5 * usual);
        let motor = clear[0] && self.jumped(theta, at_s, size_rad, tolerance(usual[0]));
        let joint = clear[1] && self.jumped(q, at_s, -size_rad, tolerance(usual[1]));
        match (motor, joint) {
            (true, true) => Cause::Unknown(UnknownCause::Both),
            (true, false) => Cause::MotorEncoder,
            (false, true) => Cause::JointEncoder,
            (false, false) if clear == [true; 2] => Cause::Rope,
            (false, false) => Cause::Unknown(UnknownCause::Noise),
        }
    }
}

/// Acceleration per deflection, `K max(1/J, (M⁻¹)ᵢᵢ)`, 1/s², of joint `i` at pose `q`; NaN without
/// the motor's inertia or where the masses make no arm.
pub fn quickness(arm: &Arm, q: &[f64], i: usize, stiffness: f64, inertia: Option<f64>) -> f64 {
    let n = arm.dof();
    let mut ws = ArmWorkspace::new(arm);
    let (rest, mut torque) = (vec![0.0; n], vec![0.0; n]);
    let (mut free, mut driven) = (vec![f64::NAN; n], vec![f64::NAN; n]);
    let unloaded = arm.forward_dynamics(&mut ws, q, &rest, &torque, &mut free);
    if let Some(torque) = torque.get_mut(i) {
        *torque = 1.0;
    }
    let loaded = arm.forward_dynamics(&mut ws, q, &rest, &torque, &mut driven);
    let (Ok(()), Ok(()), Some(inertia), Some(a), Some(b)) =
        (unloaded, loaded, inertia, free.get(i), driven.get(i))
    else {
        return f64::NAN;
    };
    stiffness * (1.0 / inertia).max(b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings that jump now and then, with a pause, as one record and as parts that go on from each other.
    #[test]
    fn parts_put_together_are_the_whole() {
        let mut whole = Jumps::new(2);
        let mut together = Jumps::new(2);
        let mut part = Jumps::new(2);
        for k in 0..3000_u32 {
            let pause_s = if k >= 1700 { 0.3 } else { 0.0 };
            let time_s = 4e-3 * f64::from(k) + pause_s;
            let jumped = f64::from(k / 331) * 2e-3;
            let theta = [(0.7 * time_s).sin() + jumped, 0.1];
            let q = [(0.7 * time_s).sin(), 0.3 * (1.1 * time_s).cos()];
            whole.push(time_s, &theta, &q);
            part.push(time_s, &theta, &q);
            if k % 53 == 52 {
                let mut next = Jumps::new(2);
                next.go_on_from(&mut part);
                together.append(&part);
                part = next;
            }
        }
        together.append(&part);
        assert!(whole.slots_s.len() > 10 && !whole.blind.is_empty());
        assert_eq!(together.slots_s, whole.slots_s);
        assert_eq!(together.largest, whole.largest);
        assert_eq!(together.blind, whole.blind);
        assert_eq!((together.sum_s, together.steps), (whole.sum_s, whole.steps));
        // What is forgotten leaves the rest as it was.
        let (from_s, to_s) = (whole.slots_s[3], whole.slots_s[6]);
        let [before, after] = [whole.slots_s[..3].to_vec(), whole.slots_s[6..].to_vec()];
        whole.forget_within(from_s..to_s);
        let is_within = |slot_s: &f64| *slot_s >= from_s && slot_s + SLOT_S < to_s;
        assert!(!whole.slots_s.iter().any(is_within));
        assert!(whole.slots_s.starts_with(&before) && whole.slots_s.ends_with(&after));
        assert_eq!(whole.largest.len(), 4 * whole.slots_s.len());
    }
}
