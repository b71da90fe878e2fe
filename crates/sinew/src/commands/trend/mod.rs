//! `sinew trend`: months of offsets, events, and the day a limit is passed.

mod survival;

use super::beside::Arguments;
use super::rope::Ropes;
use crate::files::{Named, check_outputs, write_table};
use crate::terminal::{Failure, Finish, Word, answer, complain};
use clap::{Args, Subcommand};
use sinew_estimate::robot_dir;
use sinew_files::JsonDocument as _;
use sinew_files::date::parse_utc_s;
use sinew_report::text::plain;
use sinew_report::trend::{format_note, html, render_table, trend_series, trend_table};
use sinew_rope::Duty;
use sinew_trend::survival::LifePrior;
use sinew_trend::{Stated, TrendRequest, analyze, read_sessions};
use std::path::PathBuf;

/// Watch tendons over months: where they stand, what happened, when to tension or replace
///
/// FILES are records of sessions: what sinew estimate LOG --baseline FILE --json prints, one per
/// session, or a CSV with the columns time (or cycle), joint, offset_mrad, interval_95_mrad and, optional,
/// shared_interval_95_mrad, temperature_c, robot, baseline, duration_s and more. Exit code 3: a limit is
/// passed, a jump confirmed, or something happened that no error explains.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Examples:\n  \
    sinew trend sessions/*.json --robot robots/biorob-like --tensioned 2026-03-01\n  \
    sinew trend sessions.csv --robot robots/biorob-like --report trend.html"
)]
pub(crate) struct Trend {
    #[command(subcommand)]
    command: Option<TrendCommand>,
    /// Records of sessions, JSON or CSV, in any order
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Robot's folder: ropes, geometry and limits; without it, mrad only
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Day a tendon was tensioned, one joint's or all; repeatable
    #[arg(long, value_name = "[JOINT=]DATE", value_parser = stated)]
    tensioned: Vec<Stated>,
    /// Day a rope was replaced: what was before doesn't count; repeatable
    #[arg(long, value_name = "[JOINT=]DATE", value_parser = stated)]
    replaced: Vec<Stated>,
    /// What the ropes have to do, a block table (TOML, CSV) [default: not known]
    #[arg(long, value_name = "FILE")]
    duty: Option<PathBuf>,
    /// Length of a cycle, s, for a table that counts cycles and has no time
    #[arg(long, value_name = "S", value_parser = crate::args::positive("s"), allow_negative_numbers = true)]
    cycle_s: Option<f64>,
    /// Table of what broke and what was replaced (as for sinew trend survival): when to replace a rope by its
    /// age, where robot.toml has no limit of its strain
    #[arg(long, value_name = "TABLE")]
    life: Option<PathBuf>,
    /// Replace by the age at which so many of such ropes have broken, %
    #[arg(long, value_name = "PERCENT", default_value_t = 10, requires = "life", value_parser = clap::value_parser!(u8).range(1..=90))]
    life_risk: u8,
    #[command(flatten)]
    ropes: Ropes,
    /// How far forecasts look, days from the last session
    #[arg(long, value_name = "DAYS", default_value_t = 1095, value_parser = clap::value_parser!(u32).range(1..=36_500))]
    horizon: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print one JSON document instead of the table
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Write every session, mrad: as recorded, and what the trend knew then; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write levels and forecast over time, rad; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    series: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// No notes on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum TrendCommand {
    /// Live through simulated years of robots: what the trend finds, how far its forecasts hold (runs sinew-bench)
    #[command(
        disable_help_flag = true,
        after_help = "Example:\n  sinew trend simulate-year --robot robots/biorob-like --robots 100 --out years.jsonl"
    )]
    SimulateYear(Arguments),
    Survival(survival::Survival),
}

/// `DATE` or `JOINT=DATE`.
fn stated(text: &str) -> Result<Stated, String> {
    let (joint, date) = match text.split_once('=') {
        Some((joint, date)) if !joint.is_empty() => (Some(joint.to_string()), date),
        Some(_) => return Err("write DATE or JOINT=DATE".into()),
        None => (None, text),
    };
    let time_utc_s = parse_utc_s(date).ok_or_else(|| {
        format!("'{date}' is no date; write such as 2026-03-01 or 2026-03-01T08:30Z")
    })?;
    Ok(Stated {
        joint,
        time_utc_s,
        replaced: false,
    })
}

impl Trend {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<Finish, Failure> {
        match self.command {
            Some(TrendCommand::SimulateYear(arguments)) => arguments.bench("simulate-year"),
            Some(TrendCommand::Survival(survival)) => survival.run(),
            None => self.analyze(),
        }
    }

    fn analyze(&self) -> Result<Finish, Failure> {
        self.check_files()?;
        let loaded = match &self.robot {
            Some(place) => Some(robot_dir::load(place, None)?),
            None => None,
        };
        let robot = loaded.as_ref().map(|l| &l.robot);
        let sorted = read_sessions(&self.files, robot, self.cycle_s)?;
        let catalogue = self.ropes.catalogue(self.quiet)?;
        let request = TrendRequest {
            robot,
            catalogue: &catalogue,
            stated: self.stated(),
            duty: self.duty.as_deref().map(Duty::open).transpose()?,
            life: self.life()?,
            horizon_days: f64::from(self.horizon),
            seed: self.seed,
        };
        let report = analyze(sorted, &request)?;
        write_table(self.csv.as_deref(), || trend_table(&report))?;
        write_table(self.series.as_deref(), || trend_series(&report))?;
        if let Some(path) = &self.report {
            sinew_files::write_file(path, html(&report).as_bytes())?;
        }
        if self.json {
            answer(&report.to_json()?)?;
        } else {
            if !self.quiet {
                for note in &report.notes {
                    complain(Word::Note, &plain(&format_note(note)));
                }
            }
            answer(&render_table(&report))?;
        }
        Ok(Finish::lossy(report.needs_attention))
    }

    /// How long such ropes last, where a table says.
    fn life(&self) -> Result<Option<LifePrior>, Failure> {
        let Some(table) = &self.life else {
            return Ok(None);
        };
        let (lives, name) = survival::lives_of(table)?;
        let ratio = 0.01 * f64::from(self.life_risk);
        Ok(Some(LifePrior::new(&lives, &name, ratio, self.seed)?))
    }

    fn stated(&self) -> Vec<Stated> {
        let replaced = self.replaced.iter().cloned();
        let replaced = replaced.map(|stated| Stated {
            replaced: true,
            ..stated
        });
        self.tensioned.iter().cloned().chain(replaced).collect()
    }

    fn check_files(&self) -> Result<(), Failure> {
        let outputs = [
            ("--csv", self.csv.as_deref()),
            ("--series", self.series.as_deref()),
            ("--report", self.report.as_deref()),
        ];
        let named = |f| ("a file of records", Some(PathBuf::as_path(f)));
        let mut inputs: Vec<Named<'_>> = self.files.iter().map(named).collect();
        inputs.push(("the table of lives", self.life.as_deref()));
        check_outputs(&outputs, &inputs, self.quiet)
    }
}
