//! `sinew trend`: months of offsets, events, and the day a limit is passed.

mod year;
mod year_told;

use crate::files::check_outputs;
use crate::terminal::{Failure, Finish, answer, complain};
use crate::text::{paragraph, plain, table};
use clap::{Args, Subcommand};
use sinew_estimate::robot_dir;
use sinew_estimate::trend;
use sinew_estimate::trend::{
    JointTrend, LimitSaid, Stated, TrendReport, TrendRequest, analyze, read_records,
};
use sinew_figure::rounded;
use sinew_files::date::parse_utc_s;
use sinew_files::names::nearest;
use sinew_rope::{Catalogue, Duty};
use std::path::{Path, PathBuf};

/// Watch tendons over months: where they stand, what happened, when to tension or replace
///
/// FILES are records of sessions: what sinew estimate LOG --baseline FILE --json prints, one per
/// session, or a CSV with the columns time, joint, offset_mrad, interval_95_mrad and, optional,
/// temperature_c, robot, baseline, duration_s. Exit code 3: a limit is passed or a jump confirmed.
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
    tensioned: Vec<(Option<String>, f64)>,
    /// Day a rope was replaced: what was before doesn't count; repeatable
    #[arg(long, value_name = "[JOINT=]DATE", value_parser = stated)]
    replaced: Vec<(Option<String>, f64)>,
    /// What the ropes have to do, a block table (TOML, CSV) [default: not known]
    #[arg(long, value_name = "FILE")]
    duty: Option<PathBuf>,
    /// Folder with your own ropes (*.toml); ./ropes is read too where it is there
    #[arg(long = "ropes", value_name = "DIR")]
    ropes: Vec<PathBuf>,
    /// How far forecasts look, days from the last session
    #[arg(long, value_name = "DAYS", default_value_t = 1095, value_parser = clap::value_parser!(u32).range(1..=36_500))]
    horizon: u32,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print one JSON document instead of the table
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Write every session as CSV: as recorded, and what the trend knew then
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    csv: Option<PathBuf>,
    /// Write a report with plots as one HTML file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,
    /// No notes on stderr
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum TrendCommand {
    SimulateYear(year::SimulateYear),
}

/// `DATE` or `JOINT=DATE`.
fn stated(text: &str) -> Result<(Option<String>, f64), String> {
    let (joint, date) = match text.split_once('=') {
        Some((joint, date)) if !joint.is_empty() => (Some(joint.to_string()), date),
        Some(_) => return Err("write DATE or JOINT=DATE".into()),
        None => (None, text),
    };
    let time = parse_utc_s(date).ok_or_else(|| {
        format!("'{date}' is no date; write such as 2026-03-01 or 2026-03-01T08:30Z")
    })?;
    Ok((joint, time))
}

impl Trend {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        if let Some(TrendCommand::SimulateYear(year)) = &self.command {
            return year.run();
        }
        self.check_files()?;
        let mut records = Vec::new();
        for file in &self.files {
            records.extend(read_records(file)?);
        }
        let loaded = match &self.robot {
            Some(place) => Some(robot_dir::load(place, None)?),
            None => None,
        };
        let robot = loaded.as_ref().map(|l| &l.robot);
        let elastic: Vec<String> = robot.map_or(Vec::new(), |r| {
            (r.joint_names().iter().zip(&r.transmissions))
                .filter(|(_, t)| t.is_some())
                .map(|(n, _)| n.clone())
                .collect()
        });
        let known = robot.map(|r| (r.name.as_str(), elastic.as_slice()));
        let sorted = trend::sort(records, known).map_err(|e| hinted(e, &elastic))?;
        let catalogue = self.catalogue()?;
        let request = TrendRequest {
            robot,
            catalogue: &catalogue,
            stated: self.stated(),
            duty: self.duty.as_deref().map(Duty::open).transpose()?,
            horizon_days: f64::from(self.horizon),
            seed: self.seed,
        };
        let report = analyze(sorted, &request)?;
        if let Some(path) = &self.csv {
            trend::write_csv(&report, path)?;
        }
        if let Some(path) = &self.report {
            sinew_files::write_file(path, sinew_report::trend::html(&report).as_bytes())?;
        }
        if self.json {
            answer(&(serde_json::to_string_pretty(&report)? + "\n"))?;
        } else {
            if !self.quiet {
                for note in &report.notes {
                    complain("note", &plain(note));
                }
            }
            answer(&told(&report))?;
        }
        Ok(Finish::lossy(report.attention))
    }

    fn stated(&self) -> Vec<Stated> {
        let each = |list: &[(Option<String>, f64)], replaced: bool| -> Vec<Stated> {
            list.iter()
                .map(|(joint, time_utc_s)| Stated {
                    joint: joint.clone(),
                    time_utc_s: *time_utc_s,
                    replaced,
                })
                .collect()
        };
        let mut all = each(&self.tensioned, false);
        all.extend(each(&self.replaced, true));
        all
    }

    fn catalogue(&self) -> Result<Catalogue, Failure> {
        let here = Path::new("ropes");
        let own = here.is_dir().then_some(here);
        let folders: Vec<&Path> = own
            .into_iter()
            .chain(self.ropes.iter().map(PathBuf::as_path))
            .collect();
        Ok(Catalogue::with_folders(&folders)?)
    }

    fn check_files(&self) -> Result<(), Failure> {
        let outputs: Vec<(&str, &Path)> = [("--csv", &self.csv), ("--report", &self.report)]
            .into_iter()
            .filter_map(|(option, path)| Some((option, path.as_deref()?)))
            .collect();
        let inputs: Vec<(&str, &Path)> = self
            .files
            .iter()
            .map(|f| ("a file of records", f.as_path()))
            .collect();
        check_outputs(&outputs, &inputs)
    }
}

