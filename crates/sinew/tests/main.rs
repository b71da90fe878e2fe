//! All tests of the command line in one binary: one link, one start.

mod architecture;
mod baseline_merge;
mod build_budget;
mod cli;
mod control;
mod creep;
mod examples;
mod reference;
mod rope;
mod trend;
