//! Discrimination between a slip of the rope and one of an encoder from single samples.
//!
//! Before and after the event, a slip of the rope and one of an encoder are the same step of
//! `theta − q` at every torque. They differ during the event, because masses have finite accelerations: when a rope
//! slips by `Δ`, the spring torque drops immediately by `K Δ`, and within one sample period `h` no position changes by
//! more than
//!
//! ```text
//! 1.4 K Δ h² max(1/J, (M⁻¹)ᵢᵢ)          (J: motor, M: mass matrix of the arm)
//! ```
//!
//! beyond its trajectory. An encoder whose position changes by all of `Δ` between two samples has itself slipped;
//! at the joint the sign is opposite. The step of a position `x` between two samples is measured
//! against a line through the four samples on either side (least squares; a common curvature
//! cancels),
//!
//! ```text
//! s = Σₖ wₖ (x₊ₖ − x₋ₖ),     w = 0.85, 0.45, 0.05, −0.35
//! ```
//!
//! and compared with the steps that noise and quantisation cause every second. A single wrong sample is a step there and
//! back: without its pair of samples the line shows no step, and it is not counted. The cause is ambiguous if these are too
//! large, if samples are missing, or if the arm is too fast for the sampling rate.
//! A slip of an encoder over tens of milliseconds is indistinguishable from one of the rope.

use crate::cause::{Cause, UnknownCause};
use sinew_model::Gaussian;
use sinew_model::arm::{Arm, ArmWorkspace};
use std::ops::Range;

/// Number of samples on either side of a step.
const SIDE: usize = 4;
/// Weights `w`, oldest sample first.
const WEIGHTS: [f64; 2 * SIDE] = [0.35, -0.05, -0.45, -0.85, 0.85, 0.45, 0.05, -0.35];
/// Weights `w` without one of the pairs, the innermost pair excluded first; zero for the excluded pair.
const WEIGHTS_WITHOUT: [[f64; SIDE]; SIDE] = [
    [0.0, 19.0 / 12.0, 1.0 / 3.0, -11.0 / 12.0],
    [31.0 / 28.0, 0.0, 5.0 / 28.0, -2.0 / 7.0],
    [6.0 / 7.0, 13.0 / 28.0, 0.0, -9.0 / 28.0],
    [13.0 / 12.0, 1.0 / 3.0, -5.0 / 12.0, 0.0],
];
/// Minimum share of a step that the samples show without one of the pairs; a single wrong sample shows none of it without
/// its own.
const MIN_LASTING_SHARE: f64 = 0.5;
/// Duration of the time slots, each of which stores its largest step, s.
const SLOT_S: f64 = 1.0;
/// Maximum difference between the times of a detected change and of a step, s.
const MAX_TIME_ERROR_S: f64 = 2.5;
/// Minimum ratio of a step to the usual step size.
const MIN_STEP_RATIO: f64 = 3.0;
/// Maximum relative deviation of a sample period from its mean; samples around a larger one are not compared.
const MAX_PERIOD_DEVIATION: f64 = 0.5;

/// Largest step of a position in a time slot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Jump {
    time_s: f64,
    size_rad: f64,
}

/// Largest steps of the positions of a recording per time slot. Memory: `32 n` bytes per second.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Jumps {
    joints: usize,
    /// Number of latest samples without a gap.
    samples: usize,
    /// Last `2 SIDE` samples of every position, motor positions first, oldest sample first, rad.
    readings: Vec<[f64; 2 * SIDE]>,
    times: [f64; 2 * SIDE],
    /// Start times of the slots, s.
    slots_s: Vec<f64>,
    /// Largest step of every position in every slot: motor positions, then joint positions, `2 n` per slot.
    largest: Vec<Jump>,
    /// Intervals with missing or unevenly spaced samples, s.
    blind: Vec<[f64; 2]>,
    /// Sum of the sample periods, s; their number is `steps`.
    sum_s: f64,
    steps: u64,
    last_s: Option<f64>,
}

