//! `sinew baseline merge`: what several recordings or robots taught, together.

use crate::files::{Named, check_outputs};
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_estimate::baseline::{self, Baseline, MergeOptions};
use sinew_estimate::robot_dir;
use sinew_estimate::session::SessionError;
use sinew_report::tables;
use sinew_report::text::{paragraph, plain};
use std::path::PathBuf;

/// Put together what several baselines learned
///
/// Recordings of one robot teach everything but its offsets together. Robots of one type (--fleet)
/// teach only the masses of their links; stiffness, friction and encoders are each robot's own.
/// The result is a start for sinew baseline LOG --start FILE.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew baseline merge monday.baseline tuesday.baseline --robot robots/biorob-like --out arm.known\n  \
    sinew baseline merge arm-1.baseline arm-2.baseline --fleet --robot robots/biorob-like --out type.known")]
pub(crate) struct Merge {
    /// Baselines, two or more
    #[arg(required = true, num_args = 2.., value_name = "BASELINE")]
    baselines: Vec<PathBuf>,
    /// Robot's folder [default: the current folder]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// The baseline all of them started from (estimate --save); none: each began with robot.toml
    #[arg(long, value_name = "START")]
    common: Option<PathBuf>,
    /// The baselines are of several robots of one type
    #[arg(long, conflicts_with = "common")]
    fleet: bool,
    /// With --fleet: how far the masses of two robots may differ, % (one standard deviation)
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, requires = "fleet", value_parser = scatter)]
    scatter_percent: f64,
    /// Where the result goes
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Print one JSON document instead of the table (no value: null)
    #[arg(long, help_heading = "Output")]
    json: bool,
}

fn scatter(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("'{text}' is no number"))?;
    if value > 0.0 && value <= 100.0 {
        Ok(value)
    } else {
        Err(format!("{value} % must be above 0 and at most 100"))
    }
}

impl Merge {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        let named = |p| ("a baseline", Some(PathBuf::as_path(p)));
        let mut inputs: Vec<Named<'_>> = self.baselines.iter().map(named).collect();
        inputs.push(("--common", self.common.as_deref()));
        check_outputs(&[("--out", Some(&self.out))], &inputs, false)?;
        let refused = |e: SessionError| Failure::Refused(e.to_string());
        let place = self.robot.clone().unwrap_or_else(|| PathBuf::from("."));
        let loaded = robot_dir::load(&place, None).map_err(|e| Failure::Refused(e.to_string()))?;
        let read = |path: &PathBuf| -> Result<(Baseline, String), Failure> {
            Ok((
                Baseline::read(path).map_err(refused)?,
                path.display().to_string(),
            ))
        };
        let parts: Vec<(Baseline, String)> =
            self.baselines.iter().map(read).collect::<Result<_, _>>()?;
        let common = self.common.as_ref().map(read).transpose()?;
        let borrowed: Vec<(&Baseline, &str)> = parts.iter().map(|(b, f)| (b, f.as_str())).collect();
        let options = MergeOptions {
            fleet: self.fleet,
            scatter: 0.01 * self.scatter_percent,
        };
        let (baseline, summary) = baseline::merge(
            &loaded.robot,
            &borrowed,
            common.as_ref().map(|(b, f)| (b, f.as_str())),
            &options,
        )
        .map_err(refused)?;
        baseline.write(&self.out)?;
        answer_as(self.json, &summary, |summary| {
            let written = format!("written to {}", self.out.display());
            tables::merged(summary, self.baselines.len()) + &paragraph(&plain(&written), 2)
        })?;
        Ok(Finish::lossy(false))
    }
}
