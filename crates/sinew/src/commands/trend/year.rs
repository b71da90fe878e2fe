//! `sinew trend simulate-year`: how good the trend is on years whose truth is known.

use super::year_told::{errors_told, told};
use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use sinew_estimate::robot_dir;
use sinew_eval::year::chain::{ChainRequest, SessionKind, statistics};
use sinew_eval::year::surrogate::SessionErrors;
use sinew_eval::year::{self, RobotYear, YearRequest};
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use std::path::{Path, PathBuf};

/// Sessions of a whole year.
const YEAR_DAYS: u64 = 365;

/// Live through simulated years of robots: what the trend finds, how far its forecasts hold
///
/// One session a day; ropes creep by their law, drawn from its uncertainty, under work drawn anew for
/// each robot; a strand fails on a random day. A session is the truth plus errors as measured on
/// simulated recordings. Beside the trend with and without the rope, a forecaster that knows the true
/// law and only lacks its parameters says what is reachable at all.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew trend simulate-year --robot robots/biorob-like --robots 100 --out years.jsonl\n  \
    sinew trend simulate-year --robot robots/biorob-like --robots 6 --chain --days 20\n\n\
    A run that was stopped goes on where it was with the same --out.")]
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
    /// Simulate every session and estimate its offsets, instead of drawing what that gives
    #[arg(long)]
    chain: bool,
    /// What the robot does while it is recorded
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Kind::Check)]
    session: Kind,
    /// Each session starts from what the last one learned, not from the first day's baseline
    #[arg(long, requires = "chain")]
    chained: bool,
    /// Sessions of each robot, one a day
    #[arg(long, value_name = "N", default_value_t = 365, requires = "chain", value_parser = clap::value_parser!(u64).range(1..=365))]
    days: u64,
    /// Threads [default: as many as the machine has]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// Keep years (with --chain: sessions) in a file, one JSON document a line
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    /// No progress on stderr
    #[arg(long)]
    quiet: bool,
}

/// What a session is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// The same 24 poses every day, empty gripper, no contact
    Check,
    /// A minute of work: random poses, unknown payload, contacts
    Work,
    /// Errors larger than measured on either; not with --chain
    Hard,
}

impl Kind {
    fn errors(self) -> SessionErrors {
        match self {
            Self::Check => SessionErrors::check(),
            Self::Work => SessionErrors::work(),
            Self::Hard => SessionErrors::hard(),
        }
    }
}

impl SimulateYear {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        if let Some(path) = &self.out {
            check_outputs(&[("--out", path)], &[])?;
        }
        let loaded = robot_dir::load(&self.robot, None)?;
        let catalogue = Catalogue::shipped()?;
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
        let request = YearRequest {
            robots: self.robots,
            seed: self.seed,
            joints: self.joints.clone(),
            errors: self.session.errors(),
            jobs: self.jobs.unwrap_or(cores) as usize,
            ..YearRequest::default()
        };
        if self.chain {
            self.chain(&loaded.robot, &catalogue, request)
        } else {
            self.drawn(&loaded.robot, &catalogue, &request)
        }
    }

    /// Years whose sessions are drawn.
    fn drawn(
        &self,
        robot: &Robot,
        catalogue: &Catalogue,
        request: &YearRequest,
    ) -> Result<Finish, Failure> {
        // What must be the same for years to belong together.
        let header = json!({
            "format": "sinew-years",
            "version": 2,
            "sinew_version": env!("CARGO_PKG_VERSION"),
            "robot": robot.name,
            "joints": request.joints,
            "errors": request.errors,
        });
        let mut years = match &self.out {
            Some(path) => kept(path, &header)?,
            None => Vec::new(),
        };
        let asked = self.seed..self.seed + self.robots;
        let done: Vec<u64> = years.iter().map(|y: &RobotYear| y.seed).collect();
        let bar = Bar::new("years", self.quiet);
        let mut failed = None;
        let total = self.robots as f64;
        year::run(robot, catalogue, request, &done, &mut |y| {
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

    /// Years whose sessions are simulated and estimated.
    fn chain(
        &self,
        robot: &Robot,
        catalogue: &Catalogue,
        mut request: YearRequest,
    ) -> Result<Finish, Failure> {
        let kind = match self.session {
            Kind::Check => SessionKind::Check,
            Kind::Work => SessionKind::Work,
            Kind::Hard => {
                return Err(Failure::Refused(
                    "--session hard draws errors that no simulated session has; leave --chain away"
                        .into(),
                ));
            }
        };
        let whole = self.days >= YEAR_DAYS;
        if !whole {
            // Part of a year shows the sessions' errors; a trend of it would be judged unfairly.
            request.forecasters.clear();
        }
        let chain = ChainRequest {
            kind,
            chained: self.chained,
            jobs: request.jobs,
            out: self.out.clone(),
        };
        let bar = Bar::new("sessions", self.quiet);
        let (mut years, mut sessions) = (Vec::new(), Vec::new());
        year::run_chain(
            robot,
            catalogue,
            &request,
            &chain,
            self.days as usize,
            &mut |done, all| bar.set(done as f64, all as f64),
            &mut |own, year| {
                sessions.push(own);
                years.push(year);
            },
        )?;
        drop(bar);
        let (errors, failures) = statistics(&sessions);
        let summary = year::summary(&years);
        if self.json {
            let document = json!({
                "robot": robot.name,
                "session": kind,
                "chained": self.chained,
                "errors": errors,
                "failures": failures,
                "summary": summary,
                "years": if whole { years } else { Vec::new() },
            });
            answer(&(serde_json::to_string_pretty(&document)? + "\n"))?;
        } else {
            let mut text = errors_told(&errors, &failures);
            if whole {
                text.push('\n');
                text.push_str(&told(&summary));
            }
            answer(&text)?;
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
            "{place} holds no years of this robot, these joints, --session and program; name another --out"
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
    Ok(sinew_files::write_file(path, text.as_bytes())?)
}
