//! Simulated fleets with known ground truth: records as monitors write them, side tables and the true values.

mod life;
mod plan;
mod recordings;
mod write;

pub use life::{LookAhead, TendonHistory};
pub use plan::{Batch, Plan, PlannedRobot, Site};

use crate::FleetError;
use crate::args::Simulate;
use rayon::prelude::*;
use sinew_estimate::robot_dir;
use sinew_rope::Catalogue;
use std::path::Path;
use std::process::ExitCode;

/// Number of robots whose records are in memory at a time, and in one file of a month.
const ROBOTS_PER_FILE: usize = 50;

/// Size of the simulated fleet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Made {
    /// Number of robots.
    pub robots: usize,
    /// Number of tendons.
    pub tendons: usize,
    /// Number of records.
    pub rows: u64,
    /// Files of records.
    pub files: usize,
    /// Robots with a recording.
    pub recordings: usize,
}

/// Simulates a fleet.
///
/// # Errors
/// Returns a [`FleetError`]; files written before the error remain.
pub fn simulate(request: &Simulate) -> Result<Made, FleetError> {
    let loaded = robot_dir::load(&request.robot, None)?;
    let catalogue = Catalogue::shipped()?;
    let plan = Plan::draw(request, &loaded.robot, &catalogue)?;
    empty(&request.out)?;
    write::robot_type(&request.out, &loaded)?;
    let mut made = Made::default();
    let mut sides = write::Sides::create(&request.out, &plan)?;
    for (number, robots) in plan.robots.chunks(ROBOTS_PER_FILE).enumerate() {
        let lives: Vec<Vec<TendonHistory>> = (robots.par_iter())
            .map(|robot| plan.lives(robot, &catalogue))
            .collect::<Result<_, _>>()?;
        // The first robots have recordings too.
        let left = (request.recordings as usize).saturating_sub(made.recordings);
        let recorded: Vec<(&PlannedRobot, &[TendonHistory])> = (robots.iter().zip(&lives))
            .map(|(robot, lives)| (robot, lives.as_slice()))
            .take(left)
            .collect();
        if !recorded.is_empty() {
            made.recordings += recordings::write(&request.out, &plan, &loaded.robot, &recorded)?;
        }
        let (rows, files) = write::months(&request.out, &plan, number, robots, &lives)?;
        for (robot, lives) in robots.iter().zip(&lives) {
            sides.robot(&plan, robot, lives)?;
            made.tendons += lives.len();
        }
        made.robots += robots.len();
        made.rows += rows;
        made.files += files;
    }
    sides.finish()?;
    Ok(made)
}

/// Creates the folder, or checks that it is empty.
fn empty(folder: &Path) -> Result<(), FleetError> {
    let wrong = |source| FleetError::Folder {
        path: folder.into(),
        source,
    };
    std::fs::create_dir_all(folder).map_err(wrong)?;
    match std::fs::read_dir(folder).map_err(wrong)?.next() {
        None => Ok(()),
        Some(_) => Err(FleetError::NotEmpty(folder.into())),
    }
}

/// The command.
///
/// # Errors
/// [`FleetError`].
pub fn command(request: &Simulate) -> Result<ExitCode, FleetError> {
    let made = simulate(request)?;
    let recordings = match made.recordings {
        0 => String::new(),
        count => format!(", {count} recordings"),
    };
    println!(
        "{}: {} robots, {} tendons, {} records in {} files{recordings}; truth in {}",
        request.out.display(),
        made.robots,
        made.tendons,
        made.rows,
        made.files,
        request.out.join("truth").display(),
    );
    Ok(ExitCode::SUCCESS)
}
