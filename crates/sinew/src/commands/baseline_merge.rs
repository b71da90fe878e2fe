//! `sinew baseline merge`: merges baselines of several recordings or robots.

use crate::files::{Named, check_outputs};
use crate::quantity::{Share, part};
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_estimate::baseline::{self, Baseline, MergeOptions};
use sinew_estimate::robot_dir;
use sinew_estimate::session::SessionError;
use sinew_report::tables;
use sinew_report::text::{paragraph, plain};
use std::path::PathBuf;

/// Merge baselines of several recordings or robots
///
/// Recordings of one robot pool all parameters except offsets. Robots of one type (--fleet) pool the
/// masses of their links only; stiffness, friction and encoders remain per robot. The result is a
/// prior for sinew baseline LOG --start FILE.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew baseline merge monday.baseline tuesday.baseline --robot robots/biorob-like --out arm.prior\n  \
    sinew baseline merge arm-1.baseline arm-2.baseline --fleet --robot robots/biorob-like --out type.prior")]
pub(crate) struct Merge {
    /// Baselines, two or more
    #[arg(required = true, num_args = 2.., value_name = "BASELINE")]
    baselines: Vec<PathBuf>,
    /// Robot folder [default: current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Common prior of all baselines (estimate --save) [default: robot.toml]
    #[arg(long, value_name = "START")]
    common: Option<PathBuf>,
    /// Baselines are of several robots of one type
    #[arg(long, conflicts_with = "common")]
    fleet: bool,
    /// Scatter of the masses between robots with --fleet, ratio (standard deviation)
    #[arg(long, value_name = "SHARE", default_value = "1%", requires = "fleet", value_parser = part)]
    scatter: Share,
    /// Output file of the merged baseline
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Print one JSON document instead of the table (missing values: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
}

impl Merge {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let named = |p| ("a baseline", Some(PathBuf::as_path(p)));
        let mut inputs: Vec<Named<'_>> = self.baselines.iter().map(named).collect();
        inputs.push(("--common", self.common.as_deref()));
        check_outputs(&[("--out", Some(&self.out))], &inputs)?;
        let failure = |e: SessionError| Failure::Error(e.to_string());
        let place = self.robot.clone().unwrap_or_else(|| PathBuf::from("."));
        let loaded = robot_dir::load(&place, None).map_err(|e| Failure::Error(e.to_string()))?;
        let read = |path: &PathBuf| -> Result<(Baseline, String), Failure> {
            Ok((
                Baseline::read(path).map_err(failure)?,
                path.display().to_string(),
            ))
        };
        let parts: Vec<(Baseline, String)> =
            self.baselines.iter().map(read).collect::<Result<_, _>>()?;
        let common = self.common.as_ref().map(read).transpose()?;
        let borrowed: Vec<(&Baseline, &str)> = parts.iter().map(|(b, f)| (b, f.as_str())).collect();
        let options = MergeOptions {
            fleet: self.fleet,
            scatter: self.scatter.0,
        };
        let (baseline, summary) = baseline::merge(
            &loaded.robot,
            &borrowed,
            common.as_ref().map(|(b, f)| (b, f.as_str())),
            &options,
        )
        .map_err(failure)?;
        baseline.write(&self.out)?;
        answer_as(self.json, &summary, |summary| {
            let written = format!("written to {}", self.out.display());
            tables::merged(summary, self.baselines.len()) + &paragraph(&plain(&written), 2)
        })?;
        Ok(Finish::lossy(false))
    }
}
