//! Simulated year of a tendon and of its daily sessions: [`truth`] lets the rope creep by its creep law under
//! randomly drawn work, [`surrogate`] adds the estimator's errors as measured on simulated recordings.

pub mod surrogate;
pub mod truth;
