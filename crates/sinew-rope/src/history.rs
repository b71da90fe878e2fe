//! A rope under a periodic duty for years, without stepping through each cycle.
//!
//! Over a repeated cycle delayed elasticity and retraction are affine maps (`v ↦ a v + c`), so
//! any number of cycles is one closed form; flow adds the same each time. Bedding-in alone is
//! nonlinear: its change per cycle, `D(b)`, becomes a slow differential equation once it is small.
//! The first cycles are always run one by one.

use super::Duty;
use super::duty::Stretch;
use crate::law::{Law, LoadError, Rates, State, ramp};

/// Number of segments that are run one by one before the slow equation is used.
const EXACT_STRETCHES: f64 = 1_000.0;
/// Minimum number of cycles that are run one by one.
const EXACT_CYCLES: f64 = 30.0;
/// Relative error of one step of the slow equation.
const TOLERANCE: f64 = 1e-6;

/// Progress of a rope through a duty.
#[derive(Debug, Clone)]
pub struct History<'a> {
    law: &'a Law,
    duty: &'a Duty,
    cycle_s: f64,
    /// Rates of the segments of constant load; computed before cycles are skipped.
    rates: Vec<Option<Rates>>,
    /// State of the rope at the start of the current cycle.
    state: State,
    time_s: f64,
    whole_cycles: f64,
}

