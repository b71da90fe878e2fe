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
        Extrapolation {
            load_efolds: libm::log(load_share[1] / high).max(below).max(0.0),
            temperature_k: (temperature_c[1] - hot)
                .max(cold - temperature_c[0])
                .max(0.0),
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
}

/// Standard deviation of the logarithm of the added strain, per decade of time beyond the data. In back-tests
/// one decade ahead, on records that no law of the set had generated, 95 % of the true values lay within some
/// 60 % of the creep: 0.6/1.96.
pub const PER_DECADE: f64 = 0.3;
/// Standard deviation per e-folding of the load: laws that agree within the data and whose strains differ by
/// a power ±0.5 (95 %) of the load beyond it. Assumed.
pub const PER_LOAD_EFOLD: f64 = 0.25;
/// Standard deviation per kelvin: a factor 2 in 10 K (95 %), the rule of thumb for rates. Assumed.
pub const PER_KELVIN: f64 = core::f64::consts::LN_2 / 19.6;

impl Extrapolation {
    /// Standard deviation of the logarithm of the immediate strain.
    #[must_use]
    pub fn std(&self) -> f64 {
        libm::hypot(
            PER_LOAD_EFOLD * self.load_efolds,
            PER_KELVIN * self.temperature_k,
        )
    }

    /// Standard deviation of the logarithm of the strain added `decades` of time beyond the data.
    ///
    /// `s² = (0.25 ln λ/λ₀)² + (0.035 ΔT)² + 0.3² D`: the model error is a random walk over the decades of time.
    #[must_use]
    pub fn std_after(&self, decades: f64) -> f64 {
        libm::hypot(self.std(), PER_DECADE * libm::sqrt(decades))
    }
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
        assert!((far.load_efolds - 1.0).abs() < 1e-12 && far.temperature_k == 30.0);
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
}
