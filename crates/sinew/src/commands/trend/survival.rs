//! `sinew trend survival`: rope lifetimes from failures and replacements.

use crate::files::check_outputs;
use crate::terminal::{Failure, Finish, Word, answer, complain_coded};
use clap::Args;
use sinew_files::JsonDocument as _;
use sinew_files::date::parse_utc_s;
use sinew_report::trend::survival::{html, note_message, render_table};
use sinew_trend::survival::{EventColumns, Lifetimes, analyze_lives, read_lives};
use std::path::{Path, PathBuf};

/// Estimate rope lifetimes from failures, replacements and running ropes
///
/// TABLE is a CSV. Either one row per rope: age_days, age_hours or age_cycles, and end (broken, replaced,
/// running). Or one row per event: date, unit (place of the rope), event (installed, broken, replaced, retired, or
/// text that contains one of these). Estimates the survival function (Kaplan-Meier), a Weibull law, and the
/// benefit of preventive replacement.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew trend survival examples/12-survival/events.csv --report survival.html\n  \
    sinew trend survival tickets.csv --date reported --unit robot,side,cable --monitored robot\n  \
    sinew trend sessions.csv --robot robots/biorob-like --tensioned 2026-03-01 --life examples/12-survival/events.csv")]
pub(super) struct Survival {
    /// Table of ropes or events
    #[arg(value_name = "TABLE")]
    table: PathBuf,
    #[command(flatten)]
    columns: Columns,
    /// Print one JSON document instead of the table
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Write a report with the curves as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
}

/// Column names of the table.
#[derive(Debug, Args)]
struct Columns {
    /// Column with the date of an event
    #[arg(long, value_name = "COLUMN", default_value = "date")]
    date: String,
    /// Column with the type of an event
    #[arg(long, value_name = "COLUMN", default_value = "event")]
    event: String,
    /// Columns that together identify the place of a rope
    #[arg(
        long,
        value_name = "COLUMN,…",
        value_delimiter = ',',
        default_value = "unit"
    )]
    unit: Vec<String>,
    /// Column by which ropes are grouped
    #[arg(long, value_name = "COLUMN")]
    group: Option<String>,
    /// Column of the unit observed as a whole, such as the robot, each until its last event
    /// [default: all until the last event of the table]
    #[arg(long, value_name = "COLUMN", conflicts_with = "until")]
    monitored: Option<String>,
    /// End of observation of ropes without failure
    #[arg(long, value_name = "DATE", value_parser = date)]
    until: Option<f64>,
    /// Assume that failed ropes were replaced the same day
    #[arg(long)]
    repaired: bool,
}

fn date(text: &str) -> Result<f64, String> {
    parse_utc_s(text).ok_or_else(|| format!("'{text}' is not a date; expected e.g. 2026-03-01"))
}

/// Reads lifetimes, and returns them with the name of their table.
pub(super) fn lives_of(table: &Path) -> Result<(Lifetimes, String), Failure> {
    let lives = read_lives(table, &EventColumns::default())?;
    Ok((lives, table.display().to_string()))
}

impl Survival {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let outputs = [("--report", self.report.as_deref())];
        let inputs = [("the table", Some(self.table.as_path()))];
        check_outputs(&outputs, &inputs)?;
        let columns = EventColumns {
            date: self.columns.date.clone(),
            event: self.columns.event.clone(),
            unit: self.columns.unit.clone(),
            group: self.columns.group.clone(),
            monitored: self.columns.monitored.clone(),
            until_utc_s: self.columns.until,
            repaired: self.columns.repaired,
        };
        let lives = read_lives(&self.table, &columns)?;
        let report = analyze_lives(&lives, &self.table.display().to_string());
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
        // Without failures nothing is estimated.
        Ok(match report.groups.iter().all(|group| group.broke == 0) {
            true => Finish::InvalidInput,
            false => Finish::Complete,
        })
    }
}
