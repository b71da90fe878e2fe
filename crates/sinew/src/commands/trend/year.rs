//! `sinew trend simulate-year`: how good the trend is on years whose truth is known.

use crate::files::check_outputs;
use crate::terminal::{Bar, Failure, Finish, answer_as};
use clap::{Args, ValueEnum};
use sinew_estimate::robot_dir;
use sinew_eval::year;
use sinew_eval::year::YearRequest;
use sinew_eval::year::chain::{ChainRequest, SessionKind};
use sinew_eval::year::surrogate::SessionErrors;
use sinew_rope::Catalogue;
use std::path::PathBuf;

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

    fn simulated(self) -> Result<SessionKind, Failure> {
        match self {
            Self::Check => Ok(SessionKind::Check),
            Self::Work => Ok(SessionKind::Work),
            Self::Hard => Err(Failure::Refused(
                "--session hard draws errors that no simulated session has; leave --chain away"
                    .into(),
            )),
        }
    }
}

impl SimulateYear {
    pub(super) fn run(&self) -> Result<Finish, Failure> {
        // What was run before is taken up again, not replaced.
        check_outputs(&[("--out", self.out.as_deref())], &[], true)?;
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
        let robot = &loaded.robot;
        let report = if self.chain {
            let chain = ChainRequest {
                kind: self.session.simulated()?,
                days: self.days as usize,
                chained: self.chained,
                jobs: request.jobs,
                out: self.out.clone(),
            };
            let bar = Bar::new("sessions", self.quiet);
            let mut progress = |done, all| bar.set(done as f64, all as f64);
            let lived = year::run_chain(robot, &catalogue, &request, &chain, &mut progress)?;
            year::report_chain(robot, &request, &chain, lived)
        } else {
            let bar = Bar::new("years", self.quiet);
            let mut progress = |done, all| bar.set(done as f64, all as f64);
            let out = self.out.as_deref();
            year::run(robot, &catalogue, &request, out, &mut progress)?
        };
        answer_as(self.json, &report, year::render_table)?;
        Ok(Finish::Complete)
    }
}
