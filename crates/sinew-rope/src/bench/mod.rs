//! Geometry of the test bench in the paper: motor on a carriage, drive pulley, joint pulley, guiding pulleys
//! between them, a force that pulls the carriage, and a motor that unrolls rope back and forth.
//!
//! Reading order: [`setup`] (geometry and programme), [`routings`] (cases A to F of the paper),
//! [`simulate()`], [`alternatives`] (what the paper leaves open).

pub mod alternatives;
pub mod routings;
mod run;
pub mod setup;
pub mod simulate;

pub use run::{BenchReading, BenchRun, run};
pub use setup::{Bench, BenchError, Phase, Strand};
pub use simulate::{Driver, Mechanism, Simulated, simulate, simulate_as};
