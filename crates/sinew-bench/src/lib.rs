//! Studies: accuracy of the estimates in scenarios and simulated years, and the figures of the paper.
//!
//! No product depends on this crate. The program `sinew-bench` runs its studies.

mod jobs;
mod journal;
mod numbers;
pub mod paper;
pub mod scenarios;
pub mod validation;
pub mod year;

pub use journal::JournalError;
