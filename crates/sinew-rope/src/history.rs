//! A rope under a periodic duty for years, without stepping through each cycle.
//!
//! Over a repeated cycle delayed elasticity and retraction are affine maps (`v ↦ a v + c`), so
//! any number of cycles is one closed form; flow adds the same each time. Bedding-in alone is
//! nonlinear, and becomes a slow differential equation once its change per cycle is small. The first cycles are always
//! run one by one; the number of cycles that are evaluated then grows with the logarithm of the time at most.

use super::Duty;
use super::duty::Stretch;
use crate::law::{Law, LoadError, Rates, State, bedded_over, ramp};

/// Number of cycles that are run one by one. The slow equation ignores the fifth difference of the bedding-in, which
/// is `4!/n⁵` of its logarithmic slope in cycle `n`: less than `1e-6` of that slope in all cycles after 30.
const EXACT_CYCLES: f64 = 30.0;
/// Numerical tolerance of one step of the slow equation, as a share of the full bedding-in.
const TOLERANCE: f64 = 1e-6;
/// Remaining change of the bedding-in, as a share of the full one, that is taken as a straight line.
const TOLERANCE_END: f64 = 1e-9;

/// Progress of a rope through a duty.
#[derive(Debug, Clone)]
pub struct History<'a> {
    law: &'a Law,
    duty: &'a Duty,
    cycle_s: f64,
    /// State of the rope after the cycles that were run one by one.
    state: State,
    time_s: f64,
    run_cycles: f64,
    skipped: Option<Skipped>,
}

/// Continuation of a history after the cycles that were run one by one.
#[derive(Debug, Clone)]
struct Skipped {
    /// State after one cycle from a state of zeros and from one of ones: constant and slope of the affine maps.
    from_zero: State,
    from_one: State,
    /// Rates of the segments of constant load.
    rates: Vec<Option<Rates>>,
    /// Number of cycles with the permanent heat retraction after them, %.
    kept: (f64, f64),
    /// Start and end of the last step of the slow equation.
    step: [Bedded; 2],
    /// Coefficients of the interpolation within this step.
    between: [f64; 4],
    /// Length of the next step in the logarithm of the number of cycles.
    length: f64,
}

/// Bedding-in after a number of cycles.
#[derive(Debug, Clone, Copy)]
struct Bedded {
    cycles: f64,
    percent: f64,
    percent_per_cycle: f64,
}

impl<'a> History<'a> {
    /// Starts from a state at the beginning of a duty.
    pub fn new(law: &'a Law, duty: &'a Duty, state: State) -> Self {
        Self {
            law,
            duty,
            cycle_s: duty.stretches.iter().map(|s| s.duration_s).sum(),
            state,
            time_s: 0.0,
            run_cycles: 0.0,
            skipped: None,
        }
    }

    /// State at a time since the start, s; times must not fall from call to call.
    ///
    /// # Errors
    /// [`LoadError`], such as a tension above the breaking load.
    pub fn at(&mut self, time_s: f64) -> Result<State, LoadError> {
        if self.duty.is_constant() {
            let load = self.duty.stretches[0].from;
            self.law.hold(&mut self.state, load, time_s - self.time_s)?;
            self.time_s = time_s;
            return Ok(self.state);
        }
        if !self.duty.repeat {
            let mut state = self.state;
            self.run_part(&mut state, time_s.min(self.cycle_s))?;
            if time_s > self.cycle_s
                && let Some(last) = self.duty.stretches.last()
            {
                self.law.hold(&mut state, last.to, time_s - self.cycle_s)?;
            }
            return Ok(state);
        }
        let cycles = (time_s / self.cycle_s).floor();
        let mut state = self.after(cycles)?;
        self.run_part(&mut state, time_s - cycles * self.cycle_s)?;
        Ok(state)
    }

    /// Runs the first `duration_s` of a cycle.
    fn run_part(&self, state: &mut State, duration_s: f64) -> Result<(), LoadError> {
        let mut left = duration_s;
        for s in &self.duty.stretches {
            if left <= 0.0 {
                break;
            }
            let run = left.min(s.duration_s);
            run_stretch(self.law, state, s, run)?;
            left -= s.duration_s;
        }
        Ok(())
    }

