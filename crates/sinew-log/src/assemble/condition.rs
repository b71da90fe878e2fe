//! Conversion of raw values to SI, unwrapping, and checks of the signals.
//!
//! # Wrap-around
//! A value that differs from the previous one of its signal by more than half a period is moved to the
//! nearest turn. The same holds after a gap; for the motor side the turn is then chosen such that `theta − q`
//! changes least, so that both sides are on the same turn; at the start it is the turn of the joint side. The
//! position of a motor at its shaft does not move with one joint only: it is moved to the turn of the
//! previous sample. A signal whose raw values span more than one period does not come from a wrapping encoder
//! and is not changed.

use super::coverage::Coverage;
use super::key::Key;
use super::timeline::{Step, Timeline};
use crate::frame::{ABSENT, AxisNames, Frame, Quantity, blocks, is_absent};
use crate::health::{EventKind, Health, LateStart, SignalCount, SignalCoverage};
use crate::motor_ratio::{RatioSums, describe_ratios};
use sinew_files::WORKS_AT_C;

/// Minimum period, rad, for which the motor side starts in the same revolution as the joint; with a shorter period,
/// the deflection of the spring may exceed half of it.
const SHORTEST_TURN_RAD: f64 = std::f64::consts::PI;
/// A raw span larger than this many periods is not a wrapping encoder.
const WRAP_SPAN_PERIODS: f64 = 1.001;
/// Frames and seconds from which a signal that never changes is suspicious.
const CONSTANT_FRAMES: u64 = 100;
const CONSTANT_SECONDS: f64 = 1.0;
/// A joint position beyond this is more likely to be in degrees, rad.
const DEGREES_FROM_RAD: f64 = 2.0 * std::f64::consts::PI * 1.01;
/// Interval of the frames in the comparison of motor and joint side.
const SIDES_EVERY: u64 = 8;
/// Minimum number of compared frames, and minimum motion of the joint, rad, for both sides to be one signal.
const ONE_SIGNAL_FRAMES: u64 = 16;
const ONE_SIGNAL_SPAN_RAD: f64 = 0.05;
/// Sides that move apart by less are one signal: rounding, rad.
const ONE_SIGNAL_RAD: f64 = 1e-9;

/// 0 °C, K.
const CELSIUS_ZERO_K: f64 = 273.15;

/// Message about temperatures outside the working range of a robot.
fn implausible_temperatures([low, high]: [f64; 2]) -> String {
    let [least, most] = WORKS_AT_C;
    let range = match low == high {
        true => format!("{low:.1} °C"),
        false => format!("{low:.1} to {high:.1} °C"),
    };
    let kelvin = [low, high].map(|c| c - CELSIUS_ZERO_K);
    let cure = match kelvin.iter().all(|c| (least..=most).contains(c)) {
        true => "it looks like kelvin; set [temperature] unit = \"K\" in the mapping",
        false => "set its unit under [temperature] in the mapping",
    };
    format!(
        "temperature of {range} is outside the working range of robots ({least:.0} to {most:.0} °C) and ignored: {cure}"
    )
}

/// Conversion of one signal to SI: `si = scale · raw + offset`, with its period in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// Factor from the recorded value to SI.
    pub scale: f64,
    /// Offset in SI, added last.
    pub offset: f64,
    /// `None`: never unwrapped.
    pub period: Option<f64>,
}

impl Signal {
    /// A signal that is not recorded.
    const NONE: Signal = Signal {
        scale: 1.0,
        offset: 0.0,
        period: None,
    };

    /// A signal that is recorded in SI.
    pub fn si(quantity: Quantity) -> Self {
        Signal {
            scale: 1.0,
            offset: 0.0,
            period: match crate::mapping::Wrap::default_for(quantity) {
                crate::mapping::Wrap::Period(period) => Some(period),
                crate::mapping::Wrap::Never => None,
            },
        }
    }
}

/// Both sides of a joint.
#[derive(Debug, Clone, Copy, Default)]
struct Sides {
    ratio: RatioSums,
    /// Number of frames with both sides.
    count: u64,
    /// Value of `theta − q` in the first of them.
    first: f64,
    /// Smallest and largest `theta − q`, relative to the first one.
    apart: [f64; 2],
}

