//! Fleets whose truth is known: records as monitors write them, side tables, and what really happens beside.

mod life;
mod plan;
mod recordings;
mod write;

pub use life::{Life, LookAhead};
pub use plan::{Batch, Plan, PlannedRobot, Site};

use crate::FleetError;
use crate::args::Simulate;
use rayon::prelude::*;
use sinew_estimate::robot_dir;
use sinew_rope::Catalogue;
use std::path::Path;
use std::process::ExitCode;

/// Robots whose records are in memory at a time, and in a file of a month.
const TOGETHER: usize = 50;

/// What was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Made {
    /// Robots.
    pub robots: usize,
    /// Tendons.
    pub tendons: usize,
    /// Records.
    pub rows: u64,
    /// Files of records.
    pub files: usize,
    /// Robots with a recording.
    pub recordings: usize,
}

/// Makes a fleet up.
///
/// # Errors
/// [`FleetError`]; what was written before is left.
pub fn simulate(asked: &Simulate) -> Result<Made, FleetError> {
    let loaded = robot_dir::load(&asked.robot, None)?;
    let catalogue = Catalogue::shipped()?;
    let plan = Plan::draw(asked, &loaded.robot, &catalogue)?;
    empty(&asked.out)?;
    write::robot_type(&asked.out, &loaded)?;
    let mut made = Made::default();
    let mut sides = write::Sides::create(&asked.out, &plan)?;
    for (number, robots) in plan.robots.chunks(TOGETHER).enumerate() {
        let lives: Vec<Vec<Life>> = (robots.par_iter())
            .map(|robot| plan.lives(robot, &catalogue))
            .collect::<Result<_, _>>()?;
        // The first robots have recordings too.
        let left = (asked.recordings as usize).saturating_sub(made.recordings);
        let recorded: Vec<(&PlannedRobot, &[Life])> = (robots.iter().zip(&lives))
            .map(|(robot, lives)| (robot, lives.as_slice()))
            .take(left)
            .collect();
        if !recorded.is_empty() {
            made.recordings += recordings::write(&asked.out, &plan, &loaded.robot, &recorded)?;
        }
        let (rows, files) = write::months(&asked.out, &plan, number, robots, &lives)?;
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

/// Makes the folder, or sees that nothing is in it.
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
pub fn command(asked: &Simulate) -> Result<ExitCode, FleetError> {
    let made = simulate(asked)?;
    let recordings = match made.recordings {
        0 => String::new(),
        count => format!(", {count} recordings"),
    };
    println!(
        "{}: {} robots, {} tendons, {} records in {} files{recordings}; truth in {}",
        asked.out.display(),
        made.robots,
        made.tendons,
        made.rows,
        made.files,
        asked.out.join("truth").display(),
    );
    Ok(ExitCode::SUCCESS)
}