    fn cycle(&self, mut state: State) -> Result<State, LoadError> {
        self.run_part(&mut state, self.cycle_s)?;
        Ok(state)
    }

    /// State after a whole number of cycles.
    fn after(&mut self, cycles: f64) -> Result<State, LoadError> {
        while self.skipped.is_none() && self.run_cycles < cycles.min(EXACT_CYCLES) {
            let before = self.state.bedding_percent;
            self.state = self.cycle(self.state)?;
            self.run_cycles += 1.0;
            // A rope that is bedded in has nothing else that is not a closed form.
            let change = self.state.bedding_percent - before;
            if change <= TOLERANCE_END * self.law.bedding_percent() {
                break;
            }
        }
        if cycles <= self.run_cycles {
            return Ok(self.state);
        }
        let mut skipped = match self.skipped.take() {
            Some(skipped) => skipped,
            None => self.skip()?,
        };
        let state = self.leap(&mut skipped, cycles)?;
        self.skipped = Some(skipped);
        Ok(state)
    }

    fn skip(&self) -> Result<Skipped, LoadError> {
        let start = self.state;
        let rates = |s: &Stretch| (s.from == s.to).then(|| self.law.rates(s.from)).transpose();
        let rates: Vec<Option<Rates>> =
            (self.duty.stretches.iter().map(rates)).collect::<Result<_, _>>()?;
        // Slope and constant of each affine map, from two runs that share everything else. No bedding-in is left, on
        // which they do not depend.
        let zero = State {
            bedding_percent: self.law.bedding_percent(),
            ..State::default()
        };
        let one = State {
            delayed_percent: [1.0; 5],
            retraction_percent: 1.0,
            ..zero
        };
        let bedded = Bedded {
            cycles: self.run_cycles,
            percent: start.bedding_percent,
            percent_per_cycle: self.slow_rate(&rates, start.bedding_percent),
        };
        Ok(Skipped {
            from_zero: self.cycle(zero)?,
            from_one: self.cycle(one)?,
            rates,
            kept: (self.run_cycles, start.retraction_kept_percent),
            step: [bedded; 2],
            between: [0.0; 4],
            length: self.run_cycles.recip().ln_1p(),
        })
    }

    /// State after a number of cycles above that of the cycles that were run.
    fn leap(&self, skipped: &mut Skipped, whole: f64) -> Result<State, LoadError> {
        let cycles = whole - self.run_cycles;
        let leap = |y: f64, constant: f64, after_one: f64| {
            let slope = (after_one - constant).clamp(0.0, 1.0);
            let power = slope.powf(cycles);
            // Σ slope^k = (1 − slope^n)/(1 − slope); n where the slope is 1 to rounding.
            let sum = if 1.0 - slope > 1e-12 {
                (1.0 - power) / (1.0 - slope)
            } else {
                cycles
            };
            power * y + constant * sum
        };
        let (start, zero, one) = (self.state, &skipped.from_zero, &skipped.from_one);
        let mut end = start;
        for i in 0..5 {
            end.delayed_percent[i] = leap(
                start.delayed_percent[i],
                zero.delayed_percent[i],
                one.delayed_percent[i],
            );
        }
        end.retraction_percent = leap(
            start.retraction_percent,
            zero.retraction_percent,
            one.retraction_percent,
        );
        end.flow_percent = start.flow_percent + cycles * zero.flow_percent;
        // Retraction that a new rope does not keep is not kept later either.
        if zero.retraction_kept_percent > 0.0 {
            let (from, kept) = skipped.kept;
            skipped.kept = (whole, self.keep(kept, whole - from)?);
        }
        end.retraction_kept_percent = skipped.kept.1;
        end.bedding_percent = self.bedded(skipped, whole);
        Ok(end)
    }