/// Unwraps, converts and watches the signals; one frame after the other.
#[derive(Debug)]
pub struct Conditioner {
    axes: Vec<AxisNames>,
    n: usize,
    /// Places of the axes that have no joint.
    without_joint: Vec<usize>,
    gap_ns: i64,
    /// A block of `n` for each quantity of a row, in storage order.
    signals: Vec<Signal>,
    blocks: &'static [Quantity],
    has_tension: bool,
    identity: bool,
    minimum: Vec<f64>,
    maximum: Vec<f64>,
    finite: Vec<u64>,
    non_finite: Vec<u64>,
    /// Two blocks of `n`: q and theta.
    last: Vec<f64>,
    turns: Vec<f64>,
    /// Half the period, infinite if there is none; whether a block has turned.
    half_period: Vec<f64>,
    turned: [bool; 2],
    wraps: Vec<u64>,
    sides: Vec<Sides>,
    /// Coverage of the recording by each signal of q and theta.
    coverage: Vec<Coverage>,
    /// Lowest and highest temperature outside the working range of a robot, °C.
    implausible_temperatures: Option<[f64; 2]>,
    timeline: Timeline,
    /// Whether the time of the frames continues over steps of the clock.
    continues: bool,
    first_ns: Option<i64>,
    last_ns: Option<i64>,
    segment: u32,
}

impl Conditioner {
    /// Longest step that is no gap, ns.
    pub(crate) fn gap_ns(&self) -> i64 {
        self.gap_ns
    }

