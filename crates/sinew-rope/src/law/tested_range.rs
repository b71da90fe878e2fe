//! Tested range of a rope's data and the uncertainty beyond it.

use super::validity::{LOAD_RATIO_HIGH, LOAD_RATIO_LOW};

/// Tested range: load, temperature and duration of the data that a rope's parameters were validated with.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestedRange {
    /// Lowest and highest tension as a share of the breaking load.
    pub load_share: [f64; 2],
    /// Lowest and highest temperature, °C.
    pub temperature_c: [f64; 2],
    /// Length of the longest test, s.
    pub duration_s: f64,
}

impl TestedRange {
    /// Range assumed for a rope that specifies none: validity limits of the law, indoors, one day.
    pub const UNSPECIFIED: TestedRange = TestedRange {
        load_share: [LOAD_RATIO_LOW, LOAD_RATIO_HIGH],
        temperature_c: [10.0, 40.0],
        duration_s: 86_400.0,
    };

    /// Extrapolation distance of loads and temperatures from the tested range: loads from lowest to highest
    /// as shares of the breaking load, temperatures from lowest to highest in °C.
    #[must_use]
    pub fn extrapolation(&self, load_share: [f64; 2], temperature_c: [f64; 2]) -> Extrapolation {
        let [low, high] = self.load_share;
        let [cold, hot] = self.temperature_c;
        // Zero tension is no extrapolation: only loads above zero count.
        let below = if load_share[0] > 0.0 {
            libm::log(low / load_share[0])
        } else {
            0.0
        };
        let heat_k = (temperature_c[1] - hot).max(0.0);
        Extrapolation {
            load_efolds: libm::log(load_share[1] / high).max(below).max(0.0),
            temperature_k: heat_k.max(cold - temperature_c[0]),
            heat_k,
        }
    }

    /// Decades of time beyond the data; 0 within.
    #[must_use]
    pub fn decades_beyond(&self, time_s: f64) -> f64 {
        libm::log10(time_s / self.duration_s).max(0.0)
    }
}

/// Extrapolation distance of a duty from the tested range, in load and temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Extrapolation {
    /// Natural logarithm of the ratio of the load to the nearest tested load.
    pub load_efolds: f64,
    /// Distance to the nearest tested temperature, K.
    pub temperature_k: f64,
    /// Distance above the highest tested temperature, K.
    #[serde(default)]
    pub heat_k: f64,
}

/// Standard deviation of the logarithm of the added strain, per decade of time beyond the data. In back-tests
/// one decade ahead, on records that no law of the set had generated, 95 % of the true values lay within some
/// 60 % of the creep: 0.6/1.96.
pub const PER_DECADE: f64 = 0.3;
/// Standard deviation per e-folding of the load: laws that agree within the data and whose strains differ by
/// a power ±0.5 (95 %) of the load beyond it. Assumed.
pub const PER_LOAD_EFOLD: f64 = 0.25;
/// Standard deviation of the logarithm of creep per kelvin above the data: a factor 2 in 10 K (95 %), the rule of
/// thumb for rates. Assumed. Below the data rates fall, and the intervals of the activation energies include by
/// how much.
pub const PER_KELVIN: f64 = core::f64::consts::LN_2 / 19.6;
/// Standard deviation of the logarithm of the immediate strain per kelvin outside the data: a stiffness that changes
/// by 1 % per kelvin (95 %), which the law does not include. Assumed.
pub const IMMEDIATE_PER_KELVIN: f64 = 0.01 / 1.96;

/// Nodes per decade of time of the trapezoidal rule of [`ModelError::step`].
const NODES_PER_DECADE: f64 = 4.0;

impl Extrapolation {
    /// Standard deviation of the logarithm of the immediate strain:
    /// `s₀² = (0.25 ln λ/λ₀)² + (0.0051 ΔT)²`.
    #[must_use]
    pub fn std(&self) -> f64 {
        libm::hypot(
            PER_LOAD_EFOLD * self.load_efolds,
            IMMEDIATE_PER_KELVIN * self.temperature_k,
        )
    }

