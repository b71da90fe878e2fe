//! `sinew trend survival`: how long ropes last, from what broke and what was replaced.

use crate::files::check_outputs;
use crate::terminal::{Failure, Finish, Word, answer, complain};
use clap::Args;
use sinew_files::JsonDocument as _;
use sinew_files::date::parse_utc_s;
use sinew_report::text::plain;
use sinew_report::trend::survival::{format_note, html, render_table};
use sinew_trend::survival::{EventColumns, Lives, analyze_lives, read_lives};
use std::path::{Path, PathBuf};

/// How long ropes last: from a table of what broke and what was replaced, with what runs still
///
/// TABLE is a CSV. A row a rope: age_days, age_hours or age_cycles, and end (broken, replaced, running). Or a row an
/// event: date, unit (the place of the rope), event (installed, broken, replaced, retired, or words that hold one of
/// these). Tells the share that lasts (Kaplan and Meier), a Weibull law, and whether replacing in time helps.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    sinew trend survival examples/12-survival/events.csv --report survival.html\n  \
    sinew trend survival tickets.csv --date reported --unit robot,side,cable --watched robot\n  \
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
    /// No notes on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

/// Which columns say what.
#[derive(Debug, Args)]
struct Columns {
    /// Column of the day of an event
    #[arg(long, value_name = "COLUMN", default_value = "date")]
    date: String,
    /// Column of what happened
    #[arg(long, value_name = "COLUMN", default_value = "event")]
    event: String,
    /// Columns that name the place together
    #[arg(
        long,
        value_name = "COLUMN,…",
        value_delimiter = ',',
        default_value = "unit"
    )]
    unit: Vec<String>,
    /// Column by which ropes are counted apart, too
    #[arg(long, value_name = "COLUMN")]
    group: Option<String>,
    /// Column whose places were watched together, such as the robot: each until its last event
    /// [default: all until the last event of the table]
    #[arg(long, value_name = "COLUMN", conflicts_with = "until")]
    watched: Option<String>,
    /// Day until which ropes that didn't break were watched
    #[arg(long, value_name = "DATE", value_parser = date)]
    until: Option<f64>,
    /// A rope that broke was replaced the same day, though no row says so
    #[arg(long)]
    repaired: bool,
}

fn date(text: &str) -> Result<f64, String> {
    parse_utc_s(text).ok_or_else(|| format!("'{text}' is no date; write such as 2026-03-01"))
}

/// Lives with the name of their table.
pub(super) fn lives_of(table: &Path) -> Result<(Lives, String), Failure> {
    let lives = read_lives(table, &EventColumns::default())?;
    Ok((lives, table.display().to_string()))
}

impl Survival {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let outputs = [("--report", self.report.as_deref())];
        let inputs = [("the table", Some(self.table.as_path()))];
        check_outputs(&outputs, &inputs, self.quiet)?;
        let columns = EventColumns {
            date: self.columns.date.clone(),
            event: self.columns.event.clone(),
            unit: self.columns.unit.clone(),
            group: self.columns.group.clone(),
            watched: self.columns.watched.clone(),
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
            if !self.quiet {
                for note in &report.notes {
                    complain(Word::Note, &plain(&format_note(note)));
                }
            }
            answer(&render_table(&report))?;
        }
        // Without one that broke nothing is estimated.
        Ok(match report.groups.iter().all(|group| group.broke == 0) {
            true => Finish::Refused,
            false => Finish::Complete,
        })
    }
}
