//! Recordings of some robots of a fleet: a minute right after they were tensioned, and a minute as they are on the last day.

use super::life::TendonHistory;
use super::plan::{Plan, PlannedRobot};
use crate::FleetError;
use rayon::prelude::*;
use sinew_files::date::DAY_S;
use sinew_model::robot::Robot;
use sinew_sim::protocol::plan_adapted;
use sinew_sim::scenario::{Draw, Shape};
use sinew_sim::{Scenario, SimulateOptions};
use std::path::Path;

/// Folder of the recordings.
const FOLDER: &str = "recordings";
/// Scenario of motion and random errors: that of the protocol with an empty gripper.
const SCENARIO: &str = "S5";
/// When the day begins, s after midnight.
const MORNING_S: f64 = 21_600.0;

/// Writes them; how many.
pub(super) fn write(
    out: &Path,
    plan: &Plan,
    robot: &Robot,
    robots: &[(&PlannedRobot, &[TendonHistory])],
) -> Result<usize, FleetError> {
    let folder = out.join(FOLDER);
    std::fs::create_dir_all(&folder).map_err(|source| FleetError::Folder {
        path: folder.clone(),
        source,
    })?;
    let protocol = plan_adapted(SCENARIO, robot)?.scenario;
    robots.par_iter().try_for_each(|(planned, lives)| {
        let scenario = of_robot(protocol.clone(), plan, planned, lives);
        let file = folder.join(format!("{}.mcap", planned.name));
        let options = SimulateOptions::new(file);
        sinew_sim::run(robot, &scenario, &options, &mut |_| {})?;
        Ok::<_, FleetError>(())
    })?;
    Ok(robots.len())
}

/// The protocol's sessions A and B; in B each tendon is longer by its creep since tensioning.
fn of_robot(
    mut scenario: Scenario,
    plan: &Plan,
    planned: &PlannedRobot,
    lives: &[TendonHistory],
) -> Scenario {
    let tensioned_s = scenario.sessions[0].to_s;
    scenario.duration_s = Some(scenario.sessions[1].to_s);
    scenario.seed = planned.seed;
    let day = plan.days as f64;
    let start_utc_s = plan.start_utc_s + day * DAY_S + MORNING_S;
    scenario.start_time_ns = (start_utc_s * 1e9) as i64;
    let is_first = |shape: &Shape| matches!(shape, Shape::Step { at_s } if *at_s == tensioned_s);
    scenario.offsets.retain(|offset| is_first(&offset.shape));
    for offset in &mut scenario.offsets {
        let life = (lives.iter()).find(|life| plan.tendons[life.tendon].joint == offset.joint);
        offset.size_rad = Draw::Fixed(life.map_or(0.0, |life| life.offset_rad));
    }
    scenario
}
