//! `sinew rope pretension`.

use super::mounted::Mounted;
use super::{Ropes, find};
use crate::files::{check_outputs, write_text};
use crate::quantity::{
    Force, Share, Temperature, Time, above_zero, duration, part, rope_temperature,
};
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_report::rope::{plan_table, planned};
use sinew_rope::pretension;
use sinew_rope::task::{PretensionTask, TaskError};
use std::path::PathBuf;

/// Plan pretension, preconditioning and re-tensioning of a rope
///
/// At constant tension the rope elongates; a preconditioning procedure removes most of this in
/// advance. At constant length its tension falls; the schedule lists when it falls below --lowest.
/// --robot and --joint select the tendon of a joint with its series compliance, guides and
/// antagonistic rope.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  sinew rope pretension liros-dc000-0301 --tension 60 --length 700\n  \
    sinew rope pretension --robot robots/biorob-like --joint elbow --torque 2"
)]
pub(crate) struct Pretension {
    /// Rope [default: of the joint tendon]
    name: Option<String>,
    /// Working tension, N, mean of two strands [default: pretension of the tendon]
    #[arg(long, value_name = "FORCE", value_parser = above_zero::<Force>, required_unless_present = "joint")]
    tension: Option<Force>,
    /// Minimum tension before re-tensioning, N [default: 80 % of the working tension]
    #[arg(long, value_name = "FORCE", value_parser = above_zero::<Force>)]
    lowest: Option<Force>,
    /// Temperature, °C
    #[arg(long, value_name = "TEMPERATURE", default_value = "23°C", value_parser = rope_temperature, allow_hyphen_values = true)]
    temperature: Temperature,
    #[command(flatten)]
    mounted: Mounted,
    /// Planning horizon, s, e.g. 6months
    #[arg(long, value_name = "TIME", default_value = "1year", value_parser = duration)]
    horizon: Time,
    /// Share of the later elongation to be removed by preconditioning, ratio
    #[arg(long, value_name = "SHARE", default_value = "80%", value_parser = part)]
    remove: Share,
    /// Number of parameter draws for the intervals
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    draws: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write an HTML report
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    ropes: Ropes,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
}

impl Pretension {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        check_outputs(&[("--report", self.report.as_deref())], &[])?;
        let catalogue = self.ropes.catalogue()?;
        let drive = self.mounted.drive()?;
        let own = drive.as_ref().map(|d| &d.tendon);
        let Some(name) = self.name.as_ref().or(own.and_then(|t| t.rope.as_ref())) else {
            let missing = "rope missing; specify its name (see sinew rope list)";
            return Err(Failure::Error(missing.into()));
        };
        let rope = find(&catalogue, name)?;
        let mut task = PretensionTask {
            tension_n: self.tension.map(|force| force.0),
            lowest_n: self.lowest.map(|force| force.0),
            temperature_c: self.temperature.0,
            horizon_s: self.horizon.0,
            remove: self.remove.0,
            draws: self.draws as usize,
            seed: self.seed,
            ..PretensionTask::default()
        };
        self.mounted.apply(&mut task);
        let request = task.request(rope, drive.as_ref()).map_err(task_error)?;
        let plan = pretension::plan(rope, &request)?;
        write_text(self.report.as_deref(), || planned(&plan).html())?;
        answer_as(self.json, &plan, plan_table)?;
        Ok(Finish::Complete)
    }
}

/// Converts the error of a task to a message with option names.
fn task_error(error: TaskError) -> Failure {
    Failure::Error(match error {
        TaskError::NoTension => {
            "pretension_n missing for the tendon of this joint; specify --tension FORCE".to_owned()
        }
        TaskError::Lowest {
            lowest_n,
            tension_n,
        } => format!("--lowest {lowest_n} N must be below --tension {tension_n} N"),
        TaskError::TorqueAlone => {
            "--torque requires an antagonistic rope; specify --joint-radius LENGTH".into()
        }
        other => other.to_string(),
    })
}
