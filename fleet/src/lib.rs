//! Analysis of the records of a fleet: next maintenance, worse batches, priors of new robots.
//!
//! Input is a folder of `sinew-record/2` files ([`folder`]); DataFusion executes SQL on it ([`engine`]), and the trend of single
//! tendons is that of `sinew trend`.
//!
//! Reading order: [`args`], [`bucket`] (folders in a bucket), [`folder`] (files, duplicates, unreadable files), [`engine`]
//! (tables), [`query`] (SQL with the Sinew functions), [`rows`], [`due`] (tendons that may exceed a limit), [`creep`] (creep rate
//! of a tendon), [`gather`] (creep rates of all tendons), [`hierarchy`] (hierarchical model of groups), [`compare`] (worse
//! groups), [`outliers`] (deviating tendons), [`pool`] (priors of new robots), [`report`] (page of a fleet), [`simulate`]
//! (fleets with known ground truth).

mod address;
pub mod args;
pub mod bucket;
mod by;
mod columns;
pub mod compare;
pub mod creep;
pub mod due;
pub mod engine;
mod error;
pub mod folder;
mod functions;
pub mod gather;
pub mod hierarchy;
mod metadata;
pub mod outliers;
pub mod pool;
pub mod query;
pub mod reference_creep;
pub mod report;
pub mod rows;
mod sessions;
pub mod simulate;
mod table;

pub use error::FleetError;

use args::{Args, Command};
use std::process::ExitCode;

/// Runs the command of the arguments.
///
/// # Errors
///
/// Returns [`FleetError`] if the input is invalid or the output cannot be written.
pub fn run(args: &Args) -> Result<ExitCode, FleetError> {
    let mut args = args.clone();
    // Kept until there is an answer.
    let _copied = bucket::copy(&mut args)?;
    match &args.command {
        Command::Simulate(request) => simulate::command(request),
        Command::Rows(request) => rows::command(request),
        Command::Query(request) => query::command(request),
        Command::Due(request) => due::command(request),
        Command::Compare(request) => compare::command(request),
        Command::Outliers(request) => outliers::command(request),
        Command::Pool(request) => pool::command(request),
        Command::Report(request) => report::command(request),
    }
}
