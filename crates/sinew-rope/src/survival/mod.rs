//! Lifetimes of ropes, from ropes that broke and right-censored ones.
//!
//! A [`Lifetime`] is the age at which a rope broke, or an age that it has reached. [`kaplan_meier`] is nonparametric, and
//! [`Weibull`] assumes a hazard that is a power of the age; [`ShapePosterior`] is the probability that it increases. Ages may have any unit, which all ages share.
//!
//! # Realtime
//! None of this is a step of a control loop: it allocates.

mod kaplan_meier;
mod weibull;

pub use kaplan_meier::{SurvivalPoint, kaplan_meier, survival_quantile};
pub use weibull::{SHAPE_PRIOR_95, ShapePosterior, Weibull, WeibullFit};

/// Age of a rope, and whether it broke at it. One that was replaced in time, or runs still, is censored: it would have
/// lasted longer.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Lifetime {
    /// Age, above 0.
    pub age: f64,
    /// Whether it broke then.
    pub broke: bool,
}

impl Lifetime {
    /// Whether it is one: a finite age above 0.
    pub fn is_possible(&self) -> bool {
        self.age > 0.0 && self.age.is_finite()
    }
}

/// Half the 95 % quantile of χ² with one degree of freedom: maximum decrease of a log-likelihood within a
/// 95 % interval.
pub(crate) const HALF_CHI2_95: f64 = 0.5 * sinew_model::Z95 * sinew_model::Z95;