impl Jumps {
    /// Creates an empty record for an arm of `joints` joints.
    pub fn new(joints: usize) -> Self {
        Self {
            joints,
            readings: vec![[0.0; 2 * SIDE]; 2 * joints],
            ..Self::default()
        }
    }

    /// Reserves memory for a duration in seconds, so that recording it does not allocate.
    pub fn reserve(&mut self, duration_s: f64) {
        let slots = (duration_s / SLOT_S).ceil().max(0.0) as usize + 1;
        self.slots_s.reserve(slots);
        self.largest.reserve(2 * self.joints * slots);
        // Two are at least a tenth of a second apart.
        self.blind.reserve(10 * slots);
    }

    /// Removes all slots and gaps; keeps the reserved memory.
    pub fn clear(&mut self) {
        self.slots_s.clear();
        self.largest.clear();
        self.blind.clear();
        (self.samples, self.sum_s, self.steps, self.last_s) = (0, 0.0, 0, None);
    }

    /// Continues from the end of `before`: takes its last samples and the current slot.
    ///
    /// # Realtime
    /// No lock, panic or clock, and no allocation within the [reserved memory](Jumps::reserve).
    pub(crate) fn continue_from(&mut self, before: &mut Self) {
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

    /// Appends a record that [continues](Jumps::continue_from) this one.
    pub(crate) fn append(&mut self, next: &Self) {
        let width = 2 * self.joints;
        let mut largest = next.largest.as_slice();
        let mut slots_s = next.slots_s.as_slice();
        if let (Some(last), Some((first, following))) = (self.slots_s.last(), slots_s.split_first())
            && last == first
        {
            let (shared, rest) = largest.split_at(width);
            let from = self.largest.len() - width;
            for (stored, jump) in self.largest[from..].iter_mut().zip(shared) {
                if jump.size_rad.abs() > stored.size_rad.abs() {
                    *stored = *jump;
                }
            }
            (slots_s, largest) = (following, rest);
        }
        self.slots_s.extend_from_slice(slots_s);
        self.largest.extend_from_slice(largest);
        for [from_s, to_s] in &next.blind {
            self.mark_blind(*from_s, *to_s);
        }
        (self.sum_s, self.steps, self.last_s) = (next.sum_s, next.steps, next.last_s);
    }

    /// Appends the slots and gaps of `from` that ended after `since_s`, or are incomplete, shifted by `by_s` to another
    /// clock. Existing ones are updated.
    ///
    /// # Realtime
    /// No lock, panic or clock, and no allocation within the [reserved memory](Jumps::reserve).
    pub(crate) fn append_since(&mut self, from: &Self, since_s: f64, by_s: f64) {
        let width = 2 * self.joints;
        let slots = from
            .slots_s
            .iter()
            .zip(from.largest.chunks_exact(width.max(1)));
        for (slot_s, jumps) in slots.filter(|(slot_s, _)| **slot_s + SLOT_S > since_s) {
            let slot_s = slot_s + by_s;
            if self.slots_s.last() != Some(&slot_s) {
                self.slots_s.push(slot_s);
                let length = self.largest.len() + width;
                self.largest.resize(length, Jump::default());
            }
            let at = self.largest.len() - width;
            for (stored, jump) in self.largest[at..].iter_mut().zip(jumps) {
                if jump.size_rad.abs() > stored.size_rad.abs() {
                    *stored = Jump {
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

    /// Whether there is [reserved memory](Jumps::reserve) for another slot and another gap.
    pub(crate) fn has_room(&self) -> bool {
        let fits = |length: usize, more: usize, capacity: usize| length + more <= capacity;
        fits(self.slots_s.len(), 1, self.slots_s.capacity())
            && fits(self.largest.len(), 2 * self.joints, self.largest.capacity())
            && fits(self.blind.len(), 1, self.blind.capacity())
    }

    /// Removes the slots and gaps within a time interval, s.
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

    /// Removes the slots and gaps that ended before a time, s.
    pub(crate) fn forget_before(&mut self, time_s: f64) {
        let over = self
            .slots_s
            .partition_point(|from_s| from_s + SLOT_S < time_s);
        self.slots_s.drain(..over);
        self.largest.drain(..over * 2 * self.joints);
        self.blind.retain(|[_, to_s]| *to_s >= time_s);
    }

    /// Returns the slots and gaps that ended between two times, s.
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

    /// Processes a sample at `time_s`: motor and joint positions, rad.
    pub fn push(&mut self, time_s: f64, theta: &[f64], q: &[f64]) {
        if let Some(last_s) = self.last_s {
            let step_s = time_s - last_s;
            let usual_s = self.step_s();
            if self.steps > 20 && (step_s - usual_s).abs() > MAX_PERIOD_DEVIATION * usual_s {
                self.mark_blind(last_s, time_s);
                self.samples = 0;
            }
            // A gap is not a sample period.
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
            if size_rad.abs() > largest.size_rad.abs() && lasts(reading, size_rad) {
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

    /// Returns the mean sample period, s.
    fn step_s(&self) -> f64 {
        self.sum_s / self.steps.max(1) as f64
    }

    /// Returns the usual step size due to noise, quantisation and motion, rad: the upper quartile of all slots.
    fn usual_rad(&self, reading: usize) -> f64 {
        let jumps = self.jumps(reading);
        let mut sizes: Vec<f64> = jumps.map(|j| j.size_rad.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
            .get(3 * sizes.len() / 4)
            .copied()
            .unwrap_or(f64::INFINITY)
    }

    /// Whether a position has a step of `size_rad` ± `tolerance_rad` around `at_s`.
    fn jumped(&self, reading: usize, at_s: f64, size_rad: f64, tolerance_rad: f64) -> bool {
        self.jumps(reading).any(|j| {
            (j.time_s - at_s).abs() < MAX_TIME_ERROR_S
                && (j.size_rad - size_rad).abs() < tolerance_rad
        })
    }

    /// Returns the largest steps of a position in all slots.
    fn jumps(&self, reading: usize) -> impl Iterator<Item = &Jump> {
        let slots = self.largest.chunks_exact((2 * self.joints).max(1));
        slots.filter_map(move |slot| slot.get(reading))
    }

    /// Determines the cause of a change of a joint's offset by `change_rad` around `at_s`.
    ///
    /// `quickness`: acceleration per deflection of the joint's spring, `K max(1/J, (M⁻¹)ᵢᵢ)`,
    /// 1/s² (see [`quickness`]).
    pub fn cause(&self, joint: usize, at_s: f64, change_rad: Gaussian, quickness: f64) -> Cause {
        /// Maximum share of a rope slip that appears in one position within a sample period.
        const MAX_SHARE_PER_SAMPLE: f64 = 0.3;
        /// Factor 1.4 of the equation in the module documentation.
        const PER_STEP: f64 = 1.4;
        let (size_rad, half_width_rad) = (change_rad.mean, change_rad.half_width_95());
        let (theta, q) = (joint, self.joints + joint);
        if joint >= self.joints || self.slots_s.is_empty() {
            return Cause::Unknown(UnknownCause::Missing);
        }
        let near = |[from_s, to_s]: &[f64; 2]| {
            *from_s < at_s + MAX_TIME_ERROR_S && *to_s > at_s - MAX_TIME_ERROR_S
        };
        if self.blind.iter().any(near) {
            return Cause::Unknown(UnknownCause::Missing);
        }
        let usual = [theta, q].map(|reading| self.usual_rad(reading));
        let clear = usual.map(|usual| size_rad.abs() > MIN_STEP_RATIO * usual);
        let step_s = self.step_s();
        // NaN for an invalid arm: the cause is ambiguous then.
        if !(PER_STEP * quickness * step_s * step_s < MAX_SHARE_PER_SAMPLE) {
            return Cause::Unknown(UnknownCause::Rate);
        }
        let tolerance = |usual: f64| half_width_rad.max(0.25 * size_rad.abs()).max(1.5 * usual);
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

/// Whether a step of `size_rad` in the middle of the samples does not depend on a single one of them.
fn lasts(reading: &[f64; 2 * SIDE], size_rad: f64) -> bool {
    WEIGHTS_WITHOUT.iter().all(|weights| {
        let pairs = weights.iter().enumerate();
        let size_without_rad: f64 = pairs
            .map(|(k, w)| w * (reading[SIDE + k] - reading[SIDE - 1 - k]))
            .sum();
        size_without_rad / size_rad > MIN_LASTING_SHARE
    })
}

/// Returns the acceleration per deflection, `K max(1/J, (M⁻¹)ᵢᵢ)`, of joint `i` at pose `q`, 1/s²; NaN without
/// motor inertia or with invalid masses.
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

    // The weights of every selection of pairs measure a step exactly, on any parabola.
    #[test]
    fn weights_measure_step_on_parabola() {
        for (step, excluded) in [(0.0, 0), (1.0, 1), (-0.3, 2), (2.0, 3)] {
            let reading: [f64; 2 * SIDE] = std::array::from_fn(|k| {
                let t = k as f64 - 3.5;
                0.2 + 0.7 * t - 0.05 * t * t + if k < SIDE { 0.0 } else { step }
            });
            let of_all: f64 = WEIGHTS.iter().zip(reading).map(|(w, x)| w * x).sum();
            let pairs = WEIGHTS_WITHOUT[excluded].iter().enumerate();
            let without: f64 = pairs
                .map(|(k, w)| w * (reading[SIDE + k] - reading[SIDE - 1 - k]))
                .sum();
            assert!((of_all - step).abs() < 1e-12, "{of_all} {step}");
            assert!((without - step).abs() < 1e-12, "{without} {step}");
        }
    }

    // A single wrong sample is not a slip of the encoder, next to a slip of the rope of the same size.
    #[test]
    fn cause_single_outlier_is_no_encoder_slip() {
        let cause = |wrong_rad: f64, slips_rad: f64| {
            let mut jumps = Jumps::new(1);
            for k in 0..5000_u32 {
                let time_s = 4e-3 * f64::from(k);
                let noise = 1e-4 * (1e3 * time_s).sin();
                let wrong = if k == 2600 { wrong_rad } else { 0.0 };
                let slipped = if k >= 2550 { slips_rad } else { 0.0 };
                let q = 0.3 * time_s.sin() + noise + wrong + slipped;
                jumps.push(time_s, &[0.3 * time_s.sin() - noise], &[q]);
            }
            let size = Gaussian {
                mean: 8e-3,
                std: 2e-4,
            };
            jumps.cause(0, 10.3, size, 1e3)
        };
        for wrong_rad in [-7e-3, -9.4e-3, -18e-3, 9.4e-3] {
            assert_eq!(cause(wrong_rad, 0.0), Cause::Rope, "{wrong_rad}");
            assert_eq!(cause(wrong_rad, -8e-3), Cause::JointEncoder, "{wrong_rad}");
        }
    }

    // Positions with steps and a pause, as one record and as consecutive parts.
    #[test]
    fn jumps_appended_parts_equal_whole_record() {
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
                next.continue_from(&mut part);
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
        // Removing slots does not change the others.
        let (from_s, to_s) = (whole.slots_s[3], whole.slots_s[6]);
        let [before, after] = [whole.slots_s[..3].to_vec(), whole.slots_s[6..].to_vec()];
        whole.forget_within(from_s..to_s);
        let is_within = |slot_s: &f64| *slot_s >= from_s && slot_s + SLOT_S < to_s;
        assert!(!whole.slots_s.iter().any(is_within));
        assert!(whole.slots_s.starts_with(&before) && whole.slots_s.ends_with(&after));
        assert_eq!(whole.largest.len(), 4 * whole.slots_s.len());
    }
}
