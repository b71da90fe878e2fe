//! A segment of time over which tension and temperature change linearly.

use super::factors::{Heat, closed, delayed_fractions};
use super::rope_law::{RETRACTION_FULL_K, RETRACTION_START_K, check_duration};
use super::{DELAY_TIMES_S, Law, LoadError, RopeLoad, State};

/// Maximum error of a ramp in any part of the strain, %: a thousandth of the tolerance in the comparison with a
/// reference integrator.
pub const RAMP_TOLERANCE_PERCENT: f64 = 1e-9;

/// Minimum share of the tolerance for a short step, so that a kink does not stop the integration.
const SHARE_MIN: f64 = 0.02;
/// Steps are not made shorter than this share of the ramp.
const SHORTEST: f64 = 1e-9;
/// Maximum number of steps; a ramp over years with every change of regime takes several thousand.
const STEPS_MAX: usize = 4_000_000;

/// Linear ramp of load and temperature over its whole duration.
struct Ramp<'a> {
    law: &'a Law,
    lambda: (f64, f64),
    temperature_k: (f64, f64),
    duration_s: f64,
    /// Whether the elements other than the bedding-in are ignored.
    is_bedding_only: bool,
}

/// Advances the state while tension and temperature change linearly from one load to another.
///
/// Delayed elasticity and retraction follow the straight line exactly, bedding-in and flow
/// take the middle of each step; the whole step is symmetric in time, so two extrapolations
/// over halved steps raise it to sixth order. Steps are chosen so that the difference between
/// fourth and sixth order, summed over the ramp, stays within [`RAMP_TOLERANCE_PERCENT`];
/// ramps are divided at the kinks of the retraction and at the onset of bedding-in.
///
/// * `duration_s`: 0 to 1e10 s; 0 changes nothing.
///
/// # Errors
/// [`LoadError`]; the state is unchanged.
///
/// # Realtime
/// No allocation, lock or panic; the number of steps depends on the ramp.
pub fn ramp(
    law: &Law,
    state: &mut State,
    from: RopeLoad,
    to: RopeLoad,
    duration_s: f64,
) -> Result<(), LoadError> {
    law.check(from)?;
    law.check(to)?;
    if from == to {
        return law.hold(state, from, duration_s);
    }
    check_duration(duration_s)?;
    if !state.is_possible() {
        return Err(LoadError::State);
    }
    if duration_s == 0.0 {
        return Ok(());
    }
    Ramp::new(law, [from, to], duration_s, false).run(state);
    Ok(())
}

/// Bedding-in after a linear change between two valid loads, %: [`ramp`] without the elements that do not affect it.
///
/// # Realtime
/// No allocation, lock or panic; the number of steps depends on the ramp.
pub(crate) fn bedded_over(
    law: &Law,
    bedding_percent: f64,
    loads: [RopeLoad; 2],
    duration_s: f64,
) -> f64 {
    let mut state = State {
        bedding_percent,
        ..State::default()
    };
    Ramp::new(law, loads, duration_s, true).run(&mut state);
    state.bedding_percent
}

impl<'a> Ramp<'a> {
    fn new(law: &'a Law, loads: [RopeLoad; 2], duration_s: f64, is_bedding_only: bool) -> Self {
        let [from, to] = loads;
        Self {
            law,
            lambda: (law.load_ratio(from.tension_n), law.load_ratio(to.tension_n)),
            temperature_k: (from.temperature_k, to.temperature_k),
            duration_s,
            is_bedding_only,
        }
    }

    fn run(&self, state: &mut State) {
        let mut at = 0.0;
        for cut in self.cuts(state) {
            if cut > at {
                self.follow(state, at, cut);
                at = cut;
            }
        }
    }

    fn lambda(&self, x: f64) -> f64 {
        (self.lambda.0 + (self.lambda.1 - self.lambda.0) * x).max(0.0)
    }

    fn temperature(&self, x: f64) -> f64 {
        self.temperature_k.0 + (self.temperature_k.1 - self.temperature_k.0) * x
    }