/// A refusal, with the joint that may have been meant.
fn hinted(error: trend::RecordError, joints: &[String]) -> Failure {
    let hint = match &error {
        trend::RecordError::Joint { joint, .. } => nearest(joint, joints),
        _ => None,
    };
    let hint = hint.map_or(String::new(), |n| format!("; did you mean '{n}'?"));
    Failure::Refused(format!("{error}{hint}"))
}

/// `12.3 ± 0.4`.
fn plus_minus(value: Option<[f64; 2]>) -> String {
    value.map_or("–".into(), |[m, h]| {
        format!("{} ± {}", rounded(m, 3), rounded(h, 2))
    })
}

/// `85 (18 to 300)`; the words stand below the table.
fn in_days(limit: &LimitSaid) -> String {
    let whole = |d: Option<f64>| d.map_or("…".into(), |d| format!("{:.0}", d.round()));
    let [low, high] = limit.interval_95_days;
    match limit.state.as_str() {
        "forecast" => format!("{} ({} to {})", whole(limit.days), whole(low), whole(high)),
        state => state.into(),
    }
}

/// The trend as text of at most 80 columns.
fn told(report: &TrendReport) -> String {
    let robot = report.robot.as_deref().unwrap_or("robot");
    let mut out = String::new();
    let head = [
        "tendon",
        "offset\nmrad",
        "stretch\nmm",
        "creep\nmrad/month",
        "re-tension in\ndays",
    ];
    let rows = report.joints.iter().map(|j| {
        let limit = j.limits.iter().find(|l| l.kind == "re-tension");
        vec![
            plain(&j.name),
            plus_minus(Some(j.offset_mrad)),
            plus_minus(j.elongation_mm),
            plus_minus(Some(j.rate_mrad_per_month)),
            limit.map_or("–".into(), in_days),
        ]
    });
    let days = (report.joints.iter().map(|j| &j.first_day).min())
        .zip(report.joints.iter().map(|j| &j.last_day).max());
    if let Some((first, last)) = days {
        out.push_str(&paragraph(
            &plain(&format!(
                "{robot}: {first} to {last}; ± and brackets are 95 %"
            )),
            2,
        ));
    }
    out.push_str(&table(&head, rows.collect(), 1));
    out.push('\n');
    for joint in &report.joints {
        out.push_str(&paragraph(
            &plain(&format!("{}: {}", joint.name, joint.verdict)),
            2,
        ));
        out.push_str(&said(joint));
    }
    out
}

/// Events, other limits and the basis of one tendon.
fn said(joint: &JointTrend) -> String {
    let mut out = String::new();
    let mut line = |text: String| out.push_str(&crate::text::indented(&plain(&text), 2, 4));
    for event in &joint.events {
        let by = event.size_mrad.map_or(String::new(), |v| {
            format!(" by {} mrad", plus_minus(Some(v)))
        });
        line(format!(
            "{}: {}{by}; {}",
            event.day, event.kind, event.meaning
        ));
    }
    for limit in &joint.limits {
        if joint.verdict.ends_with(&limit.said) {
            continue;
        }
        line(format!(
            "{} at {}: {}",
            limit.kind, limit.stated, limit.said
        ));
    }
    line(format!(
        "{} sessions, {} of them without information",
        joint.sessions, joint.without_information
    ));
    line(format!("rests on: {}", joint.basis));
    out
}
