//! `sinew creep`: creep tests to numbers.

use super::creep_analyze::Analyze;
use super::creep_compare::Compare;
use super::creep_fit::Fit;
use crate::terminal::{Failure, Finish};
use clap::Subcommand;

/// Turn recordings of creep tests into numbers somebody can design with
#[derive(Debug, Subcommand)]
pub(crate) enum Creep {
    Analyze(Analyze),
    Fit(Box<Fit>),
    Compare(Compare),
}

impl Creep {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Creep::Analyze(command) => command.run(),
            Creep::Fit(command) => command.run(),
            Creep::Compare(command) => command.run(),
        }
    }
}
