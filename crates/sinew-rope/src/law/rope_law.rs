//! Exact solution of the creep law for one step of constant load.

use super::exponential::exp;
use super::factors::{Heat, closed, delayed_fractions, sinh};
use super::{
    CELSIUS_ZERO_K, LoadError, ParameterError, Parameters, REFERENCE_K, State, Strain, bedding,
};

/// Heat retraction begins here, K.
pub(super) const RETRACTION_START_K: f64 = CELSIUS_ZERO_K + 35.0;
/// Heat retraction is full from here on, K.
pub(super) const RETRACTION_FULL_K: f64 = CELSIUS_ZERO_K + 60.0;
/// Temperatures taken, K: −100 to 200 °C. None of the fibres is one beyond.
const TEMPERATURE_K: core::ops::RangeInclusive<f64> = 173.15..=473.15;
/// Longest duration of one step, s: 300 years.
const DURATION_MAX_S: f64 = 1e10;

/// Tension and temperature of one section of rope.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RopeLoad {
    /// Tension, N, at least 0.
    pub tension_n: f64,
    /// Temperature of the rope, K.
    pub temperature_k: f64,
}

impl RopeLoad {
    /// A tension at a temperature in °C.
    #[must_use]
    pub fn celsius(tension_n: f64, temperature_c: f64) -> Self {
        Self {
            tension_n,
            temperature_k: temperature_c + CELSIUS_ZERO_K,
        }
    }

    /// A tension at the reference temperature, 23 °C.
    #[must_use]
    pub fn at_reference(tension_n: f64) -> Self {
        Self {
            tension_n,
            temperature_k: REFERENCE_K,
        }
    }
}

/// Targets and rates of the elements under one load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// Target of the bedding-in `b∞`, %.
    pub bedding_target_percent: f64,
    /// Rate of the bedding-in `a_b/τ_b`, 1/s.
    pub bedding_per_s: f64,
    /// `J(θ) λ`, %.
    pub delayed_target_percent: f64,
    /// `a_v`: factor on `1/τ_i`.
    pub delayed_speed: f64,
    /// Rate of the flow `ḟ`, %/s.
    pub flow_percent_per_s: f64,
    /// `S g(θ) exp(−λ/λ_s)`, %.
    pub retraction_target_percent: f64,
}

/// Creep law of one section of rope: parameters and passes over guiding pulleys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    pub(super) p: Parameters,
    guides: f64,
    /// Full bedding-in `B'`, %.
    bedding_percent: f64,
    /// `ρ`: share of a heat retraction that is recovered on cooling.
    retraction_return: f64,
    inverse: Inverse,
}

/// Reciprocals of the divisors of a step: a division costs as much as half an exponential.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Inverse {
    breaking_load_per_n: f64,
    bedding_load_ratio: f64,
    bedding_per_s: f64,
    retraction_per_s: f64,
    retraction_load_ratio: f64,
    /// Stress ratio `σ_b/σ₀`.
    flow_stress_ratio: f64,
}

