//! How long ropes last, from tables of what broke and what was replaced.
//!
//! [`read_lives`] makes lifetimes of a table, [`analyze_lives`] a curve with its band, a law with its intervals and
//! what they mean for replacing in time. [`LifePrior`] is the same as the prior of a trend that knows nothing better.

mod analyze;
mod events;
mod forecast;
mod lives;
mod read;
mod result;

pub use analyze::analyze_lives;
pub use events::EventColumns;
pub use forecast::LifePrior;
pub use lives::{LifeEnd, Lives, RopeLife};
pub use read::read_lives;
pub use result::{
    AgeUnit, FittedPoint, FittedWeibull, LifeForecast, LifeQuantile, SurvivalGroup, SurvivalNote,
    SurvivalReport, Wear,
};
