//! `sinew rope`: rope catalogue, predictions, selection and pretension.

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
use sinew_report::rope::{namesake, unreadable};
use sinew_rope::{Catalogue, CatalogueError, CatalogueRope};
use std::path::{Path, PathBuf};

/// Select a rope, predict its elongation, plan its pretension
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

/// Rope catalogues.
#[derive(Debug, Args)]
pub(crate) struct Ropes {
    /// Additional rope catalogue (*.toml); ./ropes is always included if present
    #[arg(long = "ropes", value_name = "DIR")]
    folders: Vec<PathBuf>,
}

impl Ropes {
    /// Reads the built-in and additional catalogues; name conflicts and invalid files of ./ropes are printed as notes.
    pub(crate) fn catalogue(&self) -> Result<Catalogue, CatalogueError> {
        let mut implied = vec![Path::new("ropes")];
        implied.retain(|folder| folder.is_dir());
        let folders: Vec<&Path> = self.folders.iter().map(PathBuf::as_path).collect();
        let catalogue = Catalogue::with_implied_folders(&implied, &folders)?;
        for rope in catalogue.unreadable() {
            complain(Word::Note, &plain(&unreadable(rope)));
        }
        for same in catalogue.namesakes() {
            complain(Word::Note, &plain(&namesake(same)));
        }
        Ok(catalogue)
    }
}

/// Finds a rope by name; the error suggests a similar name.
pub(crate) fn find<'a>(catalogue: &'a Catalogue, name: &str) -> Result<&'a CatalogueRope, Failure> {
    catalogue.find(name).map_err(|error| {
        let hint = sinew_files::names::did_you_mean(name, &catalogue.names());
        Failure::Error(format!("{error}{hint}"))
    })
}
