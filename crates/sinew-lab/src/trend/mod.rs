//! Months of offsets: when to tension again, when to replace, and what happened suddenly.
//!
//! [`analyze`] takes the records of many sessions ([`read_records`]) and a robot, and gives each
//! tendon's present state, its events and the day it will pass its limits, with intervals. The estimator
//! is [`sinew_model::trend`]; [`prior`] makes the rope's law its prior. [`year`] lives through simulated
//! years of robots and says how good all that is.

pub mod prior;
pub mod year;
