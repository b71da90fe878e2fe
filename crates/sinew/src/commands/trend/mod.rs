//! `sinew trend`: trend of offsets over sessions, events, and forecast of limits.

mod survival;

use super::external::Arguments;
use super::rope::Ropes;
use crate::files::{Named, check_outputs, write_table};
use crate::quantity::{Share, Time, duration, part};
use crate::terminal::{Bar, Failure, Finish, Word, answer, complain_coded};
use clap::{Args, Subcommand};
use sinew_estimate::robot_dir;
use sinew_files::JsonDocument as _;
use sinew_files::date::{DAY_S, parse_utc_s};
use sinew_report::trend::{html, note_message, render_table, trend_series, trend_table};
use sinew_rope::Duty;
use sinew_trend::survival::LifePrior;
use sinew_trend::{Stated, TrendRequest, analyze_with_progress, read_sessions};
use std::path::PathBuf;

/// Analyse the trend of tendons over sessions, and forecast re-tensioning and replacement
///
/// FILES are session records: JSON of sinew estimate LOG --baseline FILE --json, one per session, or
/// a CSV with the columns time (or cycle), joint, offset_mrad, interval_95_mrad and optionally
/// shared_interval_95_mrad, temperature_c, robot, baseline, duration_s and others. Exit code 3: limit
/// exceeded, or step change confirmed or suspected.
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
    /// Session records, JSON or CSV, in any order
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Robot folder with ropes, geometry and limits [default: none, results in mrad only]
    #[arg(long, value_name = "DIR")]
    robot: Option<PathBuf>,
    /// Date of tensioning, of one joint or all (repeatable)
    #[arg(long, value_name = "[JOINT=]DATE", value_parser = stated)]
    tensioned: Vec<Stated>,
    /// Date of rope replacement, of one joint or all; earlier sessions are ignored (repeatable)
    #[arg(long, value_name = "[JOINT=]DATE", value_parser = stated)]
    replaced: Vec<Stated>,
    /// Duty of the ropes, block table (TOML, CSV) [default: unknown peak loads]
    #[arg(long, value_name = "FILE")]
    duty: Option<PathBuf>,
    /// Duration of a cycle, s, for a table with cycles and without time
    #[arg(long, alias = "cycle-s", value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    cycle: Option<Time>,
    /// Table of rope failures and replacements (see sinew trend survival) for age-based replacement
    /// of ropes without strain limit in robot.toml
    #[arg(long, value_name = "TABLE")]
    life: Option<PathBuf>,
    /// Share of failed ropes that defines the replacement age, ratio
    #[arg(long, value_name = "SHARE", default_value = "10%", requires = "life", value_parser = part)]
    life_risk: Share,
    #[command(flatten)]
    ropes: Ropes,
    /// Forecast horizon after the last session, s, e.g. 3years
    #[arg(long, value_name = "TIME", default_value = "1095d", value_parser = horizon)]
    horizon: Time,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print one JSON document instead of the table
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Write all sessions in SI units, recorded and estimated; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write levels and forecast over time, rad; .csv or .parquet
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    series: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
enum TrendCommand {
    /// Simulate years of robots: events found by the trend, coverage of its forecasts (runs sinew-bench)
    #[command(
        disable_help_flag = true,
        after_help = "Example:\n  sinew trend simulate --robot robots/biorob-like --robots 100 --out years.jsonl"
    )]
    Simulate(Arguments),
    Survival(survival::Survival),
}

/// Parses a horizon of at least one day.
fn horizon(text: &str) -> Result<Time, String> {
    match duration(text)? {
        time if time.0 >= DAY_S => Ok(time),
        time => Err(format!(
            "{} s must be at least one day; days need their unit, e.g. 90d",
            time.0
        )),
    }
}

/// Parses `DATE` or `JOINT=DATE`.
fn stated(text: &str) -> Result<Stated, String> {
    let (joint, date) = match text.split_once('=') {
        Some((joint, date)) if !joint.is_empty() => (Some(joint.to_string()), date),
        Some(_) => return Err("expected DATE or JOINT=DATE".into()),
        None => (None, text),
    };
    let time_utc_s = parse_utc_s(date).ok_or_else(|| {
        format!("'{date}' is not a date; expected e.g. 2026-03-01 or 2026-03-01T08:30Z")
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
            Some(TrendCommand::Simulate(arguments)) => arguments.bench("trend-simulate"),
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
        let sorted = read_sessions(&self.files, robot, self.cycle.map(|time| time.0))?;
        let catalogue = self.ropes.catalogue()?;
        let request = TrendRequest {
            robot,
            catalogue: &catalogue,
            stated: self.stated(),
            duty: self.duty.as_deref().map(Duty::open).transpose()?,
            life: self.life()?,
            horizon_days: self.horizon.0 / DAY_S,
            seed: self.seed,
        };
        let bar = Bar::new("creep curves");
        let report = analyze_with_progress(sorted, &request, &|done| bar.set(done, 1.0))?;
        drop(bar);
        write_table(self.csv.as_deref(), || trend_table(&report))?;
        write_table(self.series.as_deref(), || trend_series(&report))?;
        if let Some(path) = &self.report {
            sinew_files::write_file(path, html(&report).as_bytes())?;
        }
        if self.json {
            answer(&report.to_json()?)?;
        } else {
            for note in &report.notes {
                complain_coded(Word::Note, &note_message(note));
            }
            answer(&render_table(&report))?;
        }
        Ok(Finish::lossy(report.action_required))
    }

    /// Reads the lifetimes, if a table is specified.
    fn life(&self) -> Result<Option<LifePrior>, Failure> {
        let Some(table) = &self.life else {
            return Ok(None);
        };
        let (lives, name) = survival::lives_of(table)?;
        Ok(Some(LifePrior::new(
            &lives,
            &name,
            self.life_risk.0,
            self.seed,
        )?))
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
        check_outputs(&outputs, &inputs)
    }
}
