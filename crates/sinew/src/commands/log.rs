//! `sinew log`: what a recording holds.

use crate::args::Opening;
use crate::terminal::{Bar, Failure, Finish, answer_as};
use clap::{Args, Subcommand};
use sinew_log::{Progress, RecordingInfo};
use std::path::PathBuf;

/// Look into a recording
#[derive(Debug, Subcommand)]
pub(crate) enum Log {
    Info(Info),
}

impl Log {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match self {
            Self::Info(info) => info.run(),
        }
    }
}

/// Read a recording to its end and say what it holds: joints, channels, rate, gaps, damage
///
/// Every topic with its type, count and rate, and what Sinew takes it for. Exit code 3 when data was
/// lost, 1 when several topics could be one side.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew log info monday.mcap\n  sinew log info monday_*.mcap")]
pub(crate) struct Info {
    /// Recording: MCAP, CSV or Parquet, packed with zstd or not; a folder, several files or a
    /// pattern in quotes are its parts; - is standard input
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    /// No progress on stderr
    #[arg(long)]
    quiet: bool,
}

impl Info {
    fn run(&self) -> Result<Finish, Failure> {
        let bar = Bar::new("reading", self.quiet);
        let mut progress = |at: Progress| bar.set(at.bytes_done as f64, at.bytes_total as f64);
        let options = self.opening.options()?;
        let info = RecordingInfo::of_files(&self.files, &options, &mut progress);
        drop(bar);
        let info = info?;
        answer_as(self.json, &info, sinew_report::log::render)?;
        Ok(match info.ambiguous.is_empty() {
            true => Finish::lossy(info.lossy),
            false => Finish::Refused,
        })
    }
}
