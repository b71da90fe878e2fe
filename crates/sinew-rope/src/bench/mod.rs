//! The paper's bench as geometry: a motor on a carriage, a drive and a joint pulley, guiding
//! pulleys in between, a force that pulls the carriage, and a motor that unrolls rope back and
//! forth.
//!
//! Reading order: [`setup`] (what stands where), [`routings`] (the paper's A to F), [`simulate()`].

pub mod routings;
mod run;
pub mod setup;
pub mod simulate;

pub use run::{BenchReading, BenchRun, run};
pub use setup::{Bench, BenchError, Phase, Strand};
pub use simulate::{Simulated, simulate};
