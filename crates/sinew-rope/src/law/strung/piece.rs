//! One piece of rope over one step of linear tension.

use super::super::factors::{Heat, closed, delayed_fractions, sinh};
use super::super::ramp::{lag, left_over, retract};
use super::super::{DELAY_TIMES_S, Law, State};

/// A piece of rope that the same guides pass over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Creep law of the piece.
    pub law: Law,
    /// Length of the piece, m.
    pub length_m: f64,
    /// Internal state of the piece.
    pub state: State,
}

/// Response factors of a step of one duration at one temperature, for any tension.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lags {
    duration_s: f64,
    temperature_k: f64,
    /// Pairs of the response `1 − exp(−t/τ)` and the mean of its remainder, for the five delayed elements.
    delayed: [(f64, f64); 5],
    retraction: (f64, f64),
    bedding_per_s: f64,
    /// `100 A₀ a_f`, %/s.
    flow_percent_per_s: f64,
}

impl Piece {
    pub(super) fn lags(&self, temperature_k: f64, duration_s: f64) -> Lags {
        let p = &self.law.p;
        let heat = Heat::new(temperature_k);
        let speed = heat.speed_up(p.delayed_energy_j_per_mol) * duration_s;
        let fractions = delayed_fractions(speed);
        let mut delayed = [(0.0, 0.0); 5];
        for ((lag, closed), tau) in delayed.iter_mut().zip(fractions).zip(DELAY_TIMES_S) {
            *lag = (closed, left_over(closed, speed / tau));
        }
        let x = duration_s / p.retraction_time_s;
        let shrunk = closed(x);
        Lags {
            duration_s,
            temperature_k,
            delayed,
            retraction: (shrunk, left_over(shrunk, x)),
            bedding_per_s: self.law.bedding_per_s(heat),
            flow_percent_per_s: 100.0 * p.flow_rate_per_s * heat.speed_up(p.flow_energy_j_per_mol),
        }
    }

    /// State after a step: delayed elasticity and retraction follow the straight line exactly,
    /// bedding-in and flow take its middle.
    pub(super) fn after(&self, lags: &Lags, (from_n, to_n): (f64, f64)) -> State {
        let law = &self.law;
        let (l0, l1) = (law.load_ratio(from_n), law.load_ratio(to_n));
        let middle = 0.5 * (l0 + l1);
        let kelvin = lags.temperature_k;
        let mut state = self.state;
        let target = law.bedding_target(middle);
        law.bed_in(&mut state, target, lags.bedding_per_s, lags.duration_s);
        let (u0, u1) = (
            law.delayed_target(l0, kelvin),
            law.delayed_target(l1, kelvin),
        );
        for (v, &(closed, mean)) in state.delayed_percent.iter_mut().zip(&lags.delayed) {
            *v = lag(*v, u0, u1, closed, mean);
        }
        let stress = middle * law.p.breaking_stress_mpa / law.p.flow_stress_mpa;
        let flow = sinh(stress, libm::exp(stress));
        state.flow_percent += lags.flow_percent_per_s * flow * lags.duration_s;
        let targets = (
            law.retraction_target(l0, kelvin),
            law.retraction_target(l1, kelvin),
        );
        if targets != (0.0, 0.0) || state.retraction_percent != 0.0 {
            retract(law, &mut state, targets, lags.retraction);
        }
        state
    }

    /// Elastic elongation, m; thermal expansion is constant and therefore excluded.
    pub(super) fn elastic_m(&self, tension_n: f64) -> f64 {
        let percent = self.law.elastic_percent(self.law.load_ratio(tension_n));
        0.01 * self.length_m * percent
    }

    /// Creep in a state, m: elongation apart from the elastic one.
    pub(super) fn creep_m(&self, state: &State) -> f64 {
        let delayed: f64 = state.delayed_percent.iter().sum();
        let percent = state.irreversible_percent() + delayed
            - state.retraction_percent
            - state.retraction_kept_percent;
        0.01 * self.length_m * percent
    }

    /// For a small quick change of tension, m/N.
    pub(super) fn compliance_m_per_n(&self, tension_n: f64) -> f64 {
        let slope = self
            .law
            .elastic_slope_percent(self.law.load_ratio(tension_n));
        0.01 * self.length_m * slope / self.breaking_load_n()
    }

    pub(super) fn breaking_load_n(&self) -> f64 {
        self.law.p.breaking_load_n
    }

    /// Strain that errors are compared with, %: elastic under the tension, at least under 1e-4 of the
    /// breaking load.
    pub(super) fn strain_scale_percent(&self, tension_n: f64) -> f64 {
        self.law
            .elastic_percent(self.law.load_ratio(tension_n).max(1e-4))
    }

    /// Upper bound of the bedding-in within a step from a state, %: the error of a step in which the bedding-in ends.
    pub(super) fn kink_percent(
        &self,
        from: &State,
        tension_n: f64,
        temperature_k: f64,
        duration_s: f64,
    ) -> f64 {
        let gap = self.law.bedding_target(self.law.load_ratio(tension_n)) - from.bedding_percent;
        let jam =
            libm::exp(-self.law.p.jamming * from.bedding_percent / self.law.bedding_percent());
        let per_s = self.law.bedding_per_s(Heat::new(temperature_k)) * jam;
        gap.max(0.0) * (per_s * duration_s).min(1.0)
    }

    /// Whether bedding-in is complete under a tension.
    pub(super) fn is_bedded(&self, state: &State, tension_n: f64) -> bool {
        self.law.bedding_target(self.law.load_ratio(tension_n)) <= state.bedding_percent
    }
}