impl Law {
    /// The law of a rope that no guiding pulley passes over.
    ///
    /// # Errors
    /// [`ParameterError`] with the first value out of its range.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        parameters.check()?;
        Ok(Self {
            p: parameters,
            guides: 0.0,
            bedding_percent: parameters.bedding_percent,
            retraction_return: 1.0,
            inverse: Inverse {
                breaking_load_per_n: 1.0 / parameters.breaking_load_n,
                bedding_load_ratio: 1.0 / parameters.bedding_load_ratio,
                bedding_per_s: 1.0 / parameters.bedding_time_s,
                retraction_per_s: 1.0 / parameters.retraction_time_s,
                retraction_load_ratio: 1.0 / parameters.retraction_load_ratio,
                flow_stress_ratio: parameters.breaking_stress_mpa / parameters.flow_stress_mpa,
            },
        })
    }

    /// Sets the passes `guides` over guiding pulleys, each times its cost ([`super::damage::passes`]):
    /// `B' = B (1 + g_N N^q)`. A number that is negative or not finite counts as 0.
    #[must_use]
    pub fn passed_by(mut self, guides: f64) -> Self {
        self.guides = if guides.is_finite() {
            guides.max(0.0)
        } else {
            0.0
        };
        let gain = if self.guides > 0.0 {
            // More pulleys than this do not fit along a rope, and the power stays finite.
            self.p.pass_gain * libm::pow(self.guides.min(1e6), self.p.pass_exponent)
        } else {
            0.0
        };
        self.bedding_percent = self.p.bedding_percent * (1.0 + gain);
        self
    }

    /// Sets the share `ρ` of every heat retraction that is recovered when the rope cools or the tension
    /// rises; the rest is permanent. The default is 1. No value is published; `ρ` is limited to 0 … 1.
    #[must_use]
    pub fn giving_back(mut self, share: f64) -> Self {
        self.retraction_return = if share > 0.0 { share.min(1.0) } else { 0.0 };
        self
    }

    /// Multiplies the elastic strain by a factor above 0: model error of the stiffness.
    #[must_use]
    pub(crate) fn with_stiffness_error(mut self, factor: f64) -> Self {
        self.p.elastic_k /= factor;
        self.p.toe_percent *= factor;
        self
    }

    /// `ρ`: share of a heat retraction that is recovered on cooling.
    #[must_use]
    pub fn retraction_return(&self) -> f64 {
        self.retraction_return
    }

    /// Parameters of the law.
    #[must_use]
    pub fn parameters(&self) -> &Parameters {
        &self.p
    }

    /// `N`: passes of this section over guiding pulleys, each times its cost.
    #[must_use]
    pub fn guides(&self) -> f64 {
        self.guides
    }

    /// `B'`: full bedding-in of this section, %.
    #[must_use]
    pub fn bedding_percent(&self) -> f64 {
        self.bedding_percent
    }

    /// `λ`: tension over breaking load.
    #[must_use]
    pub fn load_ratio(&self, tension_n: f64) -> f64 {
        tension_n * self.inverse.breaking_load_per_n
    }

    /// Advances the state under a constant load for a duration: every element is solved exactly.
    ///
    /// Bedding-in by [`bedding::closed_fraction`], delayed elasticity and retraction as
    /// exponentials, flow as a straight line. However a duration is cut, the state at its end is
    /// the same to rounding.
    ///
    /// * `duration_s`: 0 to 1e10 s.
    ///
    /// # Errors
    /// [`LoadError`]; the state is unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn hold(
        &self,
        state: &mut State,
        load: RopeLoad,
        duration_s: f64,
    ) -> Result<(), LoadError> {
        self.check(load)?;
        check_duration(duration_s)?;
        if !state.is_possible() {
            return Err(LoadError::State);
        }
        let rates = self.rates_at(self.load_ratio(load.tension_n), load.temperature_k);
        self.go(state, &rates, duration_s);
        Ok(())
    }

    /// Computes the targets and rates of the elements under a load, once for many steps of [`Law::advance`].
    ///
    /// # Errors
    /// Returns [`LoadError`] if the tension or the temperature is invalid.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn rates(&self, load: RopeLoad) -> Result<Rates, LoadError> {
        self.check(load)?;
        Ok(self.rates_at(self.load_ratio(load.tension_n), load.temperature_k))
    }

    /// Advances the state as [`Law::hold`], with precomputed rates.
    ///
    /// # Errors
    /// Returns [`LoadError::Duration`] or [`LoadError::State`]; the state is then unchanged.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn advance(
        &self,
        state: &mut State,
        rates: &Rates,
        duration_s: f64,
    ) -> Result<(), LoadError> {
        check_duration(duration_s)?;
        if !state.is_possible() {
            return Err(LoadError::State);
        }
        self.go(state, rates, duration_s);
        Ok(())
    }

    /// Advances every element at constant rates; rates and duration are already checked.
    fn go(&self, state: &mut State, rates: &Rates, duration_s: f64) {
        let target = rates.bedding_target_percent;
        self.bed_in(state, target, rates.bedding_per_s, duration_s);
        self.delay(
            state,
            rates.delayed_target_percent,
            rates.delayed_speed,
            duration_s,
        );
        state.flow_percent += rates.flow_percent_per_s * duration_s;
        self.retract(state, rates.retraction_target_percent, duration_s);
    }

    /// Bedding-in after a duration, %: [`Law::advance`] without the elements that do not affect it.
    /// Starts from `bedding_percent`; a duration below 0 or not a number counts as 0.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    #[must_use]
    pub fn bedded(&self, bedding_percent: f64, rates: &Rates, duration_s: f64) -> f64 {
        let mut state = State {
            bedding_percent,
            ..State::default()
        };
        let target = rates.bedding_target_percent;
        self.bed_in(&mut state, target, rates.bedding_per_s, duration_s.max(0.0));
        state.bedding_percent
    }

    /// Strain of a section of rope in a state under a load.
    ///
    /// # Errors
    /// [`LoadError`].
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn strain(&self, state: &State, load: RopeLoad) -> Result<Strain, LoadError> {
        self.check(load)?;
        let lambda = self.load_ratio(load.tension_n);
        Ok(Strain {
            elastic_percent: self.elastic_percent(lambda),
            bedding_percent: state.bedding_percent,
            delayed_percent: state.delayed_percent.iter().sum(),
            flow_percent: state.flow_percent,
            retraction_percent: state.retraction_percent + state.retraction_kept_percent,
            thermal_percent: 100.0 * self.p.expansion_per_k * (load.temperature_k - REFERENCE_K),
        })
    }

    /// Slope of the elastic strain, % per N, for a small, fast change of tension.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn compliance_percent_per_n(&self, load: RopeLoad) -> Result<f64, LoadError> {
        self.check(load)?;
        let slope = self.elastic_slope_percent(self.load_ratio(load.tension_n));
        Ok(slope / self.p.breaking_load_n)
    }

    /// `ε_el` at a load ratio, %.
    pub(super) fn elastic_percent(&self, lambda: f64) -> f64 {
        100.0 * lambda / self.p.elastic_k
            - self.p.toe_percent * libm::expm1(-lambda / self.p.toe_load_ratio)
    }

    /// Elastic slope `dε_el/dλ`, %.
    pub(super) fn elastic_slope_percent(&self, lambda: f64) -> f64 {
        let toe = self.p.toe_percent / self.p.toe_load_ratio * exp(-lambda / self.p.toe_load_ratio);
        100.0 / self.p.elastic_k + toe
    }

    pub(super) fn check(&self, load: RopeLoad) -> Result<(), LoadError> {
        let RopeLoad {
            tension_n,
            temperature_k,
        } = load;
        if !tension_n.is_finite() {
            return Err(LoadError::TensionNotFinite);
        }
        if tension_n < 0.0 {
            return Err(LoadError::NegativeTension { tension_n });
        }
        if tension_n > self.p.breaking_load_n {
            return Err(LoadError::Broken {
                tension_n,
                breaking_load_n: self.p.breaking_load_n,
            });
        }
        if !TEMPERATURE_K.contains(&temperature_k) {
            return Err(LoadError::Temperature { temperature_k });
        }
        Ok(())
    }

    /// Rates at a checked load ratio and temperature: six exponentials abreast, most of the cost
    /// of a step.
    pub(super) fn rates_at(&self, lambda: f64, temperature_k: f64) -> Rates {
        let (p, inverse) = (&self.p, &self.inverse);
        let heat = Heat::new(temperature_k);
        let stress = lambda * inverse.flow_stress_ratio;
        let [unbedded, bedding, delayed, flow, stressed, shrunk] = [
            -lambda * inverse.bedding_load_ratio,
            heat.exponent(p.bedding_energy_j_per_mol),
            heat.exponent(p.delayed_energy_j_per_mol),
            heat.exponent(p.flow_energy_j_per_mol),
            stress,
            -lambda * inverse.retraction_load_ratio,
        ]
        .map(exp);
        Rates {
            bedding_target_percent: self.bedding_percent * (1.0 - unbedded),
            bedding_per_s: bedding * inverse.bedding_per_s,
            delayed_target_percent: self.delayed_target(lambda, temperature_k),
            delayed_speed: delayed,
            flow_percent_per_s: 100.0 * p.flow_rate_per_s * flow * sinh(stress, stressed),
            retraction_target_percent: self.retraction_full(temperature_k) * shrunk,
        }
    }

    pub(super) fn bedding_per_s(&self, heat: Heat) -> f64 {
        heat.speed_up(self.p.bedding_energy_j_per_mol) * self.inverse.bedding_per_s
    }

    pub(super) fn bedding_target(&self, lambda: f64) -> f64 {
        self.bedding_percent * (1.0 - exp(-lambda * self.inverse.bedding_load_ratio))
    }

    pub(super) fn delayed_target(&self, lambda: f64, temperature_k: f64) -> f64 {
        let warm = 1.0 + self.p.delayed_per_k * (temperature_k - REFERENCE_K);
        self.p.delayed_percent * warm.max(0.0) * lambda
    }

    pub(super) fn retraction_target(&self, lambda: f64, temperature_k: f64) -> f64 {
        match self.retraction_full(temperature_k) {
            0.0 => 0.0,
            full => full * exp(-lambda * self.inverse.retraction_load_ratio),
        }
    }

    /// Retraction of a slack rope at a temperature, %.
    fn retraction_full(&self, temperature_k: f64) -> f64 {
        if temperature_k <= RETRACTION_START_K {
            return 0.0;
        }
        self.p.retraction_percent * retraction_share(temperature_k)
    }

    pub(super) fn bed_in(&self, state: &mut State, target: f64, per_s: f64, duration_s: f64) {
        let gap = target - state.bedding_percent;
        // Below the last digit of b nothing moves any more.
        if gap <= 1e-17 * self.bedding_percent {
            return;
        }
        let per_percent = self.p.jamming / self.bedding_percent;
        let jam = exp(-per_percent * state.bedding_percent);
        let rate = per_s * jam * duration_s;
        // What closes is less than this. A rope that lies under one load keeps a few last digits of a gap that no step
        // can close, and a year of minutes would compute them each time.
        let most = state.bedding_percent + gap * rate.min(1.0);
        if most == state.bedding_percent {
            return;
        }
        let closed = bedding::closed_fraction(per_percent * gap, rate);
        let b = state.bedding_percent + gap * closed;
        state.bedding_percent = b.min(target).max(state.bedding_percent);
    }

    fn delay(&self, state: &mut State, target: f64, speed: f64, duration_s: f64) {
        let closed = delayed_fractions(speed * duration_s);
        for (v, closed) in state.delayed_percent.iter_mut().zip(closed) {
            *v += (target - *v) * closed;
        }
    }

    fn retract(&self, state: &mut State, target: f64, duration_s: f64) {
        let gap = self.retraction_return * target - state.retraction_percent;
        let kept = (1.0 - self.retraction_return) * target - state.retraction_kept_percent;
        if gap != 0.0 || kept > 0.0 {
            let closed = closed(duration_s * self.inverse.retraction_per_s);
            state.retraction_percent += gap * closed;
            state.retraction_kept_percent += kept.max(0.0) * closed;
        }
    }
}

/// `g(θ)`: share of the full heat retraction that a temperature drives to: 0 below 35 °C, 1 from 60 °C on.
///
/// # Realtime
/// No allocation, lock, panic or clock.
#[must_use]
pub fn retraction_share(temperature_k: f64) -> f64 {
    const PER_K: f64 = 1.0 / (RETRACTION_FULL_K - RETRACTION_START_K);
    ((temperature_k - RETRACTION_START_K) * PER_K).clamp(0.0, 1.0)
}

pub(super) fn check_duration(duration_s: f64) -> Result<(), LoadError> {
    if (0.0..=DURATION_MAX_S).contains(&duration_s) {
        Ok(())
    } else {
        Err(LoadError::Duration { duration_s })
    }
}