    /// Shares of the ramp at which something sets in, rising, the last one 1.
    fn cuts(&self, state: &State) -> [f64; 4] {
        let share = |from: f64, to: f64, at: f64| {
            let x = (at - from) / (to - from);
            if x > 0.0 && x < 1.0 { x } else { 1.0 }
        };
        let (t0, t1) = self.temperature_k;
        // b∞ reaches b: λ = −λ_b ln(1 − b/B').
        let full = self.law.bedding_percent();
        let onset = if full > 0.0 && state.bedding_percent < full {
            let lambda =
                -self.law.p.bedding_load_ratio * libm::log1p(-state.bedding_percent / full);
            share(self.lambda.0, self.lambda.1, lambda)
        } else {
            1.0
        };
        let mut cuts = [
            share(t0, t1, RETRACTION_START_K),
            share(t0, t1, RETRACTION_FULL_K),
            onset,
            1.0,
        ];
        cuts.sort_unstable_by(f64::total_cmp);
        cuts
    }

    /// Goes from share `at` to share `end` in steps of controlled error.
    fn follow(&self, state: &mut State, mut at: f64, end: f64) {
        let mut h = end - at;
        for _ in 0..STEPS_MAX {
            h = h.min(end - at);
            let mut coarse = *state;
            self.step(&mut coarse, at, h);
            let mut middle = *state;
            for i in 0..2 {
                self.step(&mut middle, at + f64::from(i) * 0.5 * h, 0.5 * h);
            }
            let mut fine = *state;
            for i in 0..4 {
                self.step(&mut fine, at + f64::from(i) * 0.25 * h, 0.25 * h);
            }
            let (mut best, mut error) = extrapolate(state, &coarse, &middle, &fine);
            // Where b∞ comes down and meets b, the bedding-in ends with a kink: extrapolation
            // and its error are blind there. What is left to bed in bounds both.
            let gap = self.law.bedding_target(self.lambda(at)) - state.bedding_percent;
            let closes = self.law.bedding_target(self.lambda(at + h)) <= fine.bedding_percent;
            if gap > 0.0 && closes {
                best.bedding_percent = fine.bedding_percent;
                let rate = self.bedding_per_s_max(at, h);
                error = error.max(gap * (rate * h * self.duration_s).min(1.0));
            }
            // The same where the target of the retraction that stays comes down and meets it.
            let stays = 1.0 - self.law.retraction_return();
            let kept = |x: f64| {
                stays
                    * self
                        .law
                        .retraction_target(self.lambda(x), self.temperature(x))
            };
            let gap = match self.is_bedding_only {
                true => 0.0,
                false => kept(at) - state.retraction_kept_percent,
            };
            if gap > 0.0 && kept(at + h) <= fine.retraction_kept_percent {
                best.retraction_kept_percent = fine.retraction_kept_percent;
                let share = h * self.duration_s / self.law.p.retraction_time_s;
                error = error.max(gap * share.min(1.0));
            }
            let allowed = RAMP_TOLERANCE_PERCENT * h.max(SHARE_MIN);
            if error <= allowed || h <= SHORTEST {
                *state = best;
                at += h;
                if end - at <= 1e-15 {
                    return;
                }
            }
            // Fourth order: the error of a step goes with h⁵.
            let wish = 0.85 * libm::pow(allowed / error.max(1e-30), 0.2);
            h *= wish.clamp(0.1, 5.0);
            h = h.max(SHORTEST);
        }
        // Not reached by any ramp tried; ends the ramp coarsely rather than never.
        self.step(state, at, end - at);
    }

    /// Upper bound of `a_b/τ_b` over a step, 1/s.
    fn bedding_per_s_max(&self, at: f64, h: f64) -> f64 {
        let warm = self.temperature(at).max(self.temperature(at + h));
        self.law.bedding_per_s(Heat::new(warm))
    }