    /// The blocks of `n` values of a wide row.
    pub(crate) fn blocks(&self) -> &'static [Quantity] {
        self.blocks
    }

    /// `signal` returns the conversion to SI of a quantity of a named axis.
    pub(crate) fn new(
        axes: &[AxisNames],
        gap_ns: i64,
        signal: impl Fn(&AxisNames, Quantity) -> Signal,
    ) -> Self {
        let n = axes.len();
        let blocks = blocks(axes);
        let signals = blocks.iter().flat_map(|quantity| {
            let signal = &signal;
            axes.iter().map(move |axis| match axis.recorded(*quantity) {
                Some(_) => signal(axis, *quantity),
                None => Signal::NONE,
            })
        });
        let signals = Vec::from_iter(signals);
        let without_joint = (0..n).filter(|axis| axes[*axis].joint.is_none());
        let identity = signals.iter().all(|s| s.scale == 1.0 && s.offset == 0.0);
        let half_period = signals[..2 * n]
            .iter()
            .map(|signal| 0.5 * signal.period.unwrap_or(f64::INFINITY))
            .collect();
        Conditioner {
            axes: axes.to_vec(),
            n,
            without_joint: without_joint.collect(),
            gap_ns,
            identity,
            minimum: vec![f64::INFINITY; signals.len()],
            maximum: vec![f64::NEG_INFINITY; signals.len()],
            finite: vec![0; signals.len()],
            non_finite: vec![0; signals.len()],
            signals,
            blocks,
            has_tension: blocks.contains(&Quantity::Tension),
            last: vec![f64::NAN; 2 * n],
            turns: vec![0.0; 2 * n],
            half_period,
            turned: [false; 2],
            wraps: vec![0; 2 * n],
            sides: vec![Sides::default(); n],
            coverage: vec![Coverage::default(); 2 * n],
            implausible_temperatures: None,
            timeline: Timeline::new(gap_ns),
            continues: true,
            first_ns: None,
            last_ns: None,
            segment: 0,
        }
    }

    /// Keeps the time stamps in the frames as they are, also across steps of the clock.
    pub(crate) fn keep_stamps(&mut self) {
        self.continues = false;
    }

    /// Period in raw units, if the signal may still come from a wrapping encoder.
    pub(crate) fn raw_period(&self, quantity: Quantity, joint: usize) -> Option<f64> {
        if !matches!(quantity, Quantity::Q | Quantity::Theta) {
            return None;
        }
        let index = quantity.index() * self.n + joint;
        let signal = &self.signals[index];
        let period = signal.period?;
        (self.maximum[index] - self.minimum[index] <= WRAP_SPAN_PERIODS * period
            || self.finite[index] == 0)
            .then_some(period / signal.scale.abs())
    }

    /// Sets the position of an axis without a joint to 0, and its velocity to 0 if any joint has a velocity.
    fn set_at_rest(&self, raw: &mut [f64]) {
        let n = self.n;
        let dq = Quantity::Dq.index() * n;
        let own = raw[dq..dq + n].iter().zip(&self.axes);
        let mut own = own.filter(|(_, axis)| axis.joint.is_some());
        let moves = match own.any(|(value, _)| !is_absent(*value)) {
            true => 0.0,
            false => ABSENT,
        };
        for axis in &self.without_joint {
            raw[*axis] = 0.0;
            raw[dq + axis] = moves;
        }
    }

    /// Whether no joint has a position.
    fn lacks_joint_side(&self, q: &[f64]) -> bool {
        let none = self.without_joint.len();
        let missing = q.iter().filter(|value| value.is_nan()).count();
        missing + none == self.n && (none == 0 || none < self.n)
    }

    /// Turns the wide raw row into the frame.
    pub(crate) fn apply(
        &mut self,
        key: Key,
        received_ns: Option<i64>,
        after_damage: bool,
        raw: &mut [f64],
        frame: &mut Frame,
        health: &mut Health,
    ) {
        if !self.without_joint.is_empty() {
            self.set_at_rest(raw);
        }
        let new_segment = self.segment_at(key, received_ns, after_damage, health);
        frame.time_ns = match self.continues {
            true => self.timeline.time_ns(),
            false => key.time_ns,
        };
        self.first_ns.get_or_insert(frame.time_ns);
        self.last_ns = Some(frame.time_ns);
        frame.segment = self.segment;
        let n = self.n;
        let sound = self.identity && self.watch(&raw[..6 * n]);
        for quantity in Quantity::PER_JOINT {
            let block = quantity.index() * n;
            let raw = &raw[block..block + n];
            let out = frame.get_mut(quantity);
            if sound {
                out.copy_from_slice(raw);
            } else {
                self.convert(block, raw, out);
            }
        }
        let mut positions_absent = false;
        for value in &raw[..2 * n] {
            positions_absent |= is_absent(*value);
        }
        let whole = sound && !positions_absent;
        self.unwrap(new_segment, whole, frame);
        let positions = frame.q.iter().chain(&frame.theta);
        for (coverage, value) in self.coverage.iter_mut().zip(positions) {
            coverage.frame(frame.time_ns, *value);
        }
        if self.has_tension {
            let block = Quantity::Tension.index() * n;
            self.convert(block, &raw[block..block + n], &mut frame.tension);
        }
        let temperature_c = raw[6 * n..7 * n].iter().copied().find(|v| !is_absent(*v));
        frame.temperature_c = temperature_c
            .filter(|c| c.is_finite() && self.robots_work_at(*c))
            .unwrap_or(f64::NAN);

        if !whole && self.lacks_joint_side(&frame.q) {
            health.frames_without_joint_side += 1;
        }
        if !whole && frame.theta.iter().all(|value| value.is_nan()) {
            health.frames_without_motor_side += 1;
        }
        if health.frames.is_multiple_of(SIDES_EVERY) {
            self.watch_sides(frame);
        }
        health.frames += 1;
    }

    /// Coverage of the recording by a position; `None` if it is not recorded.
    fn signal_coverage(
        &self,
        quantity: Quantity,
        axis: usize,
        health: &Health,
    ) -> Option<SignalCoverage> {
        let joint = self.axes[axis].recorded(quantity)?;
        let index = quantity.index() * self.n + axis;
        let coverage = &self.coverage[index];
        let [first_ns, last_ns] = [self.first_ns?, self.last_ns?];
        let start_ns = coverage.start_ns?;
        let ends_ns = [
            start_ns.saturating_sub(first_ns),
            last_ns.saturating_sub(coverage.last_ns),
        ];
        let hole_ns = ends_ns.into_iter().fold(coverage.hole_ns, i64::max);
        Some(SignalCoverage {
            quantity,
            joint: joint.to_owned(),
            share: coverage.samples as f64 / health.frames.max(1) as f64,
            longest_interval_s: hole_ns as f64 * 1e-9,
            repeated_share: coverage.repeated as f64 / coverage.samples.max(1) as f64,
            unwrapped: self.wraps[index],
        })
    }

    /// Position that starts later than the recording by more than the gap limit.
    fn late_start(&self, quantity: Quantity, axis: usize) -> Option<LateStart> {
        let joint = self.axes[axis].recorded(quantity)?;
        let start_ns = self.coverage[quantity.index() * self.n + axis].start_ns?;
        let after_ns = start_ns.saturating_sub(self.first_ns?);
        (after_ns > self.gap_ns).then(|| LateStart {
            quantity,
            joint: joint.to_owned(),
            after_s: after_ns as f64 * 1e-9,
        })
    }

    /// Whether a temperature is within the working range of a robot; others are recorded and unknown.
    fn robots_work_at(&mut self, celsius: f64) -> bool {
        let works = (WORKS_AT_C[0]..=WORKS_AT_C[1]).contains(&celsius);
        if !works {
            let [low, high] = self.implausible_temperatures.unwrap_or([celsius; 2]);
            self.implausible_temperatures = Some([low.min(celsius), high.max(celsius)]);
        }
        works
    }

    /// Counts gaps and steps of the clock; returns whether a new segment starts.
    fn segment_at(
        &mut self,
        key: Key,
        received_ns: Option<i64>,
        after_damage: bool,
        health: &mut Health,
    ) -> bool {
        let Some(step) = self.timeline.frame(key, received_ns) else {
            return false;
        };
        let mut new_segment = after_damage;
        let passed_ns = match step {
            Step::Passed(passed_ns) => passed_ns,
            Step::Clock { by_ns, passed_ns } => {
                new_segment = true;
                health.clock_steps += 1;
                health.event(key.time_ns, EventKind::ClockStep, || {
                    let by_s = by_ns.unsigned_abs() as f64 * 1e-9;
                    let direction = if by_ns < 0 { "back" } else { "ahead" };
                    format!("clock stepped {direction} by {by_s:.3} s; a new segment starts")
                });
                passed_ns
            }
        };
        if passed_ns > self.gap_ns {
            new_segment = true;
            let pause_s = passed_ns as f64 * 1e-9;
            health.gaps += 1;
            health.longest_gap_s = health.longest_gap_s.max(pause_s);
            health.event(
                key.time_ns.saturating_sub(passed_ns),
                EventKind::Gap,
                || format!("no frame for {pause_s:.3} s; a new segment starts"),
            );
        }
        if new_segment {
            self.segment = self.segment.saturating_add(1);
        }
        new_segment
    }

    /// The usual row, each value finite or absent: takes its extremes and counts without a
    /// branch per value. `false` when the row holds anything else; nothing is then counted.
    #[inline]
    fn watch(&mut self, row: &[f64]) -> bool {
        let mut sound = true;
        for value in row {
            sound &= (value.abs() < f64::INFINITY) | is_absent(*value);
        }
        if !sound {
            return false;
        }
        let extremes = self.minimum.iter_mut().zip(&mut self.maximum);
        for ((value, (low, high)), finite) in row.iter().zip(extremes).zip(&mut self.finite) {
            // Comparisons with an absent value, a NaN, are false.
            *low = if *value < *low { *value } else { *low };
            *high = if *value > *high { *value } else { *high };
            *finite += u64::from(!is_absent(*value));
        }
        true
    }

    /// Converts raw values to SI, with their extremes; bad samples are counted.
    fn convert(&mut self, block: usize, raw: &[f64], out: &mut [f64]) {
        for joint in 0..self.n {
            let index = block + joint;
            let mut value = raw[joint];
            if is_absent(value) {
                out[joint] = f64::NAN;
                continue;
            }
            if !self.identity {
                let signal = &self.signals[index];
                value = signal.scale * value + signal.offset;
            }
            if value.is_finite() {
                self.minimum[index] = self.minimum[index].min(value);
                self.maximum[index] = self.maximum[index].max(value);
                self.finite[index] += 1;
                out[joint] = value;
            } else {
                self.non_finite[index] += 1;
                out[joint] = f64::NAN;
            }
        }
    }

    /// Removes wrap-around. In most frames no signal has wrapped around.
    #[inline]
    fn unwrap(&mut self, new_segment: bool, whole: bool, frame: &mut Frame) {
        let n = self.n;
        if !new_segment && whole && self.turned == [false; 2] {
            let mut jumps = false;
            for (values, block) in [(&frame.q, 0), (&frame.theta, n)] {
                let last = &self.last[block..block + n];
                let half = &self.half_period[block..block + n];
                for ((value, last), half) in values.iter().zip(last).zip(half) {
                    // Nothing before the first frame (NaN): looked at one by one.
                    jumps |= (value - last).abs() > *half || last.is_nan();
                }
            }
            if !jumps {
                self.last[..n].copy_from_slice(&frame.q);
                self.last[n..].copy_from_slice(&frame.theta);
                return;
            }
        }
        self.unwrap_each(new_segment, frame);
    }

    fn unwrap_each(&mut self, new_segment: bool, frame: &mut Frame) {
        let n = self.n;
        for joint in 0..n {
            let q_before = self.last[joint];
            if let Some(period) = self.signals[joint].period {
                self.unwrap_one(joint, period, q_before, &mut frame.q[joint]);
            } else if frame.q[joint].is_finite() {
                self.last[joint] = frame.q[joint];
            }
            let theta = n + joint;
            if let Some(period) = self.signals[theta].period {
                let mut expected = self.last[theta];
                let is_reflected = self.axes[joint].is_reflected;
                if is_reflected && expected.is_nan() && period >= SHORTEST_TURN_RAD {
                    expected = frame.q[joint];
                } else if is_reflected && new_segment {
                    let moved = frame.q[joint] - q_before;
                    if moved.is_finite() {
                        expected += moved;
                    }
                }
                self.unwrap_one(theta, period, expected, &mut frame.theta[joint]);
            }
        }
    }

    /// `place`: joint for q, `n` + joint for theta, in `last` and in the signals.
    fn unwrap_one(&mut self, place: usize, period: f64, expected: f64, value: &mut f64) {
        if value.is_nan() {
            return;
        }
        let mut unwrapped = *value;
        if self.turns[place] != 0.0 {
            unwrapped += self.turns[place] * period;
        }
        // False as well when nothing is expected yet (NaN).
        if (unwrapped - expected).abs() > 0.5 * period
            && self.maximum[place] - self.minimum[place] <= WRAP_SPAN_PERIODS * period
        {
            let turns = ((expected - unwrapped) / period).round();
            if turns != 0.0 {
                self.turns[place] += turns;
                self.wraps[place] += 1;
                self.turned[place / self.n] = true;
                unwrapped = *value + self.turns[place] * period;
            }
        }
        self.last[place] = unwrapped;
        *value = unwrapped;
    }

    fn watch_sides(&mut self, frame: &Frame) {
        for (joint, sides) in self.sides.iter_mut().enumerate() {
            let (q, theta) = (frame.q[joint], frame.theta[joint]);
            if !(q.is_finite() && theta.is_finite()) {
                continue;
            }
            sides.ratio.push(q, theta);
            if sides.count == 0 {
                sides.first = theta - q;
            }
            sides.count += 1;
            let apart = theta - q - sides.first;
            let [least, most] = sides.apart;
            sides.apart = [least.min(apart), most.max(apart)];
        }
    }

    /// Writes the counts and implausible_signals of the whole recording.
    pub(crate) fn finish(&self, health: &mut Health) {
        let n = self.n;
        health.non_finite.clear();
        health.unwrapped.clear();
        for quantity in self.blocks.iter().copied() {
            for axis in 0..n {
                // What has no name is not recorded.
                let Some(name) = self.axes[axis].recorded(quantity) else {
                    continue;
                };
                let index = quantity.index() * n + axis;
                if self.non_finite[index] > 0 {
                    health.non_finite.push(SignalCount {
                        quantity,
                        joint: name.to_owned(),
                        count: self.non_finite[index],
                    });
                }
                self.suspect_signal(quantity, index, name, health);
            }
        }
        for (block, quantity) in [Quantity::Q, Quantity::Theta].into_iter().enumerate() {
            for joint in 0..n {
                let wraps = self.wraps[block * n + joint];
                let name = self.axes[joint].recorded(quantity);
                if let Some(name) = name.filter(|_| wraps > 0) {
                    health.unwrapped.push(SignalCount {
                        quantity,
                        joint: name.to_owned(),
                        count: wraps,
                    });
                }
            }
        }
        health.late_starts.clear();
        for quantity in [Quantity::Q, Quantity::Theta] {
            let late = (0..n).filter_map(|axis| self.late_start(quantity, axis));
            health.late_starts.extend(late);
        }
        health.signals.clear();
        for axis in 0..n {
            let signals = [Quantity::Q, Quantity::Theta].into_iter();
            let signals =
                signals.filter_map(|quantity| self.signal_coverage(quantity, axis, health));
            let signals = Vec::from_iter(signals);
            health.signals.extend(signals);
        }
        health.motor_ratios.clear();
        for joint in 0..n {
            self.suspect_sides(joint, health);
        }
        if !health.motor_ratios.is_empty() {
            health.implausible_signal(describe_ratios(&health.motor_ratios));
        }
        if let Some(range) = self.implausible_temperatures {
            health.implausible_signal(implausible_temperatures(range));
        }
    }

    fn suspect_signal(&self, quantity: Quantity, index: usize, name: &str, health: &mut Health) {
        let name = format!("{}.{name}", quantity.symbol());
        let (minimum, maximum) = (self.minimum[index], self.maximum[index]);
        if self.finite[index] == 0 {
            if self.non_finite[index] > 0 {
                health.implausible_signal(format!(
                    "{name} has no finite value in {} samples",
                    self.non_finite[index]
                ));
            }
            return;
        }
        let seconds = match (self.first_ns, self.last_ns) {
            (Some(first), Some(last)) => last.saturating_sub(first) as f64 * 1e-9,
            _ => 0.0,
        };
        if minimum == maximum
            && self.finite[index] >= CONSTANT_FRAMES
            && seconds.abs() >= CONSTANT_SECONDS
        {
            health.implausible_signal(format!(
                "{name} is constant at {minimum} over {} samples",
                self.finite[index]
            ));
        }
        let largest = minimum.abs().max(maximum.abs());
        if quantity == Quantity::Q && largest > DEGREES_FROM_RAD {
            health.implausible_signal(format!(
                "{name} looks like degrees (range {:.4}, from {minimum:.4} to {maximum:.4}): \
                 set unit = \"deg\" in the mapping; expected only for a continuous or prismatic joint",
                maximum - minimum
            ));
        }
    }

    /// Compares the motor side with the joint side: one signal, unit, gear ratio, sign.
    fn suspect_sides(&self, joint: usize, health: &mut Health) {
        let axis = &self.axes[joint];
        let Some(name) = axis.joint.as_ref().filter(|_| axis.is_reflected) else {
            return;
        };
        let sides = &self.sides[joint];
        let span = self.maximum[joint] - self.minimum[joint];
        let is_compared = sides.count >= ONE_SIGNAL_FRAMES && span >= ONE_SIGNAL_SPAN_RAD;
        if is_compared && sides.apart[1] - sides.apart[0] <= ONE_SIGNAL_RAD {
            health.implausible_signal(format!(
                "theta.{name} is bitwise identical to q.{name}: probably one encoder or one topic for both sides; expected only for a rigid joint"
            ));
        }
        // How far the motor of a held joint can travel is not known without the robot.
        let ratio = sides.ratio.implausible(name, f64::INFINITY);
        health.motor_ratios.extend(ratio);
    }
}
