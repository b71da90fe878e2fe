//! The arm simulator: recordings with a known truth.
//!
//! Reading order: [`Scenario`] (what a small TOML file says), [`Simulation`] (frame by frame),
//! then `plant` (the equations and the integrator), `friction`, `controller`, `motion`,
//! `contacts`, `sensors`. [`protocol`] has named scenarios, [`control`] scores one without and with its correction, [`year`]
//! makes up a tendon's year.

mod contacts;
pub mod control;
mod controller;
mod controller_model;
mod error;
mod faults;
mod friction;
mod motion;
mod plant;
pub mod protocol;
mod run;
mod sampled;
pub mod scenario;
mod sensors;
mod simulation;
mod truth;
pub mod year;

#[cfg(test)]
mod tests;

pub use error::SimulateError;
pub use faults::FaultCounts;
pub use faults::FaultyLine;
pub use run::{Progress, SimulateOptions, Summary, record, recorded_quantities, run, truth_path};
pub use scenario::Scenario;
pub use sensors::injected;
pub use simulation::{Simulation, TrueState};
pub use truth::Truth;
