//! `sinew rope pretension`.

use super::mounted::Mounted;
use super::values::{celsius, duration, share};
use super::{Ropes, find};
use crate::args::positive;
use crate::files::{check_outputs, write_text};
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_report::rope::{plan_table, planned};
use sinew_rope::pretension;
use sinew_rope::task::{PretensionTask, TaskError};
use std::path::PathBuf;

/// How much pretension, how to bed a rope in, and when to tension it again
///
/// Two pictures of the same rope: under constant tension it grows, and a bedding-in procedure
/// takes most of that away beforehand; at constant length its tension falls, and the schedule
/// says when it is below --lowest. With --robot and --joint it is that joint's tendon, with what
/// gives beside the rope, its guides, and the rope that pulls the other way.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  sinew rope pretension liros-dc000-0301 --tension 60 --length 700\n  \
    sinew rope pretension --robot robots/biorob-like --joint elbow --torque 2"
)]
pub(crate) struct Pretension {
    /// Rope [default: the one of the joint's tendon]
    name: Option<String>,
    /// Working tension, N; of two strands their mean [default: the tendon's pretension]
    #[arg(long, value_name = "N", value_parser = positive("N"), required_unless_present = "joint")]
    tension: Option<f64>,
    /// Tension below which it is tensioned again, N [default: 80 % of the working tension]
    #[arg(long, value_name = "N", value_parser = positive("N"))]
    lowest: Option<f64>,
    /// Temperature, °C
    #[arg(long, value_name = "C", default_value = "23", value_parser = celsius, allow_negative_numbers = true)]
    temperature: f64,
    #[command(flatten)]
    mounted: Mounted,
    /// How long it must hold
    #[arg(long, value_name = "TIME", default_value = "1year", value_parser = duration)]
    horizon: f64,
    /// Share of the later elongation that the procedure must take away
    #[arg(long, value_name = "SHARE", default_value = "0.8", value_parser = share)]
    remove: f64,
    /// Draws of the rope's parameters for the intervals
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    draws: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// HTML page
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
        check_outputs(&[("--report", self.report.as_deref())], &[], false)?;
        let catalogue = self.ropes.catalogue(false)?;
        let drive = self.mounted.drive()?;
        let own = drive.as_ref().map(|d| &d.tendon);
        let Some(name) = self.name.as_ref().or(own.and_then(|t| t.rope.as_ref())) else {
            let which = "which rope? name it; sinew rope list shows all";
            return Err(Failure::Refused(which.into()));
        };
        let rope = find(&catalogue, name)?;
        let mut task = PretensionTask {
            tension_n: self.tension,
            lowest_n: self.lowest,
            temperature_c: self.temperature,
            horizon_s: self.horizon,
            remove: self.remove,
            draws: self.draws as usize,
            seed: self.seed,
            ..PretensionTask::default()
        };
        self.mounted.state(&mut task);
        let request = task.request(rope, drive.as_ref()).map_err(refused)?;
        let plan = pretension::plan(rope, &request)?;
        write_text(self.report.as_deref(), || planned(&plan).html())?;
        answer_as(self.json, &plan, plan_table)?;
        Ok(Finish::Complete)
    }
}

/// What is missing, by the names of the options.
fn refused(error: TaskError) -> Failure {
    Failure::Refused(match error {
        TaskError::NoTension => {
            "the joint's tendon states no pretension_n; say --tension N".to_owned()
        }
        TaskError::Lowest {
            lowest_n,
            tension_n,
        } => format!("--lowest {lowest_n} N must be below --tension {tension_n} N"),
        TaskError::TorqueAlone => {
            "--torque needs a second rope that pulls the other way; say --joint-radius MM".into()
        }
        other => other.to_string(),
    })
}
