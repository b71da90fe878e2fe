//! `sinew baseline`: what a recording right after tensioning teaches.

use super::session_args::read_baseline;
use crate::args::Opening;
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, Word, answer, complain};
use clap::{Args, Subcommand};
use sinew_estimate::session::{self, Learning, SessionError, Warning};
use sinew_estimate::{BaselineDocument, Request};
use sinew_files::JsonDocument as _;
use sinew_model::Gaussian;
use sinew_report::text::{paragraph, plain};
use sinew_report::{session_warnings, tables};
use std::path::{Path, PathBuf};

/// Learn a baseline from a recording taken right after tensioning
///
/// Offsets are zero by definition then, so that stiffness, masses, friction and encoder errors
/// show. The gripper is empty; a dozen poses that move every joint through its range in a minute
/// are a good recording. Then: sinew estimate LOG --baseline FILE
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Example:\n  \
    sinew baseline first-day.mcap --robot robots/biorob-like --out first-day.baseline"
)]
pub(crate) struct Baseline {
    #[command(subcommand)]
    merge: Option<Part>,
    /// Recording taken right after tensioning
    #[arg(required = true)]
    log: Option<PathBuf>,
    /// Robot's folder [default: beside LOG, then the current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Where the baseline goes
    #[arg(long, value_name = "FILE", required = true)]
    out: Option<PathBuf>,
    /// What is known already: of this robot before it was tensioned again, or of its type
    /// (sinew baseline merge)
    #[arg(long, value_name = "FILE")]
    start: Option<PathBuf>,
    /// Temperature during the recording, where it isn't recorded; ± one standard deviation, 2 °C if
    /// not stated
    #[arg(long, value_name = "C[±C]", value_parser = super::session_args::temperature, allow_negative_numbers = true)]
    temperature_c: Option<Gaussian>,
    /// Leave a recorded motor torque out
    #[arg(long)]
    no_motor_torque: bool,
    #[command(flatten)]
    window: super::session_args::Part,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table (no value: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// No progress and no warnings on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

// What else there is to do with baselines.
#[derive(Debug, Subcommand)]
enum Part {
    Merge(super::baseline_merge::Merge),
}

impl Baseline {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        match (&self.merge, &self.log, &self.out) {
            (Some(Part::Merge(merge)), ..) => merge.run(),
            (None, Some(log), Some(out)) => self.learn(log, out),
            // clap asks for both.
            _ => Err(Failure::Refused("LOG and --out FILE are needed".into())),
        }
    }

    fn learn(&self, log: &Path, out: &Path) -> Result<Finish, Failure> {
        let inputs = [
            ("the recording", Some(log)),
            ("--start", self.start.as_deref()),
        ];
        check_outputs(&[("--out", Some(out))], &inputs, self.quiet)?;
        let refused = |e: SessionError| Failure::Refused(e.to_string());
        let window = self.window.window()?;
        let known = read_baseline(self.start.as_deref()).map_err(refused)?;
        let mut request = Request::new(log.to_path_buf());
        request.robot.clone_from(&self.robot);
        request.touches.clone_from(&self.window.touches);
        request.open = self.opening.options()?;
        let bar = Bar::new("learning", self.quiet);
        let learning = Learning {
            known: known.as_ref().map(|(b, file)| (b, file.as_str())),
            motor_torque: !self.no_motor_torque,
            temperature_c: self.temperature_c,
            ..Learning::default()
        };
        let learned = session::learn(&request, window, &learning, &mut |at| {
            bar.set(at.bytes_done as f64, at.bytes_total as f64);
        });
        drop(bar);
        let (baseline, learned) = learned.map_err(refused)?;
        baseline.write(out)?;
        let finish = Finish::lossy(learned.damaged);
        if self.json {
            answer(&BaselineDocument { learned }.to_json()?)?;
            return Ok(finish);
        }
        if !self.quiet {
            let mut learned = learned.clone();
            learned.warnings.retain(|w| *w != Warning::NoBaseline);
            for warning in session_warnings(&learned) {
                complain(Word::Warning, &plain(&warning));
            }
        }
        let written = format!("baseline written to {}", out.display());
        answer(&(tables::baseline(&learned) + &paragraph(&plain(&written), 2)))?;
        Ok(finish)
    }
}
