//! A tendon's year and what its daily sessions read, both made up: [`truth`] lets the rope creep by its law under work
//! drawn anew, [`surrogate`] adds the estimator's errors as they were measured on simulated recordings.

pub mod surrogate;
pub mod truth;
