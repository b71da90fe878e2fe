//! The arm simulator: recordings with a known truth.
//!
//! Reading order: [`Scenario`] (what a small TOML file says), [`Simulation`] (frame by frame),
//! then `plant` (the equations and the integrator), `friction`, `controller`, `motion`,
//! `contacts`, `sensors`.

mod contacts;
mod controller;
mod error;
mod friction;
mod motion;
mod plant;
pub mod scenario;
mod sensors;
mod simulation;
#[cfg(test)]
mod tests;

pub use error::SimulateError;
pub use scenario::Scenario;
pub use sensors::injected;
pub use simulation::{Simulation, TrueState};
