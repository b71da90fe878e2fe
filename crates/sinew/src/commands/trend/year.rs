//! `sinew trend simulate-year`: how good the trend is on years whose truth is known.

use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer};
use crate::text::{paragraph, table};
use clap::Args;
use serde_json::{Value, json};
use sinew_lab::report::rounded;
use sinew_lab::rope::Catalogue;
use sinew_lab::trend::year::{self, RobotYear, Summary, YearRequest};
use sinew_lab::{output, robot_dir};
use std::path::{Path, PathBuf};

/// Live through simulated years of robots: what the trend finds, how far its forecasts hold
///
/// One session a day; ropes creep by their law, drawn from its uncertainty, under work drawn anew for
/// each robot; a strand fails on a random day. A session is the truth plus errors as measured on
/// simulated recordings. Beside the trend with and without the rope, a forecaster that knows the true
/// law and only lacks its parameters says what is reachable at all.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew trend simulate-year --robot robots/biorob-like --robots 100 --out years.jsonl")]
pub(super) struct SimulateYear {
    /// Robot's folder
    #[arg(long, value_name = "DIR")]
    robot: PathBuf,
    /// Robots
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    robots: u64,
    /// Joints watched
    #[arg(
        long,
        value_name = "NAME,…",
        value_delimiter = ',',
        default_value = "shoulder_pitch,elbow"
    )]
    joints: Vec<String>,
    /// Seed of the first robot; the others follow
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Keep each robot's year in a file, one JSON document a line; goes on where an earlier run ended
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    /// No progress on stderr
    #[arg(long)]
    quiet: bool,
}

impl SimulateYear {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        let loaded = robot_dir::load(&self.robot, None)?;
        let catalogue = Catalogue::shipped()?;
        let request = YearRequest {
            robots: self.robots,
            seed: self.seed,
            joints: self.joints.clone(),
            ..YearRequest::default()
        };
        // What must be the same for years to belong together.
        let header = json!({
            "format": "sinew-years",
            "version": 1,
            "sinew_version": env!("CARGO_PKG_VERSION"),
            "robot": loaded.robot.name,
            "joints": request.joints,
            "errors": request.errors,
        });
        let mut years = match &self.out {
            Some(path) => {
                check_outputs(&[("--out", path)], &[])?;
                kept(path, &header)?
            }
            None => Vec::new(),
        };
        let asked = self.seed..self.seed + self.robots;
        let done: Vec<u64> = years.iter().map(|y: &RobotYear| y.seed).collect();
        let bar = Bar::new("years", self.quiet);
        let mut failed = None;
        let total = self.robots as f64;
        year::run(&loaded.robot, &catalogue, &request, &done, &mut |y| {
            years.push(y);
            let here = years.iter().filter(|y| asked.contains(&y.seed)).count();
            bar.set(here as f64, total);
            if let Some(path) = &self.out
                && failed.is_none()
            {
                failed = keep(path, &header, &years).err();
            }
        })?;
        drop(bar);
        if let Some(failure) = failed {
            return Err(failure);
        }
        years.retain(|y| asked.contains(&y.seed));
        let summary = year::summary(&years);
        if self.json {
            let document = json!({ "request": header, "summary": summary, "years": years });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            answer(&told(&summary))?;
        }
        Ok(Finish::Complete)
    }
}

/// Years of an earlier run.
fn kept(path: &Path, header: &Value) -> Result<Vec<RobotYear>, Failure> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let place = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|e| Failure::Refused(format!("can't read {place}: {e}")))?;
    let mut lines = text.lines();
    let first = lines
        .next()
        .and_then(|l| serde_json::from_str::<Value>(l).ok());
    if first.as_ref() != Some(header) {
        return Err(Failure::Refused(format!(
            "{place} holds no years of this robot, these joints and this program; name another --out"
        )));
    }
    lines
        .enumerate()
        .map(|(i, line)| {
            serde_json::from_str(line)
                .map_err(|e| Failure::Refused(format!("{place}, line {}: {e}", i + 2)))
        })
        .collect()
}

/// Writes all years so far, whole or not at all.
fn keep(path: &Path, header: &Value, years: &[RobotYear]) -> Result<(), Failure> {
    let mut text = header.to_string() + "\n";
    for year in years {
        text += &serde_json::to_string(year)?;
        text.push('\n');
    }
    Ok(output::write_file(path, text.as_bytes())?)
}

fn told(summaries: &[Summary]) -> String {
    let head = [
        "forecaster",
        "robots",
        "found in 2 days",
        "false alarms per year",
        "tracking RMS\nmrad",
    ];
    let rows = summaries
        .iter()
        .map(|s| {
            vec![
                s.forecaster.name().into(),
                s.robots.to_string(),
                format!("{} of {}", s.found_two_days, s.failures),
                rounded(s.false_alarms_per_robot_year, 2),
                rounded(s.tracking_rms_mrad, 2),
            ]
        })
        .collect();
    let mut out = table(&head, rows, 1);
    out.push('\n');
    let head = [
        "forecast by",
        "on day",
        "forecasts",
        "median error\n% of day",
        "% of rest",
        "inside 90 %\n%",
        "inside 95 %\n%",
    ];
    let mut rows = Vec::new();
    for s in summaries {
        for f in &s.forecasts {
            rows.push(vec![
                s.forecaster.name().into(),
                rounded(f.made_day, 3),
                f.forecasts.to_string(),
                rounded(f.error_of_day_percent, 2),
                rounded(f.error_of_rest_percent, 2),
                rounded(f.covered_90_percent, 2),
                rounded(f.covered_95_percent, 2),
            ]);
        }
    }
    out.push_str(&table(&head, rows, 1));
    out.push('\n');
    out + &paragraph(
        "Error: median of |forecast - true day| over the true day, and over what was left until it. \
         A forecast supposes no further failure and is held against the day without one.",
        0,
    )
}
