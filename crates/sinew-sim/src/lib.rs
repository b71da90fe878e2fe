//! The arm simulator: recordings with a known truth.
//!
//! Reading order: [`Scenario`] (content of a TOML file), [`Simulation`] (frame by frame), then `plant` (the equations
//! and the integrator), `paths` (tendons over several joints), `friction`, `controller`, `motion`, `contacts`,
//! `sensors`. [`protocol`] has named scenarios, [`control`] scores one without and with its correction, [`year`]
//! simulates a year of a tendon.

mod contacts;
pub mod control;
mod controller;
mod controller_model;
mod error;
mod faults;
mod friction;
mod motion;
mod paths;
mod plant;
pub mod protocol;
mod run;
mod sampled;
pub mod scenario;
mod sensors;
mod set_point;
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
