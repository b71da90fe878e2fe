//! `sinew rope predict`.

use super::duty_args::DutyArgs;
use super::{Ropes, find};
use crate::files::{check_outputs, write_table, write_text};
use crate::quantity::{Force, at_least_zero};
use crate::terminal::{Bar, Failure, Finish, answer_as};
use clap::Args;
use sinew_report::rope::{curve_times, predicted, prediction_series, prediction_table};
use sinew_rope::law::RopeLoad;
use sinew_rope::predict;
use std::path::PathBuf;

/// Predict the elongation of a rope under a duty
///
/// "after pretensioning" is from 1 min after the first loading, "total" from the new, slack rope. 95 %
/// intervals in brackets, from draws of the rope parameters within their uncertainty. If the rope fails
/// within the requested times, there are no values from then on, and the exit code is 3.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  sinew rope predict liros-dc000-0301 --tension 60 --length 700\n  \
    sinew rope predict --robot robots/biorob-like --joint elbow --stroke 80\n  \
    sinew rope predict --recording monday.mcap --robot robots/biorob-like --joint elbow"
)]
pub(crate) struct Predict {
    /// Rope [default: of the joint tendon]
    name: Option<String>,
    #[command(flatten)]
    duty: DutyArgs,
    /// Tension to which elongations refer, N [default: mean of the duty]
    #[arg(long, value_name = "FORCE", value_parser = at_least_zero::<Force>)]
    read_at: Option<Force>,
    #[command(flatten)]
    ropes: Ropes,
    /// Write an HTML report
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write the curve over time; .csv or .parquet
    #[arg(long, value_name = "FILE")]
    series: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Predict {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let outputs = [
            ("--report", self.report.as_deref()),
            ("--series", self.series.as_deref()),
        ];
        check_outputs(&outputs, &[])?;
        let catalogue = self.ropes.catalogue()?;
        let mut resolved = self.duty.resolve()?;
        let Some(name) = self.name.as_ref().or(resolved.rope.as_ref()) else {
            return Err(Failure::Error(
                "rope missing; specify its name (see sinew rope list)".into(),
            ));
        };
        let rope = find(&catalogue, name)?;
        let celsius = self.duty.temperature();
        resolved.request.read_at = self
            .read_at
            .map(|force| RopeLoad::celsius(force.0, celsius));
        let draws = resolved.request.draws as f64;
        let bar = Bar::new("draws");
        let found = predict::predict_with_progress(rope, &resolved.request, &|done| {
            bar.set(done as f64, draws);
        })?;
        drop(bar);
        if self.report.is_some() || self.series.is_some() {
            let cycle_s = resolved.request.duty.summary().duration_s;
            resolved.request.times_s = curve_times(&resolved.request.times_s, cycle_s);
            let curve = predict::predict(rope, &resolved.request)?;
            write_table(self.series.as_deref(), || prediction_series(&curve))?;
            write_text(self.report.as_deref(), || {
                predicted(&found, &curve.readings).html()
            })?;
        }
        answer_as(self.json, &found, prediction_table)?;
        Ok(Finish::lossy(found.ends()))
    }
}
