//! `sinew trend simulate`: accuracy of the trend on years with known truth.

use clap::{Args, ValueEnum};
use sinew::args::not_negative;
use sinew::files::check_outputs;
use sinew::terminal::{Bar, Failure, Finish, answer_as};
use sinew_bench::year;
use sinew_bench::year::chain::{ChainRequest, SessionKind};
use sinew_bench::year::{Forecaster, YearRequest};
use sinew_estimate::robot_dir;
use sinew_rope::Catalogue;
use sinew_sim::year::surrogate::SessionErrors;
use std::path::PathBuf;

/// Simulate years of robots: events found by the trend, coverage of its forecasts
///
/// One session a day; ropes creep by their creep law, drawn from its uncertainty, under work drawn separately for
/// each robot; a strand fails on a random day. A session is the truth plus errors as measured on simulated
/// recordings. In addition to the trend with and without the rope, a forecaster with the true creep law and unknown
/// parameters gives the attainable accuracy.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    sinew trend simulate --robot robots/biorob-like --robots 100 --out years.jsonl\n  \
    sinew trend simulate --robot robots/biorob-like --robots 60 --constant-mrad 0.44 --stated-shared-mrad 0.44\n  \
    sinew trend simulate --robot robots/biorob-like --robots 6 --chain --days 20\n\n\
    A stopped run resumes with the same --out.")]
pub(crate) struct TrendSimulate {
    /// Folder of the robot
    #[arg(long, value_name = "DIR")]
    robot: PathBuf,
    /// Number of robots
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    robots: u64,
    /// Joints with a trend
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
    /// Simulate every session and estimate its offsets, instead of drawing the errors
    #[arg(long)]
    chain: bool,
    /// Motion of the robot while it is recorded
    #[arg(long, value_name = "KIND", value_enum, default_value_t = Kind::Check)]
    session: Kind,
    #[command(flatten)]
    errors: Errors,
    /// Start each session from the posterior of the previous one, not from the first day's baseline
    #[arg(long, requires = "chain")]
    chained: bool,
    /// Number of sessions of each robot, one a day
    #[arg(long, value_name = "N", default_value_t = 365, requires = "chain", value_parser = clap::value_parser!(u64).range(1..=365))]
    days: u64,
    /// Number of threads [default: number of CPU cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// Forecasters to run [default: all]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_enum)]
    forecasters: Vec<Forecaster>,
    /// File with a JSON document per year (with --chain: per session)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

/// Errors of sessions that are drawn.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Errors of drawn sessions")]
struct Errors {
    /// Standard deviation of an error that is constant over the year [default: the kind's]
    #[arg(long, value_name = "MRAD", conflicts_with = "chain", value_parser = not_negative("mrad"))]
    constant_mrad: Option<f64>,
    /// Standard deviation, after a year, of a random-walk error
    #[arg(long, value_name = "MRAD", conflicts_with = "chain", value_parser = not_negative("mrad"))]
    wander_mrad: Option<f64>,
    /// Standard deviation of a seasonal error that is independent of the measured temperature
    #[arg(long, value_name = "MRAD", conflicts_with = "chain", value_parser = not_negative("mrad"))]
    season_mrad: Option<f64>,
    /// Standard deviation of the drift with temperature, per kelvin [default: the kind's]
    #[arg(long, value_name = "MRAD", conflicts_with = "chain", value_parser = not_negative("mrad"))]
    drift_mrad_per_k: Option<f64>,
    /// Standard deviation that sessions report for their systematic error [default: the kind's]
    #[arg(long, value_name = "MRAD", conflicts_with = "chain", value_parser = not_negative("mrad"))]
    stated_shared_mrad: Option<f64>,
    /// Sessions report their total error only, not the systematic part
    #[arg(long, conflicts_with = "chain")]
    whole_only: bool,
}

impl Errors {
    fn of(self, kind: SessionErrors) -> SessionErrors {
        let or = |stated: Option<f64>, kind: f64| stated.map_or(kind, |mrad| 1e-3 * mrad);
        SessionErrors {
            bias_rad: or(self.constant_mrad, kind.bias_rad),
            wander_rad: or(self.wander_mrad, kind.wander_rad),
            season_rad: or(self.season_mrad, kind.season_rad),
            drift_rad_per_k: or(self.drift_mrad_per_k, kind.drift_rad_per_k),
            reported_systematic_rad: or(self.stated_shared_mrad, kind.reported_systematic_rad),
            parts_specified: kind.parts_specified && !self.whole_only,
            ..kind
        }
    }
}

/// Kind of a simulated session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// The same 24 poses every day, empty gripper, no contact
    Check,
    /// A minute of work: random poses, unknown payload, contacts
    Work,
    /// Errors larger than those measured on either; not with --chain
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
            Self::Hard => Err(Failure::Error(
                "--session hard draws errors larger than those of simulated sessions; remove --chain"
                    .into(),
            )),
        }
    }
}

impl TrendSimulate {
    pub(crate) fn run(&self) -> Result<Finish, Failure> {
        // Earlier results are resumed, not replaced.
        check_outputs(&[("--out", self.out.as_deref())], &[])?;
        let loaded = robot_dir::load(&self.robot, None)?;
        let catalogue = Catalogue::shipped()?;
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
        let mut request = YearRequest {
            robots: self.robots,
            seed: self.seed,
            joints: self.joints.clone(),
            errors: self.errors.of(self.session.errors()),
            jobs: self.jobs.unwrap_or(cores) as usize,
            ..YearRequest::default()
        };
        if !self.forecasters.is_empty() {
            request.forecasters.clone_from(&self.forecasters);
        }
        let robot = &loaded.robot;
        let report = if self.chain {
            let chain = ChainRequest {
                kind: self.session.simulated()?,
                days: self.days as usize,
                chained: self.chained,
                jobs: request.jobs,
                out: self.out.clone(),
            };
            let bar = Bar::new("sessions");
            let mut progress = |done, all| bar.set(done as f64, all as f64);
            let lived = year::run_chain(robot, &catalogue, &request, &chain, &mut progress)?;
            year::report_chain(robot, &request, &chain, lived)
        } else {
            let bar = Bar::new("years");
            let mut progress = |done, all| bar.set(done as f64, all as f64);
            let out = self.out.as_deref();
            year::run(robot, &catalogue, &request, out, &mut progress)?
        };
        answer_as(self.json, &report, year::render_table)?;
        Ok(Finish::Complete)
    }
}
