//! The data behind a rope's values, and how little is known beyond them.

use super::validity::{LOAD_RATIO_HIGH, LOAD_RATIO_LOW};

/// Load, temperature and time of the data that a rope's values were held against.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Holds {
    /// Least and largest tension over breaking load.
    pub load_share: [f64; 2],
    /// Lowest and highest temperature, °C.
    pub temperature_c: [f64; 2],
    /// Length of the longest test, s.
    pub duration_s: f64,
}

impl Holds {
    /// Taken for a rope that doesn't say: loads the law was made for, indoors, for a day.
    pub const NOT_STATED: Holds = Holds {
        load_share: [LOAD_RATIO_LOW, LOAD_RATIO_HIGH],
        temperature_c: [10.0, 40.0],
        duration_s: 86_400.0,
    };

    /// How far loads and temperatures lie beyond the data: loads `from` to `to` as shares of the
    /// breaking load, temperatures `from` to `to` in °C.
    #[must_use]
    pub fn beyond(&self, load_share: [f64; 2], temperature_c: [f64; 2]) -> Beyond {
        let [low, high] = self.load_share;
        let [cold, hot] = self.temperature_c;
        // A slack rope is known: only loads count.
        let below = if load_share[0] > 0.0 {
            libm::log(low / load_share[0])
        } else {
            0.0
        };
        Beyond {
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

/// How far a duty lies beyond the data in load and temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Beyond {
    /// Logarithm of the load over the nearest one of the data.
    pub load_efolds: f64,
    /// Kelvin to the nearest temperature of the data.
    pub temperature_k: f64,
}

/// Per decade of time beyond the data, standard deviation of the logarithm of what is added. In
/// rehearsals a decade ahead on records that no law of the set had made, 95 % of the truths lay
/// within some 60 % of the creep: 0.6/1.96.
pub const PER_DECADE: f64 = 0.3;
/// Per e-folding of the load: laws that agree within the data and whose strains differ by a power
/// ±0.5 (95 %) of the load beyond. A judgement.
pub const PER_LOAD_EFOLD: f64 = 0.25;
/// Per kelvin: a factor 2 in 10 K (95 %), the rule of thumb for rates. A judgement.
pub const PER_KELVIN: f64 = core::f64::consts::LN_2 / 19.6;

impl Beyond {
    /// Standard deviation of the logarithm of the strain at once.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        libm::hypot(
            PER_LOAD_EFOLD * self.load_efolds,
            PER_KELVIN * self.temperature_k,
        )
    }

    /// Standard deviation of the logarithm of what is added `decades` of time beyond the data.
    ///
    /// `s² = (0.25 ln λ/λ₀)² + (0.035 ΔT)² + 0.3² D`: what the law misses walks on at random with
    /// every decade.
    #[must_use]
    pub fn deviation_after(&self, decades: f64) -> f64 {
        libm::hypot(self.deviation(), PER_DECADE * libm::sqrt(decades))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_added_within_the_data_and_more_with_every_step_beyond() {
        let holds = Holds {
            load_share: [0.01, 0.1],
            temperature_c: [20.0, 60.0],
            duration_s: 1e4,
        };
        let inside = holds.beyond([0.01, 0.1], [20.0, 60.0]);
        assert_eq!(inside, Beyond::default());
        assert_eq!(inside.deviation_after(holds.decades_beyond(1e4)), 0.0);
        assert_eq!(
            inside.deviation_after(holds.decades_beyond(1e5)),
            PER_DECADE
        );
        let far = holds.beyond([0.0, 0.1 * core::f64::consts::E], [10.0, 90.0]);
        assert!((far.load_efolds - 1.0).abs() < 1e-12 && far.temperature_k == 30.0);
        assert!((holds.beyond([0.001, 0.1], [20.0, 20.0]).load_efolds - 10_f64.ln()).abs() < 1e-12);
        assert!(far.deviation() > inside.deviation());
    }
}
