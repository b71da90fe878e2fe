//! How good the estimates are: scenarios, simulated years, excitation, control, the figures of the paper.

pub mod control;
pub mod excitation;
mod jobs;
mod journal;
mod numbers;
pub mod paper;
pub mod scenarios;
pub mod year;

pub use journal::JournalError;
