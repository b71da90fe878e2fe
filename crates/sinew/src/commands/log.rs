//! `sinew log`: what a recording holds.

use crate::args::Opening;
use crate::terminal::{Bar, Failure, Finish, answer_as};
use clap::{Args, Subcommand};
use sinew_log::{Ambiguity, LogError, Pace, Recording, TopicUse};
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
        let (mut recording, open) = self.open()?;
        let mut pace = Pace::default();
        let bar = Bar::new("reading", self.quiet);
        while let Some(frame) = recording.next_frame()? {
            let (time_ns, segment) = (frame.time_ns, frame.segment);
            pace.frame(time_ns, segment);
            if pace.frames().is_multiple_of(8192) {
                let at = recording.progress();
                bar.set(at.bytes_done as f64, at.bytes_total as f64);
            }
        }
        drop(bar);
        if pace.frames() == 0 {
            return Err(nothing(&recording));
        }
        let names: Vec<String> = (self.files.iter())
            .map(|f| f.display().to_string())
            .collect();
        let info = pace.info(&recording, &names.join(", ")).undecided(open);
        answer_as(self.json, &info, sinew_report::log::render)?;
        Ok(match info.ambiguous.is_empty() {
            true => Finish::lossy(info.lossy),
            false => Finish::Refused,
        })
    }

    /// The recording, and the sides for which a topic was taken at will to look into it.
    fn open(&self) -> Result<(Recording, Vec<Ambiguity>), Failure> {
        let mut options = self.opening.options()?;
        let mut open = Vec::<Ambiguity>::new();
        loop {
            match sinew_log::open_parts(&self.files, &options) {
                Err(LogError::Ambiguous(side)) if open.iter().all(|o| o.side != side.side) => {
                    let first = side.candidates.first().cloned();
                    match side.side {
                        TopicUse::MotorSide => options.motor_topic = first,
                        _ => options.joint_state_topic = first,
                    }
                    open.push(side);
                }
                opened => return Ok((opened?, open)),
            }
        }
    }
}

/// Why a recording that could be opened has no frame.
fn nothing(recording: &Recording) -> Failure {
    let health = recording.health();
    let why = match (health.rows_without_time, health.undecodable) {
        (0, 0) => "it has no row and no message".to_owned(),
        (0, messages) => format!("none of {messages} messages can be decoded"),
        (rows, _) => format!("none of {rows} rows has a time"),
    };
    LogError::NotARecording {
        file: recording.name().to_owned(),
        reason: format!("it holds no frame: {why}"),
        columns: Vec::new(),
    }
    .into()
}
