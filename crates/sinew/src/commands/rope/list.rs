//! `sinew rope list`.

use super::Ropes;
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_report::rope::catalogue_table;

/// List the ropes of the catalogue
///
/// d: diameter; –: not published; assumed: parameters of the creep law that are assumed, of all.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew rope list --ropes my-ropes")]
pub(crate) struct List {
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl List {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let catalogue = self.ropes.catalogue()?;
        answer_as(self.json, &catalogue.list(), |_| {
            catalogue_table(&catalogue)
        })?;
        Ok(Finish::Complete)
    }
}