impl<'a> History<'a> {
    /// Starts from a state at the beginning of a duty.
    pub fn new(law: &'a Law, duty: &'a Duty, state: State) -> Self {
        Self {
            law,
            duty,
            cycle_s: duty.stretches.iter().map(|s| s.duration_s).sum(),
            rates: Vec::new(),
            state,
            time_s: 0.0,
            whole_cycles: 0.0,
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
        self.advance_cycles(cycles - self.whole_cycles)?;
        self.whole_cycles = self.whole_cycles.max(cycles);
        let mut state = self.state;
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

    fn advance_cycles(&mut self, cycles: f64) -> Result<(), LoadError> {
        let mut left = cycles;
        let exact = (EXACT_STRETCHES / self.duty.stretches.len() as f64).max(EXACT_CYCLES);
        while left >= 1.0 && self.whole_cycles < exact {
            self.state = self.cycle(self.state)?;
            self.whole_cycles += 1.0;
            left -= 1.0;
        }
        if left >= 1.0 {
            self.leap(left)?;
            self.whole_cycles += left;
        }
        Ok(())
    }

    /// Advances the state by many cycles in one step.
    fn leap(&mut self, cycles: f64) -> Result<(), LoadError> {
        let start = self.state;
        if self.rates.is_empty() {
            let rates = |s: &Stretch| (s.from == s.to).then(|| self.law.rates(s.from)).transpose();
            self.rates = self
                .duty
                .stretches
                .iter()
                .map(rates)
                .collect::<Result<_, _>>()?;
        }
        // Slope and constant of each affine map, from two runs that share everything else.
        let zero = State {
            bedding_percent: start.bedding_percent,
            ..State::default()
        };
        let one = State {
            delayed_percent: [1.0; 5],
            retraction_percent: 1.0,
            ..zero
        };
        let (from_zero, from_one) = (self.cycle(zero)?, self.cycle(one)?);
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
        let mut end = start;
        for i in 0..5 {
            end.delayed_percent[i] = leap(
                start.delayed_percent[i],
                from_zero.delayed_percent[i],
                from_one.delayed_percent[i],
            );
        }
        end.retraction_percent = leap(
            start.retraction_percent,
            from_zero.retraction_percent,
            from_one.retraction_percent,
        );
        end.retraction_kept_percent = self.keep(start.retraction_kept_percent, cycles)?;
        end.flow_percent = start.flow_percent + cycles * from_zero.flow_percent;
        end.bedding_percent = self.bed_in_slowly(start.bedding_percent, cycles)?;
        self.state = end;
        Ok(())
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

    /// `db/dn` at bedding-in `b`: the increment of a cycle with the second-order correction of a difference to a
    /// derivative, `D (1 − D'/2)`.
    fn slow_rate(&self, b: f64) -> Result<f64, LoadError> {
        // Bedding-in minds nothing of the rest of the state.
        let added = |from: f64| {
            let mut b = from;
            for (s, rates) in self.duty.stretches.iter().zip(&self.rates) {
                b = match rates {
                    Some(rates) => self.law.bedded(b, rates, s.duration_s),
                    None => {
                        let mut state = State {
                            bedding_percent: b,
                            ..State::default()
                        };
                        run_stretch(self.law, &mut state, s, s.duration_s)?;
                        state.bedding_percent
                    }
                };
            }
            Ok(b - from)
        };
        let d = added(b)?;
        if d <= 0.0 {
            return Ok(0.0);
        }
        let slope = (added(b + d)? - d) / d;
        Ok(d * (1.0 - 0.5 * slope))
    }

    /// Bedding-in after many cycles: second-order steps of controlled size.
    fn bed_in_slowly(&self, mut b: f64, cycles: f64) -> Result<f64, LoadError> {
        let full = self.law.bedding_percent();
        let mut left = cycles;
        let mut h = 1.0f64;
        // The rate at the end of a step is the one at the start of the next.
        let mut k1 = self.slow_rate(b)?;
        while left > 0.0 {
            h = h.min(left);
            // The remaining change is below the resolution of the results.
            if k1 * left <= 1e-9 * full {
                return Ok(b + k1 * left);
            }
            let k2 = self.slow_rate(b + 0.5 * h * k1)?;
            let k3 = self.slow_rate(b + 0.75 * h * k2)?;
            let next = b + h / 9.0 * (2.0 * k1 + 3.0 * k2 + 4.0 * k3);
            let k4 = self.slow_rate(next)?;
            // Bogacki and Shampine's 3(2) pair.
            let error = h * (-5.0 / 72.0 * k1 + k2 / 12.0 + k3 / 9.0 - k4 / 8.0);
            let ratio = error.abs() / (TOLERANCE * full);
            if ratio <= 1.0 || h <= 1.0 {
                k1 = if next > b { k4 } else { self.slow_rate(b)? };
                b = next.max(b);
                left -= h;
            }
            h = (h * (0.9 * ratio.max(1e-9).powf(-1.0 / 3.0)).clamp(0.2, 5.0)).max(1.0);
        }
        Ok(b)
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
    fn leaping_over_cycles_agrees_with_running_them() {
        let (law, duty) = (law(), minute());
        let mut slow = History::new(&law, &duty, State::default());
        let mut fast = slow.clone();
        // Twenty days one by one, against a leap after the first thirty cycles.
        let (start, end) = (30.0, 28_800.0);
        for _ in 0..30 {
            fast.state = fast.cycle(fast.state).expect("load");
        }
        fast.leap(end - start).expect("load");
        for _ in 0..28_800 {
            slow.state = slow.cycle(slow.state).expect("load");
        }
        let (a, b) = (slow.state, fast.state);
        let close = |x: f64, y: f64, what: &str| assert!((x - y).abs() < 1e-6, "{what} {x} {y}");
        close(a.bedding_percent, b.bedding_percent, "bedding-in");
        for (x, y) in a.delayed_percent.iter().zip(b.delayed_percent) {
            close(*x, y, "delayed");
        }
        close(a.flow_percent, b.flow_percent, "flow");
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
            let mut fast = History::new(&law, &duty, State::default());
            fast.leap(cycles).expect("load");
            let mut slow = State::default();
            for _ in 0..cycles as usize {
                slow = fast.cycle(slow).expect("load");
            }
            let (a, b) = (
                fast.state.retraction_kept_percent,
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
        // Leaps of other lengths: the tolerance of the slow equation, some steps of it.
        assert!((a.bedding_percent - b.bedding_percent).abs() < 1e-5);
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
