//! Simulated years of robots: one session a day, ropes that creep by their law, a strand that fails.
//!
//! Truth: [`sinew_sim::year::truth`]. A day's session is either a draw of the estimator's measured errors
//! ([`sinew_sim::year::surrogate`]) or the whole chain of simulated recording, baseline and absolute estimate
//! ([`chain`]). [`run`] passes the year of each robot to the forecasters and assesses their results.

mod assessment;
pub mod chain;
mod extrapolation;
mod forecaster;
mod result;
mod simulated_year;
mod summary;
mod table;

pub use extrapolation::{Extrapolation, ExtrapolationDay, RopePrior, extrapolate};
pub use result::{
    DayForecast, DayInterval, DaysInside, ForecastSummary, Forecaster, RobotYear, SessionSource,
    TendonResult, YearReport, YearSummary,
};
pub use summary::summary;
pub use table::render_table;

use crate::jobs;
use crate::journal::{self, Journal, JournalError};
use assessment::Fleet;
use chain::{ChainError, ChainRequest, Session};
use rayon::prelude::*;
use simulated_year::DAYS_PER_YEAR;
use sinew_estimate::robot_dir::RobotDirError;
use sinew_model::robot::Robot;
use sinew_rope::{Catalogue, CatalogueError};
use sinew_sim::year::surrogate::SessionErrors;
use std::collections::BTreeMap;
use std::path::Path;

/// Format of the file of results; the version changes with numbers or names, because older files cannot be resumed.
const YEARS: journal::Kind = journal::Kind {
    format: "sinew-years",
    version: 4,
    holds: "simulated years",
};

/// Request for simulated years.
#[derive(Debug, Clone, PartialEq)]
pub struct YearRequest {
    /// Number of robots.
    pub robots: u64,
    /// Seed of the first; the others follow.
    pub seed: u64,
    /// Monitored joints; the strand fails in one of them.
    pub joints: Vec<String>,
    /// Errors of a session.
    pub errors: SessionErrors,
    /// Forecasters to run.
    pub forecasters: Vec<Forecaster>,
    /// Number of curves of the forecaster with the true creep law.
    pub oracle_curves: usize,
    /// Robots at a time.
    pub jobs: usize,
}

impl Default for YearRequest {
    fn default() -> Self {
        Self {
            robots: 100,
            seed: 1,
            joints: vec!["shoulder_pitch".into(), "elbow".into()],
            errors: SessionErrors::default(),
            forecasters: Forecaster::ALL.to_vec(),
            oracle_curves: 200,
            jobs: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

impl YearRequest {
    fn seeds(&self) -> std::ops::Range<u64> {
        self.seed..self.seed + self.robots
    }
}

/// Errors of simulated years.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum YearError {
    /// The robot could not be read.
    #[error(transparent)]
    Robot(#[from] RobotDirError),
    /// A rope could not be read.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// A joint has no rope.
    #[error("joint '{0}' has no tendon with a rope and a pretension; add both in robot.toml")]
    Joint(String),
    /// The file of years.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A simulated session failed.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// The threads could not be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The prior of the trend is invalid.
    #[error(transparent)]
    Trend(#[from] sinew_trend::filter::TrendError),
}

/// Simulates the years of `request` with drawn sessions, up to `jobs` at a time; the result does not depend on this
/// number. With `out`, a line per year is written to that file when it is finished, and years in the file are not
/// simulated again. Calls `progress` with the number done and the total.
///
/// # Errors
/// Returns a [`YearError`]; years finished before are in `out`.
pub fn run(
    robot: &Robot,
    catalogue: &Catalogue,
    request: &YearRequest,
    out: Option<&Path>,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<YearReport, YearError> {
    let settings = [
        ("robot", robot.name.clone(), "robot '{}'"),
        ("joints", request.joints.join(", "), "joints {} (--joints)"),
        (
            "errors",
            format!("{:?}", request.errors),
            "errors of other sessions (--session)",
        ),
        (
            "forecasters",
            format!("{:?}", request.forecasters),
            "forecasters {} (--forecasters)",
        ),
    ];
    let (mut journal, kept) = Journal::open::<RobotYear>(out, &YEARS, &settings)?;
    let mut done: BTreeMap<u64, RobotYear> = (kept.into_iter())
        .filter(|y| request.seeds().contains(&y.seed))
        .map(|y| (y.seed, y))
        .collect();
    let fleet = Fleet::new(robot, catalogue, request)?;
    let seeds: Vec<u64> = request.seeds().filter(|s| !done.contains_key(s)).collect();
    jobs::each(
        &seeds,
        request.jobs,
        |seed, give| {
            give(fleet.year(*seed)?);
            Ok::<_, YearError>(())
        },
        |year| {
            journal.add(&year)?;
            done.insert(year.seed, year);
            progress(done.len(), request.robots as usize);
            Ok(())
        },
    )?;
    let years = done.into_values().collect();
    let errors = request.errors;
    let source = SessionSource::Drawn { errors };
    Ok(report(robot, request, source, years))
}

/// Simulates years through the whole chain: every robot's sessions are simulated and passed to the forecasters.
/// Returns each robot's sessions and the assessed years. Calls `progress` with the number of sessions done and the
/// total.
///
/// # Errors
/// Returns a [`YearError`]; sessions finished before are in the file of `chain`.
pub fn run_chain(
    robot: &Robot,
    catalogue: &Catalogue,
    request: &YearRequest,
    chain: &ChainRequest,
    progress: &mut (dyn FnMut(usize, usize) + Send),
) -> Result<Vec<(Vec<Session>, RobotYear)>, YearError> {
    let mut request = request.clone();
    if chain.days < DAYS_PER_YEAR {
        request.forecasters.clear();
    }
    let fleet = Fleet::new(robot, catalogue, &request)?;
    let seeds: Vec<u64> = request.seeds().collect();
    let mut lives = Vec::with_capacity(seeds.len());
    for life in in_order(&seeds, |seed| fleet.life(*seed)) {
        lives.push(life?);
    }
    let sessions = chain::sessions(robot, &request.joints, &lives, chain, progress)?;
    let both: Vec<_> = lives.iter().zip(&sessions).collect();
    let years = in_order(&both, |(life, own)| fleet.chained(life, own));
    (sessions.into_iter().zip(years))
        .map(|(own, year)| Ok((own, year?)))
        .collect()
}

/// Returns the report of sessions and years of [`run_chain`].
pub fn report_chain(
    robot: &Robot,
    request: &YearRequest,
    chain: &ChainRequest,
    lived: Vec<(Vec<Session>, RobotYear)>,
) -> YearReport {
    let (sessions, mut years): (Vec<_>, Vec<_>) = lived.into_iter().unzip();
    let (errors, failures) = chain::statistics(&sessions);
    if chain.days < DAYS_PER_YEAR {
        years.clear();
    }
    let source = SessionSource::Simulated {
        session: chain.kind,
        chained: chain.chained,
        errors,
        failures,
    };
    report(robot, request, source, years)
}

fn report(
    robot: &Robot,
    request: &YearRequest,
    sessions: SessionSource,
    years: Vec<RobotYear>,
) -> YearReport {
    YearReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        robot: robot.name.clone(),
        joints: request.joints.clone(),
        sessions,
        summary: summary(&years),
        years,
    }
}

/// Processes every item on all threads; results are in the order of the items.
fn in_order<I: Sync, R: Send>(items: &[I], work: impl Fn(&I) -> R + Sync + Send) -> Vec<R> {
    items.par_iter().map(work).collect()
}