    /// Standard deviation of the logarithm of the strain added `decades` of time beyond the data:
    /// `s² = (0.25 ln λ/λ₀)² + (0.035 ΔT₊)² + 0.3² D`, with the distance `ΔT₊` above the highest tested temperature.
    /// The model error is a random walk over the decades of time.
    #[must_use]
    pub fn std_after(&self, decades: f64) -> f64 {
        libm::hypot(
            libm::hypot(PER_LOAD_EFOLD * self.load_efolds, PER_KELVIN * self.heat_k),
            PER_DECADE * libm::sqrt(decades),
        )
    }
}

/// Model error of one draw of a law outside the tested range of its rope. The default is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelError {
    /// Tested range of the rope.
    pub tested_range: TestedRange,
    /// Extrapolation distance of the duty from it.
    pub extrapolation: Extrapolation,
    /// Standard normal number of the draw.
    pub error_z: f64,
}

impl Default for ModelError {
    fn default() -> Self {
        Self {
            tested_range: TestedRange::UNSPECIFIED,
            extrapolation: Extrapolation::default(),
            error_z: 0.0,
        }
    }
}

impl ModelError {
    /// Factor on the immediate strain under a share `load_share` of the breaking load: `exp(z s₀)`, at most
    /// `1/load_share`, because a rope stretches most under its breaking load.
    #[must_use]
    pub fn immediate_factor(&self, load_share: f64) -> f64 {
        libm::exp(self.error_z * self.extrapolation.std()).min(1.0 / load_share)
    }

    /// Factor on the strain added since tensioning, at a time since then: `exp(z s)`.
    #[must_use]
    pub fn creep_factor(&self, time_s: f64) -> f64 {
        let decades = self.tested_range.decades_beyond(time_s);
        libm::exp(self.error_z * self.extrapolation.std_after(decades))
    }

    /// Lifetime of the draw, s, from that of its law: where the law stretches a rope more, it breaks it sooner.
    #[must_use]
    pub fn life_s(&self, life_s: f64) -> f64 {
        match life_s.is_finite() {
            true => life_s / self.creep_factor(life_s),
            false => life_s,
        }
    }

    /// Times beyond the data, s, up to `last_s`, at which the strains of a draw are to be evaluated for
    /// [`ModelError::step`]: four per decade if its factor decreases, otherwise none.
    #[must_use]
    pub fn nodes_s(&self, last_s: f64) -> Vec<f64> {
        let decades = match self.error_z < 0.0 {
            true => self.tested_range.decades_beyond(last_s),
            false => 0.0,
        };
        let node = |i: u32| libm::pow(10.0, f64::from(i) / NODES_PER_DECADE);
        let count = libm::ceil(NODES_PER_DECADE * decades) as u32;
        (0..count)
            .map(|i| self.tested_range.duration_s * node(i))
            .collect()
    }

    /// Offset and slope at `time_s`, one step after `from`: strain with the model error as a function of that of the law.
    ///
    /// The strain is `exp(z s)` times that of the law where this factor grows. Where it falls it applies to the
    /// increments, `dw = exp(z s) dc` by the trapezoidal rule, because creep does not recede where a law
    /// overestimates it.
    #[must_use]
    pub fn step(&self, from: AddedStrain, time_s: f64) -> (f64, f64) {
        let factor = self.creep_factor(time_s);
        if self.error_z < 0.0 {
            let mean = 0.5 * (self.creep_factor(from.time_s) + factor);
            (from.widened - mean * from.law, mean)
        } else {
            (0.0, factor)
        }
    }

    /// Strain of the law at `time_s` with the model error, one step after `from`.
    #[must_use]
    pub fn next(&self, from: AddedStrain, time_s: f64, law: f64) -> AddedStrain {
        let (offset, slope) = self.step(from, time_s);
        AddedStrain {
            time_s,
            law,
            widened: offset + slope * law,
        }
    }
}

