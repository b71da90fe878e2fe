//! `sinew log`: content of a recording.

use crate::args::Opening;
use crate::terminal::{Bar, Failure, Finish, answer_as, note};
use clap::{Args, Subcommand};
use sinew_log::{Progress, RecordingInfo};
use std::path::PathBuf;

/// Inspect a recording
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

/// Show the content of a recording: joints, channels, rate, gaps, damage
///
/// Lists all topics with type, number of messages, rate and role. Exit code 3: data lost, 1: topics
/// ambiguous.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  sinew log info monday.mcap\n  sinew log info monday_*.mcap")]
pub(crate) struct Info {
    /// Recording: MCAP, CSV or Parquet, optionally compressed with zstd; a folder, several files or a
    /// quoted pattern for its parts; - for standard input
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Info {
    fn run(&self) -> Result<Finish, Failure> {
        let bar = Bar::new("reading");
        let mut progress = |at: Progress| bar.set(at.bytes_done as f64, at.bytes_total as f64);
        let options = self.opening.options()?;
        note(|| {
            let limits = options.budget.limits();
            let limits = limits.map(|limit| format!("{} at most {}", limit.of, limit.amount()));
            format!("budget: {}", limits.collect::<Vec<_>>().join("; "))
        });
        let info = RecordingInfo::of_files(&self.files, &options, &mut progress);
        drop(bar);
        let info = info?;
        answer_as(self.json, &info, sinew_report::log::render)?;
        Ok(match info.ambiguous.is_empty() {
            true => Finish::lossy(info.lossy),
            false => Finish::InvalidInput,
        })
    }
}
