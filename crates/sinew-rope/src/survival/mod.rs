//! How long ropes last, from those that broke and those that haven't yet.
//!
//! A [`Life`] is the age at which a rope broke, or one it has reached. [`kaplan_meier`] supposes nothing of how ropes
//! age, [`Weibull`] a power of it. Ages come in any unit, all in the same.
//!
//! # Realtime
//! None of this is a step of a control loop: it allocates.

mod kaplan_meier;
mod weibull;

pub use kaplan_meier::{SurvivalPoint, kaplan_meier, survival_quantile};
pub use weibull::{Weibull, WeibullFit};

/// Age of a rope, and whether it broke at it. One that was replaced in time, or runs still, is censored: it would have
/// lasted longer.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Life {
    /// Age, above 0.
    pub age: f64,
    /// Whether it broke then.
    pub broke: bool,
}

impl Life {
    /// Whether it is one: a finite age above 0.
    pub fn is_possible(&self) -> bool {
        self.age > 0.0 && self.age.is_finite()
    }
}

/// Half the quantile of χ² with one degree of freedom at 95 %: by so much a logarithm of a likelihood may fall within
/// an interval of 95 %.
pub(crate) const HALF_CHI2_95: f64 = 0.5 * sinew_model::Z95 * sinew_model::Z95;
