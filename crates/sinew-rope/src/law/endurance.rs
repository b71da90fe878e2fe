//! Failure of a rope below its breaking load: creep rupture, static fatigue, heat and terminations.
//!
//! ```text
//! strength          S(θ) = 1 − s (θ − T_ref)                       share of the breaking load
//! creep rupture     Ḋ = ḟ(λ/η, θ)/ε_r                              flow until a permanent strain
//! static fatigue    Ḋ = 10^(−(1 − λ/(η S))/m)/60 s                 m: strength lost per decade
//! bent              η_b = 1 − β √(d/D)                             over a pulley, D at least d
//! broken            D = 1 (Palmgren–Miner), or λ > η S, or λ > η_b S
//! ```
//!
//! `η` is the share of the rope's strength that a termination retains; 1 along the rope.

use super::{Law, LoadError, REFERENCE_K, RopeLoad};

/// Duration of a breaking test, s: the decades of static fatigue count from here.
const TEST_S: f64 = 60.0;
/// Bounds of the strength as a share of the breaking load, at any temperature.
const STRENGTH: (f64, f64) = (0.02, 1.3);

macro_rules! endurance {
    ($($(#[doc = $doc:literal])* $field:ident $variant:ident $low:expr, $high:expr;)*) => {
        /// Endurance of a rope or of a class of fibres.
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct Endurance {
            $($(#[doc = $doc])* pub $field: f64,)*
        }

        /// Value of a parameter by name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum EnduranceKey {
            $($(#[doc = $doc])* $variant,)*
        }

        impl EnduranceKey {
            /// All of them.
            pub const ALL: &'static [EnduranceKey] = &[$(EnduranceKey::$variant,)*];

            /// Name with its unit, as in a file.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(EnduranceKey::$variant => stringify!($field),)* }
            }

            /// Symbol and meaning, in the Markdown of its documentation.
            #[must_use]
            pub fn meaning(self) -> &'static str {
                match self { $(EnduranceKey::$variant => concat!($($doc),*).trim_ascii(),)* }
            }

            /// Smallest and largest value taken.
            #[must_use]
            pub fn range(self) -> (f64, f64) {
                match self { $(EnduranceKey::$variant => ($low, $high),)* }
            }
        }

        impl Endurance {
            /// Sets a value, kept within its range.
            pub fn set(&mut self, key: EnduranceKey, value: f64) {
                let (low, high) = key.range();
                let value = value.clamp(low, high);
                match key { $(EnduranceKey::$variant => self.$field = value,)* }
            }
        }
    };
}

endurance! {
    /// `ε_r`: permanent strain of the fibre at which it counts as broken, %.
    rupture_percent Rupture 0.1, 100.0;
    /// `m`: share of the strength lost per decade of time under load; 0: none.
    static_fatigue_share StaticFatigue 0.0, 0.5;
    /// `s`: share of the strength lost per kelvin.
    strength_per_k StrengthPerK 0.0, 0.1;
    /// Share of the strength that a splice leaves.
    splice_share Splice 0.01, 1.0;
    /// Share of the strength that a knot leaves.
    knot_share Knot 0.01, 1.0;
    /// Largest tension over breaking load by the manufacturers' advice.
    load_share_most LoadShare 0.001, 1.0;
    /// Smallest pulley diameter over rope diameter by the manufacturers' advice.
    bend_ratio_least BendRatio 0.1, 1000.0;
    /// `β`: share of the strength lost by a rope that is bent to its own diameter.
    bend_loss_share BendLoss 0.0, 0.9;
}

impl Endurance {
    /// `S(θ)`: ratio of the strength to the strength at `T_ref`.
    #[must_use]
    pub fn strength_share(&self, temperature_k: f64) -> f64 {
        let share = 1.0 - self.strength_per_k * (temperature_k - REFERENCE_K);
        share.clamp(STRENGTH.0, STRENGTH.1)
    }

    /// `η_b`: share of the strength that a rope retains if bent to `bend_ratio` times its diameter.
    #[must_use]
    pub fn bent_share(&self, bend_ratio: f64) -> f64 {
        1.0 - self.bend_loss_share / libm::sqrt(bend_ratio.max(1.0))
    }

    /// Share of its life that a rope loses per second under a load, 1/s; infinite if it breaks immediately.
    /// `termination_share` is `η`.
    ///
    /// # Errors
    /// Returns a [`LoadError`] for an invalid load.
    pub fn damage_per_s(
        &self,
        law: &Law,
        load: RopeLoad,
        termination_share: f64,
    ) -> Result<f64, LoadError> {
        let strength = termination_share * self.strength_share(load.temperature_k);
        let used = law.load_ratio(load.tension_n) / strength;
        if used > 1.0 || load.tension_n > termination_share * law.parameters().breaking_load_n {
            return Ok(f64::INFINITY);
        }
        let local = RopeLoad {
            tension_n: load.tension_n / termination_share,
            ..load
        };
        let flow = law.rates(local)?.flow_percent_per_s / self.rupture_percent;
        let fatigue = if self.static_fatigue_share > 0.0 && used > 0.0 {
            libm::pow(10.0, -(1.0 - used) / self.static_fatigue_share) / TEST_S
        } else {
            0.0
        };
        Ok(flow + fatigue)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strength_falls_with_heat_and_keeps_within_bounds() {
        let e = Endurance {
            strength_per_k: 0.006,
            ..Endurance::default()
        };
        assert_eq!(e.strength_share(REFERENCE_K), 1.0);
        assert!((e.strength_share(REFERENCE_K + 50.0) - 0.7).abs() < 1e-12);
        assert_eq!(e.strength_share(REFERENCE_K + 500.0), STRENGTH.0);
        let mut set = e;
        set.set(EnduranceKey::Splice, 1.4);
        assert_eq!(set.splice_share, 1.0);
        set.bend_loss_share = 0.5;
        assert_eq!(
            [0.5, 1.0, 4.0, f64::INFINITY].map(|r| set.bent_share(r)),
            [0.5, 0.5, 0.75, 1.0]
        );
    }
}
