//! `sinew watch --check`: everything a configuration names is read, and nothing is started.

use crate::config::{Config, RobotSettings};
use sinew_estimate::baseline::Baseline;
use sinew_estimate::robot_dir;
use sinew_log::Mapping;

/// What is wrong with the files that a configuration names, in sentences.
pub fn faults(config: &Config) -> Vec<String> {
    config.robots.iter().flat_map(robot_faults).collect()
}

fn robot_faults(robot: &RobotSettings) -> Vec<String> {
    let name = &robot.name;
    let mut faults = Vec::new();
    // Without a URDF the robot's own description is waited for.
    let loaded = robot_dir::load(&robot.dir, None);
    match loaded {
        Ok(_) | Err(robot_dir::RobotDirError::NoUrdf { .. }) => {}
        Err(error) => faults.push(format!("{name}: {error}")),
    }
    if let Some(Err(error)) = robot.reading.mapping.as_deref().map(Mapping::read) {
        faults.push(format!("{name}: {error}"));
    }
    if let Some(Err(error)) = robot.baseline.as_deref().map(Baseline::read) {
        faults.push(format!("{name}: {error}"));
    }
    faults
}
