//! `sinew rope pretension`.

use super::values::{celsius, duration, share};
use super::{Ropes, find};
use crate::args::positive;
use crate::files::{check_outputs, write_text};
use crate::terminal::{Failure, Finish, answer_as};
use clap::Args;
use sinew_report::rope::{plan_table, planned};
use sinew_rope::pretension::{self, Request};
use std::path::PathBuf;

/// How much pretension, how to bed a rope in, and when to tension it again
///
/// Two pictures of the same rope: under constant tension it grows, and a bedding-in procedure
/// takes most of that away beforehand; at constant length its tension falls, and the schedule
/// says when it is below --lowest.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  sinew rope pretension liros-dc000-0301 --tension 60 --length 700"
)]
pub(crate) struct Pretension {
    /// Rope
    name: String,
    /// Working tension, N
    #[arg(long, value_name = "N", value_parser = positive("N"))]
    tension: f64,
    /// Tension below which it is tensioned again, N [default: 80 % of the working tension]
    #[arg(long, value_name = "N", value_parser = positive("N"))]
    lowest: Option<f64>,
    /// Temperature, °C
    #[arg(long, value_name = "C", default_value = "23", value_parser = celsius, allow_negative_numbers = true)]
    temperature: f64,
    /// Length of the strand, mm
    #[arg(long, value_name = "MM", default_value = "1000", value_parser = positive("mm"))]
    length: f64,
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
        let rope = find(&catalogue, &self.name)?;
        let lowest_n = self.lowest.unwrap_or(0.8 * self.tension);
        if lowest_n >= self.tension {
            return Err(Failure::Refused(format!(
                "--lowest {lowest_n} N must be below --tension {} N",
                self.tension
            )));
        }
        let plan = pretension::plan(
            rope,
            &Request {
                tension_n: self.tension,
                temperature_c: self.temperature,
                length_m: 1e-3 * self.length,
                horizon_s: self.horizon,
                lowest_n,
                remove: self.remove,
                draws: self.draws as usize,
                seed: self.seed,
            },
        )?;
        write_text(self.report.as_deref(), || planned(&plan).html())?;
        answer_as(self.json, &plan, plan_table)?;
        Ok(Finish::Complete)
    }
}