    /// Takes one symmetric step from share `at` over share `h`.
    fn step(&self, state: &mut State, at: f64, h: f64) {
        let law = self.law;
        let dt = h * self.duration_s;
        if self.is_bedding_only {
            let middle = at + 0.5 * h;
            let per_s = law.bedding_per_s(Heat::new(self.temperature(middle)));
            law.bed_in(state, law.bedding_target(self.lambda(middle)), per_s, dt);
            return;
        }
        let (l0, l1) = (self.lambda(at), self.lambda(at + h));
        let (k0, k1) = (self.temperature(at), self.temperature(at + h));
        let rates = law.rates_at(self.lambda(at + 0.5 * h), self.temperature(at + 0.5 * h));
        law.bed_in(state, rates.bedding_target_percent, rates.bedding_per_s, dt);
        let (u0, u1) = (law.delayed_target(l0, k0), law.delayed_target(l1, k1));
        let x = rates.delayed_speed * dt;
        let fractions = delayed_fractions(x);
        for ((v, fraction), tau) in state
            .delayed_percent
            .iter_mut()
            .zip(fractions)
            .zip(DELAY_TIMES_S)
        {
            *v = lag(*v, u0, u1, fraction, left_over(fraction, x / tau));
        }
        state.flow_percent += rates.flow_percent_per_s * dt;
        let targets = (law.retraction_target(l0, k0), law.retraction_target(l1, k1));
        if targets != (0.0, 0.0) || state.retraction_percent != 0.0 {
            let x = dt / law.p.retraction_time_s;
            let closed = closed(x);
            retract(law, state, targets, (closed, left_over(closed, x)));
        }
    }
}

/// Heat retraction over a step with a linear target: the recoverable part follows the target, and the permanent part
/// only increases. `(closed, mean)` as of [`lag`].
pub(super) fn retract(
    law: &Law,
    state: &mut State,
    (u0, u1): (f64, f64),
    (closed, mean): (f64, f64),
) {
    let back = law.retraction_return();
    state.retraction_percent = lag(state.retraction_percent, back * u0, back * u1, closed, mean);
    if back < 1.0 {
        let kept = state.retraction_kept_percent;
        let stays = 1.0 - back;
        state.retraction_kept_percent = lag(kept, stays * u0, stays * u1, closed, mean).max(kept);
    }
}

/// First-order lag with an input going linearly from `u0` to `u1`: exact. `closed` is
/// `1 − e^(−x)` of the step, `mean` its [`left_over`].
pub(super) fn lag(y: f64, u0: f64, u1: f64, closed: f64, mean: f64) -> f64 {
    y + (u0 - y) * closed + (u1 - u0) * (1.0 - mean)
}

/// Mean of `e^(−x)` over a step, `(1 − e^(−x))/x`; `1 − x/2 + x²/6` in the limit.
pub(super) fn left_over(closed: f64, x: f64) -> f64 {
    if x > 1e-5 {
        closed / x
    } else {
        1.0 - x * (0.5 - x / 6.0)
    }
}

/// Sixth order from steps, half steps and quarter steps, and its distance to fourth order.
pub(super) fn extrapolate(
    start: &State,
    coarse: &State,
    middle: &State,
    fine: &State,
) -> (State, f64) {
    let mut error = 0.0f64;
    let mut best = |a: f64, b: f64, c: f64| {
        let ab = b + (b - a) / 3.0;
        let bc = c + (c - b) / 3.0;
        let abc = bc + (bc - ab) / 15.0;
        error = error.max((abc - bc).abs());
        abc.max(0.0)
    };
    let mut out = *start;
    // Extrapolation may undershoot by the error; what never falls must not.
    out.bedding_percent = best(
        coarse.bedding_percent,
        middle.bedding_percent,
        fine.bedding_percent,
    )
    .max(start.bedding_percent);
    for i in 0..5 {
        out.delayed_percent[i] = best(
            coarse.delayed_percent[i],
            middle.delayed_percent[i],
            fine.delayed_percent[i],
        );
    }
    out.flow_percent =
        best(coarse.flow_percent, middle.flow_percent, fine.flow_percent).max(start.flow_percent);
    out.retraction_percent = best(
        coarse.retraction_percent,
        middle.retraction_percent,
        fine.retraction_percent,
    );
    out.retraction_kept_percent = best(
        coarse.retraction_kept_percent,
        middle.retraction_kept_percent,
        fine.retraction_kept_percent,
    )
    .max(start.retraction_kept_percent);
    (out, error)
}
