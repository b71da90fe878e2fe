//! Questions to the records of a fleet: which tendon next, which batch is worse, where does a new robot start from.
//!
//! A folder of `sinew-record/1` files goes in ([`folder`]), DataFusion answers SQL on it ([`engine`]), and the
//! trend of single tendons is that of `sinew trend`.
//!
//! Reading order: [`args`], [`bucket`] (folders elsewhere), [`folder`] (what is there, what is twice, what can't be read), [`engine`] (tables),
//! [`query`] (SQL with the functions of Sinew), [`rows`], [`due`] (which tendon passes its limit when),
//! [`creep`] (how fast a tendon creeps), [`gather`] (all of them), [`hierarchy`] (groups and what can be told of them),
//! [`compare`] (which group is worse), [`outliers`] (which tendon departs), [`pool`] (what a new robot
//! starts from), [`report`] (all of it as a page), [`simulate`] (fleets whose truth is known).

mod address;
pub mod args;
mod beside;
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
pub mod known_creep;
pub mod outliers;
pub mod pool;
pub mod query;
pub mod report;
pub mod rows;
mod sessions;
pub mod simulate;
mod table;
mod words;

pub use error::FleetError;

use args::{Args, Command};
use std::process::ExitCode;

/// Does what the program is asked for.
///
/// # Errors
/// [`FleetError`].
pub fn run(args: &Args) -> Result<ExitCode, FleetError> {
    let mut args = args.clone();
    // Kept until there is an answer.
    let _copied = bucket::copy(&mut args)?;
    match &args.command {
        Command::Simulate(asked) => simulate::command(asked),
        Command::Rows(asked) => rows::command(asked),
        Command::Query(asked) => query::command(asked),
        Command::Due(asked) => due::command(asked),
        Command::Compare(asked) => compare::command(asked),
        Command::Outliers(asked) => outliers::command(asked),
        Command::Pool(asked) => pool::command(asked),
        Command::Report(asked) => report::command(asked),
    }
}
