//! The laboratory: how good the estimates are in scenarios and simulated years, and the figures of the paper.
//!
//! No product depends on it. The program `sinew-bench` runs its studies.

mod jobs;
mod journal;
mod numbers;
pub mod paper;
pub mod scenarios;
pub mod year;

pub use journal::JournalError;
