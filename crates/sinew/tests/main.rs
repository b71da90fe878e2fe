//! All tests of the command line in one binary: one link, one start.

mod architecture;
mod baseline_merge;
mod build_budget;
mod cases;
mod causes;
#[cfg(feature = "schema")]
mod checker;
mod circles;
mod cli;
mod control;
mod creep;
mod examples;
mod init;
#[cfg(unix)]
mod limits;
mod options;
mod outputs;
#[cfg(unix)]
mod outputs_whole;
mod recordings;
mod reference;
mod rope;
#[cfg(feature = "schema")]
mod schemas;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod slides;
mod terminal;
mod trend;
mod watch;
