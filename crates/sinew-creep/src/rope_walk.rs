//! Simulation of a rope through the tensions of a record, part by part.

use sinew_rope::law::{CELSIUS_ZERO_K, Law as RopeLaw, Parameter, Rates, RopeLoad, State};

use super::curve::{Curve, Tension};

/// Assumed temperature of a record without one, °C.
pub(super) const TEMPERATURE_C: f64 = 23.0;

/// Parameters to which a part of the strain is proportional, in the order of [`Walk::parts`].
pub(super) const PARTS: [Parameter; 6] = [
    Parameter::ElasticK,
    Parameter::Toe,
    Parameter::Bedding,
    Parameter::Delayed,
    Parameter::FlowRate,
    Parameter::Retraction,
];

/// State of a rope during the steps of a record.
pub(super) struct Walk<'a> {
    law: &'a RopeLaw,
    tension: Option<Tension>,
    steps: &'a [(f64, f64)],
    temperature_k: f64,
    state: State,
    tension_n: f64,
    rates: Option<Rates>,
    now: f64,
    next_step: usize,
}

impl<'a> Walk<'a> {
    /// State before the first step: a new rope under the preload for its recorded duration.
    pub(super) fn new(law: &'a RopeLaw, curve: &Curve, steps: &'a [(f64, f64)]) -> Self {
        let start = steps.first().map_or(0.0, |s| s.0);
        Self::waiting(law, curve, steps, start)
    }

    /// State under the preload, at a time not after the first step, where the zero was measured.
    pub(super) fn waiting(
        law: &'a RopeLaw,
        curve: &Curve,
        steps: &'a [(f64, f64)],
        t: f64,
    ) -> Self {
        let celsius = curve.temperature_c.unwrap_or(TEMPERATURE_C);
        let tension = curve.tension;
        let mut walk = Self {
            law,
            tension,
            steps,
            temperature_k: celsius + CELSIUS_ZERO_K,
            state: State::default(),
            tension_n: tension.map_or(0.0, |t| t.at(0.0)),
            rates: None,
            now: t,
            next_step: 0,
        };
        walk.meet();
        // The preload started at its recorded time, independent of the step's time within its
        // window.
        let recorded = curve.steps.first().map_or(0.0, |s| s.0);
        walk.hold(tension.map_or(0.0, |t| t.preloaded_s) + t - recorded);
        walk
    }

    /// Parts of the strain, m/m; retraction is negative.
    pub(super) fn parts(&self) -> [f64; PARTS.len()] {
        let (p, state) = (self.law.parameters(), &self.state);
        let lambda = self.law.load_ratio(self.tension_n);
        [
            lambda / p.elastic_k,
            -0.01 * p.toe_percent * (-lambda / p.toe_load_ratio).exp_m1(),
            0.01 * state.bedding_percent,
            0.01 * state.delayed_percent.iter().sum::<f64>(),
            0.01 * state.flow_percent,
            -0.01 * state.retraction_percent,
        ]
    }

    fn meet(&mut self) {
        self.rates = self
            .law
            .rates(RopeLoad {
                tension_n: self.tension_n,
                temperature_k: self.temperature_k,
            })
            .ok();
    }

    fn hold(&mut self, duration_s: f64) {
        if let Some(rates) = &self.rates
            && duration_s > 0.0
        {
            // Loads and temperatures were checked; a non-finite state remains unchanged.
            let _ = self.law.advance(&mut self.state, rates, duration_s);
        }
    }

    /// Advances to a time not before the previous one.
    pub(super) fn go_to(&mut self, t: f64) {
        while let Some(&(start, step)) = self.steps.get(self.next_step) {
            if start > t {
                break;
            }
            self.hold(start - self.now);
            self.now = self.now.max(start);
            self.tension_n = self.tension.map_or(0.0, |n| n.at(step));
            self.meet();
            self.next_step += 1;
        }
        if self.next_step > 0 {
            self.hold(t - self.now);
            self.now = self.now.max(t);
        }
    }
}
