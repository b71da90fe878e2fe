//! `sinew rope`: the catalogue, and what a duty does to its ropes.

mod duty_args;
mod list;
mod mounted;
mod predict;
mod pretension;
mod select;
mod show;
mod values;

use crate::terminal::{Failure, Finish, Word, complain};
use crate::text::plain;
use clap::{Args, Subcommand};
pub(crate) use duty_args::DutyArgs;
use sinew_report::rope::namesake;
use sinew_rope::{Catalogue, CatalogueError, CatalogueRope};
use std::path::{Path, PathBuf};
pub(crate) use values::{celsius, duration};

/// Choose a rope, predict how far it stretches, plan its pretension
#[derive(Debug, Subcommand)]
pub(crate) enum Rope {
    List(list::List),
    Show(show::Show),
    Predict(Box<predict::Predict>),
    Select(Box<select::Select>),
    Pretension(Box<pretension::Pretension>),
}

impl Rope {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::List(command) => command.run(),
            Self::Show(command) => command.run(),
            Self::Predict(command) => command.run(),
            Self::Select(command) => command.run(),
            Self::Pretension(command) => command.run(),
        }
    }
}

/// Where ropes come from.
#[derive(Debug, Args)]
pub(crate) struct Ropes {
    /// Folder with your own ropes (*.toml); ./ropes is read too where it is there
    #[arg(long = "ropes", value_name = "DIR")]
    folders: Vec<PathBuf>,
}

impl Ropes {
    /// Shipped ropes and one's own; names taken twice are noted on stderr unless `quiet`.
    pub(crate) fn catalogue(&self, quiet: bool) -> Result<Catalogue, CatalogueError> {
        let here = Path::new("ropes");
        let mut folders: Vec<&Path> = Vec::new();
        if here.is_dir() {
            folders.push(here);
        }
        folders.extend(self.folders.iter().map(PathBuf::as_path));
        let catalogue = Catalogue::with_folders(&folders)?;
        for same in catalogue.namesakes().iter().filter(|_| !quiet) {
            complain(Word::Note, &plain(&namesake(same)));
        }
        Ok(catalogue)
    }
}

/// A rope by name, with the name somebody may have meant.
pub(crate) fn find<'a>(catalogue: &'a Catalogue, name: &str) -> Result<&'a CatalogueRope, Failure> {
    catalogue.find(name).map_err(|error| {
        let hint = sinew_files::names::did_you_mean(name, &catalogue.names());
        Failure::Refused(format!("{error}{hint}"))
    })
}