    /// Permanent heat retraction after many cycles, %.
    ///
    /// The increment of a cycle decreases with the retraction reached, because cooler parts of the cycle no longer
    /// contribute. While the contributing parts remain the same, the increments are a geometric series with a closed
    /// sum. The sum over `n` cycles is accurate to `1e-9` % if the increment of the last cycle exceeds that of the
    /// series by at most `1e-9/n`.
    fn keep(&self, start: f64, cycles: f64) -> Result<f64, LoadError> {
        const TOLERANCE_PERCENT: f64 = 1e-9;
        if self.law.retraction_return() >= 1.0 {
            return Ok(start);
        }
        let added = |kept: f64| {
            let state = State {
                // Retraction does not depend on it, and a ramp of a bedded-in rope takes fewer steps.
                bedding_percent: self.law.bedding_percent(),
                retraction_kept_percent: kept,
                ..State::default()
            };
            self.cycle(state).map(|s| s.retraction_kept_percent - kept)
        };
        let (mut kept, mut left, mut jump) = (start, cycles, cycles);
        let mut next = added(kept)?;
        while left >= 1.0 && next > 1e-12 {
            let last = next;
            (kept, left) = (kept + last, left - 1.0);
            next = added(kept)?;
            let ratio = (next / last).clamp(0.0, 1.0 - 1e-12);
            jump = f64::min(4.0 * jump, left).floor();
            while jump >= 2.0 {
                let end = kept + next * (1.0 - ratio.powf(jump)) / (1.0 - ratio);
                let found = added(end)?;
                if (found - next * ratio.powf(jump)).abs() * jump <= TOLERANCE_PERCENT {
                    (kept, left, next) = (end, left - jump, found);
                    break;
                }
                jump = (0.5 * jump).floor();
            }
            jump = jump.max(1.0);
        }
        Ok(kept)
    }

    /// `db/dn` at bedding-in `b`, %: from the differences of four cycles, `d/dn = ln(1 + Δ) = Δ − Δ²/2 + Δ³/3 − Δ⁴/4 + …`.
    fn slow_rate(&self, rates: &[Option<Rates>], b: f64) -> f64 {
        let mut at = b;
        let [first, second, third, fourth] = [(); 4].map(|()| {
            let from = at;
            for (s, rates) in self.duty.stretches.iter().zip(rates) {
                at = match rates {
                    Some(rates) => self.law.bedded(at, rates, s.duration_s),
                    None => bedded_over(self.law, at, [s.from, s.to], s.duration_s),
                };
            }
            at - from
        });
        ((25.0 * first - 23.0 * second + 13.0 * third - 3.0 * fourth) / 12.0).max(0.0)
    }

    /// Bedding-in after a number of cycles, %.
    fn bedded(&self, skipped: &mut Skipped, cycles: f64) -> f64 {
        loop {
            let [from, to] = skipped.step;
            let left = cycles - to.cycles;
            if left <= 0.0 {
                let x = (cycles / from.cycles).ln() / (to.cycles / from.cycles).ln();
                let [c1, c2, c3, c4] = skipped.between;
                let percent =
                    from.percent + x * (c1 + (1.0 - x) * (c2 + x * (c3 + (1.0 - x) * c4)));
                return percent.max(from.percent).min(to.percent);
            }
            let rest = to.percent_per_cycle * left;
            if rest <= TOLERANCE_END * self.law.bedding_percent() {
                return to.percent + rest;
            }
            self.step(skipped);
        }
    }

