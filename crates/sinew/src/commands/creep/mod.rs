//! `sinew creep`: evaluation and planning of creep tests.

mod analyze;
mod compare;
mod files;
mod fit;
mod plan;
mod write_rope;

use crate::terminal::{Failure, Finish};
use analyze::Analyze;
use clap::Subcommand;
use compare::Compare;
use fit::Fit;
use plan::Plan;

/// Evaluate and plan creep tests of ropes
#[derive(Debug, Subcommand)]
pub(crate) enum Creep {
    Analyze(Analyze),
    Fit(Box<Fit>),
    Compare(Compare),
    Plan(Box<Plan>),
}

impl Creep {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Creep::Analyze(command) => command.run(),
            Creep::Fit(command) => command.run(),
            Creep::Compare(command) => command.run(),
            Creep::Plan(command) => command.run(),
        }
    }
}
