//! `sinew baseline`: records a baseline directly after tensioning.

use super::session_args::read_baseline;
use crate::args::Opening;
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, Word, answer, complain_coded};
use clap::{Args, Subcommand};
use sinew_estimate::session::{self, Learning, SessionError, Warning};
use sinew_estimate::{BaselineDocument, Request};
use sinew_files::JsonDocument as _;
use sinew_model::Gaussian;
use sinew_report::text::{paragraph, plain};
use sinew_report::{session_warnings, tables};
use std::path::{Path, PathBuf};

/// Estimate a baseline from a recording made directly after tensioning
///
/// Offsets are zero by definition, so that stiffness, masses, friction and encoder errors are
/// identifiable. Record with an empty gripper about 12 poses that use the range of each joint, for
/// one minute. Then: sinew estimate LOG --baseline FILE
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
    /// Recording made directly after tensioning
    #[arg(required = true)]
    log: Option<PathBuf>,
    /// Robot folder [default: folder of LOG, then current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Output file of the baseline
    #[arg(long, value_name = "FILE", required = true)]
    out: Option<PathBuf>,
    /// Prior: baseline of this robot before re-tensioning, or merged baseline of its type
    /// (sinew baseline merge) [default: robot.toml]
    #[arg(long, value_name = "FILE")]
    start: Option<PathBuf>,
    /// Temperature during the recording if not recorded, °C, ± standard deviation [default: 2 °C]
    #[arg(long, alias = "temperature-c", value_name = "TEMPERATURE[±K]", value_parser = super::session_args::temperature, allow_hyphen_values = true)]
    temperature: Option<Gaussian>,
    /// Ignore a recorded motor torque
    #[arg(long)]
    no_motor_torque: bool,
    #[command(flatten)]
    window: super::session_args::Part,
    #[command(flatten)]
    opening: Opening,
    /// Print one JSON document instead of the table (missing values: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
}

// Subcommands of `sinew baseline`.
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
            // clap requires both.
            _ => Err(Failure::Error("LOG or --out FILE missing".into())),
        }
    }

    fn learn(&self, log: &Path, out: &Path) -> Result<Finish, Failure> {
        let inputs = [
            ("the recording", Some(log)),
            ("--start", self.start.as_deref()),
        ];
        check_outputs(&[("--out", Some(out))], &inputs)?;
        let failure = |e: SessionError| Failure::Error(e.to_string());
        let window = self.window.window()?;
        let known = read_baseline(self.start.as_deref()).map_err(failure)?;
        let mut request = Request::new(log.to_path_buf());
        request.robot.clone_from(&self.robot);
        request.touches.clone_from(&self.window.touches);
        request.open = self.opening.options()?;
        let bar = Bar::new("estimating baseline");
        let learning = Learning {
            prior: known.as_ref().map(|(b, file)| (b, file.as_str())),
            motor_torque: !self.no_motor_torque,
            temperature_c: self.temperature,
            ..Learning::default()
        };
        let learned = session::learn(&request, window, &learning, &mut |at| {
            bar.set(at.bytes_done as f64, at.bytes_total as f64);
        });
        drop(bar);
        let (baseline, learned) = learned.map_err(failure)?;
        baseline.write(out)?;
        let finish = Finish::lossy(learned.damaged);
        if self.json {
            answer(&BaselineDocument { learned }.to_json()?)?;
            return Ok(finish);
        }
        let mut shown = learned.clone();
        shown.warnings.retain(|w| *w != Warning::NoBaseline);
        for warning in session_warnings(&shown) {
            complain_coded(Word::Warning, &warning);
        }
        let written = format!("baseline written to {}", out.display());
        answer(&(tables::baseline(&learned, &baseline.joints) + &paragraph(&plain(&written), 2)))?;
        Ok(finish)
    }
}
