//! Simulated years of robots: one session a day, ropes that creep by their law, a strand that fails.
//!
//! Truth: [`truth`]. A day's session is either a draw of the estimator's measured errors
//! ([`surrogate`]) or the whole chain of simulated recording, baseline and absolute estimate
//! ([`chain`]). [`run`] gives each robot's year to the forecasters and counts what they found.

pub mod chain;
mod forecaster;
mod life;
mod robot;
mod summary;
pub mod surrogate;
pub mod truth;

pub use forecaster::Forecaster;
pub use robot::{Forecast, RobotYear, TendonResult};
pub use summary::{Summary, summary};

use crate::jobs;
use chain::{ChainError, ChainRequest, Session};
use life::WATCHED;
use rayon::prelude::*;
use robot::Fleet;
use sinew_estimate::robot_dir::RobotDirError;
use sinew_model::robot::Robot;
use sinew_rope::{Catalogue, CatalogueError};
use surrogate::SessionErrors;

/// What years are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct YearRequest {
    /// Robots.
    pub robots: u64,
    /// Seed of the first; the others follow.
    pub seed: u64,
    /// Joints watched; the strand fails in one of them.
    pub joints: Vec<String>,
    /// Errors of a session.
    pub errors: SessionErrors,
    /// Forecasters.
    pub forecasters: Vec<Forecaster>,
    /// Curves of the one that knows the law.
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

/// Why there are no years.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum YearError {
    /// The robot.
    #[error(transparent)]
    Robot(#[from] RobotDirError),
    /// A rope.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// A joint without a rope.
    #[error(
        "joint '{0}' has no tendon with a rope and a pretension in robot.toml; a year needs them"
    )]
    Joint(String),
    /// A simulated session.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// There are no threads to work on.
    #[error("can't start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The trend refused its prior.
    #[error(transparent)]
    Trend(#[from] sinew_model::trend::TrendError),
}

/// Lives through the years of `request` that aren't in `done` yet; each finished robot is handed to
/// `finished` in the order of seeds. Up to `jobs` at a time, the same whatever their number.
///
/// # Errors
/// [`YearError`]; robots handed over before stay.
pub fn run(
    robot: &Robot,
    catalogue: &Catalogue,
    request: &YearRequest,
    done: &[u64],
    finished: &mut dyn FnMut(RobotYear),
) -> Result<(), YearError> {
    let fleet = Fleet::new(robot, catalogue, request)?;
    let seeds: Vec<u64> = (request.seed..request.seed + request.robots)
        .filter(|s| !done.contains(s))
        .collect();
    let pool = jobs::pool(request.jobs)?;
    for batch in seeds.chunks(request.jobs.max(1)) {
        for year in pool.install(|| in_order(batch, |seed| fleet.year(*seed))) {
            finished(year?);
        }
    }
    Ok(())
}

/// Years through the whole chain: simulates every robot's sessions of the first `days` (a year at most) and
/// gives them to the forecasters. `progress` is told how many of how many sessions are done, `finished` is
/// handed each robot's sessions and what became of them.
///
/// # Errors
/// [`YearError`]; sessions finished before are in the file of `chain`.
pub fn run_chain(
    robot: &Robot,
    catalogue: &Catalogue,
    request: &YearRequest,
    chain: &ChainRequest,
    days: usize,
    progress: &mut (dyn FnMut(usize, usize) + Send),
    finished: &mut dyn FnMut(Vec<Session>, RobotYear),
) -> Result<(), YearError> {
    let fleet = Fleet::new(robot, catalogue, request)?;
    let seeds: Vec<u64> = (request.seed..request.seed + request.robots).collect();
    let mut lives = Vec::with_capacity(seeds.len());
    for life in in_order(&seeds, |seed| fleet.life(*seed)) {
        lives.push(life?);
    }
    let days = days.clamp(1, WATCHED);
    let sessions = chain::sessions(robot, &request.joints, &lives, days, chain, progress)?;
    let both: Vec<_> = lives.iter().zip(&sessions).collect();
    let years = in_order(&both, |(life, own)| fleet.chained(life, own));
    for (own, year) in sessions.into_iter().zip(years) {
        finished(own, year?);
    }
    Ok(())
}

/// The same work on every item, on all threads, in the order of the items.
fn in_order<I: Sync, R: Send>(items: &[I], work: impl Fn(&I) -> R + Sync + Send) -> Vec<R> {
    items.par_iter().map(work).collect()
}
