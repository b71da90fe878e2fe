//! All tests of the command line in one binary: one link, one start.

mod architecture;
mod baseline_merge;
mod build_budget;
#[cfg(feature = "schema")]
mod checker;
mod cli;
mod control;
mod creep;
mod examples;
mod init;
mod outputs;
mod reference;
mod rope;
#[cfg(feature = "schema")]
mod schemas;
mod terminal;
mod trend;
