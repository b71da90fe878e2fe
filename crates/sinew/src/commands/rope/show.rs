//! `sinew rope show`.

use super::{Ropes, find};
use crate::terminal::{Failure, Finish, answer, answer_as};
use clap::Args;
use sinew_report::rope::rope_table;

/// Show all properties of a rope with origin and uncertainty
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew rope show liros-dc000-0301")]
pub(crate) struct Show {
    /// Rope; see `sinew rope list`
    name: String,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the tables
    #[arg(long, conflicts_with = "toml")]
    json: bool,
    /// Print the catalogue entry as template for another rope
    #[arg(long)]
    toml: bool,
}

impl Show {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let catalogue = self.ropes.catalogue()?;
        let rope = find(&catalogue, &self.name)?;
        if self.toml {
            answer(&rope.entry.to_toml())?;
        } else {
            answer_as(self.json, &rope.describe(), |_| rope_table(rope))?;
        }
        Ok(Finish::Complete)
    }
}