/// Strain or elongation added since tensioning.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AddedStrain {
    /// Time since tensioning, s.
    pub time_s: f64,
    /// Value of the law.
    pub law: f64,
    /// Value with the model error.
    pub widened: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uncertainty_grows_only_beyond_tested_range() {
        let tested_range = TestedRange {
            load_share: [0.01, 0.1],
            temperature_c: [20.0, 60.0],
            duration_s: 1e4,
        };
        let inside = tested_range.extrapolation([0.01, 0.1], [20.0, 60.0]);
        assert_eq!(inside, Extrapolation::default());
        assert_eq!(inside.std_after(tested_range.decades_beyond(1e4)), 0.0);
        assert_eq!(
            inside.std_after(tested_range.decades_beyond(1e5)),
            PER_DECADE
        );
        let far = tested_range.extrapolation([0.0, 0.1 * core::f64::consts::E], [10.0, 90.0]);
        assert!((far.load_efolds - 1.0).abs() < 1e-12);
        assert_eq!((far.temperature_k, far.heat_k), (30.0, 30.0));
        assert!(
            (tested_range
                .extrapolation([0.001, 0.1], [20.0, 20.0])
                .load_efolds
                - 10_f64.ln())
            .abs()
                < 1e-12
        );
        assert!(far.std() > inside.std());
    }

    /// By hand: at −40 °C the immediate strain has 63 K × 0.01/1.96, and the creep of an hour has no further error.
    #[test]
    fn cold_widens_only_immediate_strain() {
        let tested_range = TestedRange {
            load_share: [0.01, 0.1],
            temperature_c: [23.0, 60.0],
            duration_s: 1e4,
        };
        let extrapolation = tested_range.extrapolation([0.05, 0.05], [-40.0, -40.0]);
        assert!((1.96 * extrapolation.std() - 0.63).abs() < 1e-12);
        assert_eq!(extrapolation.std_after(0.0), 0.0);
        let error = |error_z: f64| ModelError {
            tested_range,
            extrapolation,
            error_z,
        };
        assert!((error(1.96).immediate_factor(0.05) - 0.63_f64.exp()).abs() < 1e-12);
        assert_eq!(error(1e3).immediate_factor(0.05), 20.0);
        assert_eq!(error(3.0).creep_factor(3600.0), 1.0);
        assert!((error(1.0).creep_factor(1e5) - 0.3_f64.exp()).abs() < 1e-12);
        assert_eq!(ModelError::default().creep_factor(1e9), 1.0);
        assert!((error(1.0).life_s(1e5) - 1e5 * (-0.3_f64).exp()).abs() < 1e-6);
    }

    /// A law that doubles its creep within the first decade beyond the data and then rests, by hand.
    #[test]
    fn creep_with_model_error_does_not_recede() {
        let of = |error_z: f64| {
            let error = ModelError {
                error_z,
                ..ModelError::default()
            };
            let day_s = error.tested_range.duration_s;
            let mut now = AddedStrain::default();
            [(1.0, 1.0), (10.0, 2.0), (100.0, 2.0)].map(|(times, law)| {
                now = error.next(now, times * day_s, law);
                now.widened
            })
        };
        let (up, down) = (of(1.0), of(-1.0));
        assert!((up[2] - 2.0 * (0.3 * 2.0_f64.sqrt()).exp()).abs() < 1e-12);
        let decade = 0.5 * (1.0 + (-0.3_f64).exp());
        assert!((down[1] - 1.0 - decade).abs() < 1e-12);
        assert!((down[2] - down[1]).abs() < 1e-12 && up[0] == 1.0 && down[0] == 1.0);
        let nodes_s = ModelError {
            error_z: -1.0,
            ..ModelError::default()
        }
        .nodes_s(8.64e6);
        assert_eq!((nodes_s.len(), nodes_s[0]), (8, 86_400.0));
        assert!((nodes_s[4] / 864_000.0 - 1.0).abs() < 1e-12);
        assert!(ModelError::default().nodes_s(8.64e6).is_empty());
    }
}