    /// Takes one step of the slow equation in the logarithm of the number of cycles, over which the bedding-in of a
    /// jamming rope is nearly a straight line.
    ///
    /// # Source
    /// Dormand and Prince's pair of orders 5 and 4, with the interpolation of order 4 of DOPRI5: Hairer, Nørsett,
    /// Wanner, *Solving Ordinary Differential Equations I*, sections II.5 and II.6.
    fn step(&self, skipped: &mut Skipped) {
        let start = skipped.step[1];
        let (b, n) = (start.percent, start.cycles);
        // Not shorter than one cycle.
        let shortest = n.recip().ln_1p();
        let k1 = n * start.percent_per_cycle;
        loop {
            let h = skipped.length.max(shortest);
            let slope =
                |at: f64, k: f64| n * (at * h).exp() * self.slow_rate(&skipped.rates, b + h * k);
            let k2 = slope(0.2, k1 / 5.0);
            let k3 = slope(0.3, 3.0 / 40.0 * k1 + 9.0 / 40.0 * k2);
            let k4 = slope(0.8, 44.0 / 45.0 * k1 - 56.0 / 15.0 * k2 + 32.0 / 9.0 * k3);
            let k5 = slope(
                8.0 / 9.0,
                19_372.0 / 6561.0 * k1 - 25_360.0 / 2187.0 * k2 + 64_448.0 / 6561.0 * k3
                    - 212.0 / 729.0 * k4,
            );
            let k6 = slope(
                1.0,
                9017.0 / 3168.0 * k1 - 355.0 / 33.0 * k2
                    + 46_732.0 / 5247.0 * k3
                    + 49.0 / 176.0 * k4
                    - 5103.0 / 18_656.0 * k5,
            );
            let mean = 35.0 / 384.0 * k1 + 500.0 / 1113.0 * k3 + 125.0 / 192.0 * k4
                - 2187.0 / 6784.0 * k5
                + 11.0 / 84.0 * k6;
            // Bedding-in never falls.
            let change = (h * mean).max(0.0);
            let end = Bedded {
                cycles: n * h.exp(),
                percent: b + change,
                percent_per_cycle: self.slow_rate(&skipped.rates, b + change),
            };
            let k7 = end.cycles * end.percent_per_cycle;
            let error = 71.0 / 57_600.0 * k1 - 71.0 / 16_695.0 * k3 + 71.0 / 1920.0 * k4
                - 17_253.0 / 339_200.0 * k5
                + 22.0 / 525.0 * k6
                - k7 / 40.0;
            let ratio = (h * error).abs() / (TOLERANCE * self.law.bedding_percent());
            skipped.length = h * (0.9 * ratio.max(1e-9).powf(-0.2)).clamp(0.2, 5.0);
            if !(ratio > 1.0) || h <= shortest {
                let bend = h * k1 - change;
                let fourth = -12_715_105_075.0 / 11_282_082_432.0 * k1
                    + 87_487_479_700.0 / 32_700_410_799.0 * k3
                    - 10_690_763_975.0 / 1_880_347_072.0 * k4
                    + 701_980_252_875.0 / 199_316_789_632.0 * k5
                    - 1_453_857_185.0 / 822_651_844.0 * k6
                    + 69_997_945.0 / 29_380_423.0 * k7;
                skipped.between = [change, bend, change - h * k7 - bend, h * fourth];
                skipped.step = [start, end];
                return;
            }
        }
    }
}

