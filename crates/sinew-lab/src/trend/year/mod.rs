//! Simulated years of robots: one session a day, ropes that creep by their law, a strand that fails.
//!
//! Truth: [`truth`]. A day's session is either a draw of the estimator's measured errors
//! ([`surrogate`]) or the whole chain of simulated recording, baseline and absolute estimate
//! ([`chain`]). [`run`] gives each robot's year to the forecasters and counts what they found.

pub mod chain;
mod forecaster;
mod robot;
mod summary;
pub mod surrogate;
pub mod truth;

pub use forecaster::Forecaster;
pub use robot::{Forecast, RobotYear, TendonResult};
pub use summary::{Summary, summary};

use crate::robot_dir::RobotDirError;
use crate::rope::{Catalogue, CatalogueError};
use robot::Fleet;
use sinew_model::robot::Robot;
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
    /// The trend refused its prior.
    #[error(transparent)]
    Trend(#[from] sinew_model::trend::TrendError),
}

/// Lives through the years of `request` that aren't in `done` yet; each finished robot is handed to
/// `finished` in the order of seeds. Several at a time, the same whatever their number.
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
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    for batch in seeds.chunks(threads) {
        let years = crate::rope::parallel::in_parallel(batch, |seed| fleet.year(*seed));
        for year in years {
            finished(year?);
        }
    }
    Ok(())
}
