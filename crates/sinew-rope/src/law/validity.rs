//! Validity limits of the creep law.

use super::{CELSIUS_ZERO_K, Law, Polymer, RopeLoad};
use core::fmt;

/// Below this share of the breaking load the braid is slack and its geometry decides.
pub const LOAD_RATIO_LOW: f64 = 0.01;
/// Above it creep accelerates towards rupture, and the law was not validated.
pub const LOAD_RATIO_HIGH: f64 = 0.40;
/// Above it HMPE leaves the range its flow was measured in, K (65 °C).
pub const HMPE_HOT_K: f64 = CELSIUS_ZERO_K + 65.0;

/// Validity limits that a load violates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LimitViolation {
    /// Tension below [`LOAD_RATIO_LOW`] of the breaking load (and not 0: a slack rope is known).
    pub low_load: bool,
    /// Tension above [`LOAD_RATIO_HIGH`] of the breaking load.
    pub high_load: bool,
    /// HMPE above [`HMPE_HOT_K`].
    pub hot: bool,
}

impl LimitViolation {
    /// Whether the law holds.
    #[must_use]
    pub fn is_inside(self) -> bool {
        self == Self::default()
    }

    /// Limits that a load violates; the law still returns a result, with these as warnings.
    #[must_use]
    pub fn of(law: &Law, load: RopeLoad) -> Self {
        let lambda = law.load_ratio(load.tension_n);
        Self {
            low_load: lambda > 0.0 && lambda < LOAD_RATIO_LOW,
            high_load: lambda > LOAD_RATIO_HIGH,
            hot: law.parameters().polymer == Polymer::Hmpe && load.temperature_k > HMPE_HOT_K,
        }
    }

    /// Limits that either set violates.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            low_load: self.low_load || other.low_load,
            high_load: self.high_load || other.high_load,
            hot: self.hot || other.hot,
        }
    }

    /// Message for each violated limit, one sentence per limit.
    pub fn sentences(self) -> impl Iterator<Item = &'static str> {
        [
            (
                self.low_load,
                "tension below 1 % of the breaking load: the braid is slack, outside the range of the \
                 creep law",
            ),
            (
                self.high_load,
                "tension above 40 % of the breaking load: outside the range in which the creep law was validated",
            ),
            (
                self.hot,
                "HMPE above 65 °C: outside the range in which its flow was measured",
            ),
        ]
        .into_iter()
        .filter_map(|(outside, sentence)| outside.then_some(sentence))
    }
}

impl fmt::Display for LimitViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, sentence) in self.sentences().enumerate() {
            if i > 0 {
                f.write_str("; ")?;
            }
            f.write_str(sentence)?;
        }
        Ok(())
    }
}