/// Runs the first `duration_s` of a segment.
pub(crate) fn run_stretch(
    law: &Law,
    state: &mut State,
    s: &Stretch,
    duration_s: f64,
) -> Result<(), LoadError> {
    if s.from == s.to {
        return law.hold(state, s.from, duration_s);
    }
    let share = duration_s / s.duration_s;
    let mix = |a: f64, b: f64| a + (b - a) * share;
    let mut to = s.to;
    if share < 1.0 {
        to.tension_n = mix(s.from.tension_n, s.to.tension_n);
        to.temperature_k = mix(s.from.temperature_k, s.to.temperature_k);
    }
    ramp(law, state, s.from, to, duration_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::RopeLoad;
    use crate::{Catalogue, Draws};

    fn law() -> Law {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        Draws::new(rope, 0, 1).expect("complete").nominal
    }

    /// A minute of work at two tensions, warm.
    fn minute() -> Duty {
        let load = |n: f64| RopeLoad::celsius(n, 30.0);
        Duty {
            about: "minute".into(),
            stretches: vec![
                Stretch::hold(load(120.0), 20.0),
                Stretch {
                    from: load(120.0),
                    to: load(40.0),
                    duration_s: 5.0,
                },
                Stretch::hold(load(40.0), 35.0),
            ],
            repeat: true,
        }
    }

    #[test]
    fn skipped_cycles_agree_with_running_them() {
        let law = law();
        let cycle = |seconds: f64| {
            let mut duty = minute();
            duty.stretches
                .iter_mut()
                .for_each(|s| s.duration_s *= seconds / 60.0);
            duty
        };
        // Twenty days of minutes and twelve years of days, each cycle one by one.
        for (cycle_s, cycles) in [(60.0, 28_800), (86_400.0, 4_400)] {
            let duty = cycle(cycle_s);
            let mut history = History::new(&law, &duty, State::default());
            let mut slow = State::default();
            for n in 1..=cycles {
                slow = history.cycle(slow).expect("load");
                if ![29, 31, 40, 100, 400, 1700, 4400, 28_800].contains(&n) {
                    continue;
                }
                let fast = history.after(f64::from(n)).expect("load");
                let close = |x: f64, y: f64, what: &str| {
                    assert!((x - y).abs() < 1e-6, "{what} {cycle_s} s {n}: {x} {y}");
                };
                close(slow.bedding_percent, fast.bedding_percent, "bedding-in");
                for (x, y) in slow.delayed_percent.iter().zip(fast.delayed_percent) {
                    close(*x, y, "delayed");
                }
                close(slow.flow_percent, fast.flow_percent, "flow");
            }
        }
    }

    /// A century takes the steps of a year and a few more.
    #[test]
    fn work_does_not_grow_with_horizon() {
        let (law, duty) = (law(), minute());
        let steps = |years: f64| {
            let mut history = History::new(&law, &duty, State::default());
            history.after(EXACT_CYCLES).expect("load");
            let mut skipped = history.skip().expect("load");
            let (cycles, mut steps) = (years * 525_960.0, 0);
            let is_open = |s: &Skipped| {
                let left = cycles - s.step[1].cycles;
                s.step[1].percent_per_cycle * left > TOLERANCE_END * law.bedding_percent()
            };
            while is_open(&skipped) {
                history.step(&mut skipped);
                steps += 1;
            }
            steps
        };
        let (year, century) = (steps(1.0), steps(100.0));
        assert!(year < 60 && century < year + 20, "{year} {century}");
    }

    /// One minute of sun per hour: permanent retraction, with skipped cycles and one by one.
    #[test]
    fn skipped_cycles_keep_permanent_retraction() {
        let law = law().giving_back(0.4);
        let load = |celsius: f64| RopeLoad::celsius(60.0, celsius);
        let duty = Duty {
            about: "sun".into(),
            stretches: vec![
                Stretch::hold(load(50.0), 20.0),
                Stretch::hold(load(42.0), 40.0),
                Stretch::hold(load(25.0), 3540.0),
            ],
            repeat: true,
        };
        for cycles in [1.0, 3.0, 20.0, 400.0, 9000.0] {
            let history = History::new(&law, &duty, State::default());
            let mut slow = State::default();
            for _ in 0..cycles as usize {
                slow = history.cycle(slow).expect("load");
            }
            let (a, b) = (
                history.keep(0.0, cycles).expect("load"),
                slow.retraction_kept_percent,
            );
            assert!((a - b).abs() < 1e-8, "{cycles}: {a} {b}");
        }
    }

    #[test]
    fn history_does_not_depend_on_query_times() {
        let (law, duty) = (law(), minute());
        let mut once = History::new(&law, &duty, State::default());
        let mut often = once.clone();
        for i in 1..500 {
            often.at(f64::from(i) * 333.3).expect("load");
        }
        let (a, b) = (
            once.at(200_000.0).expect("load"),
            often.at(200_000.0).expect("load"),
        );
        // The step is the same whatever is queried.
        assert!((a.bedding_percent - b.bedding_percent).abs() < 1e-9);
        assert!((a.delayed_percent[3] - b.delayed_percent[3]).abs() < 1e-12);
    }

    #[test]
    fn non_repeating_duty_keeps_last_load() {
        let law = law();
        let duty = Duty {
            repeat: false,
            ..minute()
        };
        let mut history = History::new(&law, &duty, State::default());
        let end = history.at(1e7).expect("load");
        let mut expected = State::default();
        for s in &duty.stretches {
            run_stretch(&law, &mut expected, s, s.duration_s).expect("load");
        }
        law.hold(&mut expected, RopeLoad::celsius(40.0, 30.0), 1e7 - 60.0)
            .expect("load");
        assert!((end.bedding_percent - expected.bedding_percent).abs() < 1e-14);
    }
}
