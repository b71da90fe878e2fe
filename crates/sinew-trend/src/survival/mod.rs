//! Lifetimes of ropes, from tables of breaks and replacements.
//!
//! [`read_lives`] reads lifetimes from a table, [`analyze_lives`] returns a survival curve with its
//! band, a fitted law with its intervals and their meaning for age-based replacement. [`LifePrior`]
//! is the corresponding prior of a trend without a strain limit.

mod analyze;
mod events;
mod forecast;
mod lives;
mod read;
mod result;

pub use analyze::analyze_lives;
pub use events::EventColumns;
pub use forecast::LifePrior;
pub use lives::{LifeEnd, Lifetimes, RopeLife};
pub use read::read_lives;
pub use result::{
    AgeReplacement, AgeUnit, FittedPoint, FittedWeibull, LifeForecast, LifeQuantile,
    ReplacementVerdict, SurvivalGroup, SurvivalNote, SurvivalReport,
};
