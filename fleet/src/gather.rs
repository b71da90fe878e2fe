//! Table with one row per tendon of a fleet: its creep, and its robot, joint, rope, batch and site.
//!
//! Robots are processed in batches, so that the memory use is one row per tendon.

use crate::FleetError;
use crate::creep::{Ages, Creep, creep};
use crate::engine::Engine;
use crate::folder::sides::Fitted;
use crate::metadata::{FleetMetadata, tendon_of};
use crate::sessions::Sessions;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Number of robots in memory at a time.
const ROBOTS_IN_MEMORY: usize = 50;
/// Standard deviation of the drift of a joint without a description, as in `sinew trend`, rad/K.
const UNKNOWN_DRIFT_RAD_PER_K: f64 = 0.3e-3;

/// Tendon with the creep rate of its rope.
#[derive(Debug, Clone, PartialEq)]
pub struct CreepingTendon {
    /// Name of the robot.
    pub robot: String,
    /// Name of the joint.
    pub joint: String,
    /// Type of the robot.
    pub robot_type: String,
    /// Rope and batch, if specified.
    pub fit: Fitted,
    /// Site of the robot, if specified.
    pub site: Option<String>,
    /// Creep rate of the rope.
    pub creep: Creep,
    /// Strain of the rope per offset of the joint, 1/rad; `None` without a description of the robot type.
    pub strain_per_rad: Option<f64>,
}

/// Tendons of a fleet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FleetTable {
    /// Tendons with an estimated creep rate, by robot and joint.
    pub tendons: Vec<CreepingTendon>,
    /// Number of tendons with too few sessions.
    pub too_few: usize,
    /// Robot types without a description.
    pub unknown_types: BTreeSet<String>,
}

/// Estimates the creep rate of every tendon of a fleet.
///
/// # Errors
/// Returns [`FleetError`] if the records or the metadata cannot be read.
pub fn gather(
    engine: &mut Engine,
    described: &[PathBuf],
    ages: Ages,
) -> Result<FleetTable, FleetError> {
    let metadata = FleetMetadata::read(&engine.folder.path, described)?;
    let robots = engine.folder.robots().into_iter();
    let names: Vec<String> = robots.map(str::to_owned).collect();
    let mut out = FleetTable::default();
    for robots in names.chunks(ROBOTS_IN_MEMORY) {
        let tendons = engine.sessions(robots)?;
        let estimates: Vec<Option<CreepingTendon>> = tendons
            .par_iter()
            .map(|t| estimate(&metadata, t, ages))
            .collect();
        for (sessions, found) in tendons.iter().zip(estimates) {
            if metadata.robot_type(&sessions.robot_type).is_none() {
                out.unknown_types.insert(sessions.robot_type.clone());
            }
            match found {
                Some(found) => out.tendons.push(found),
                None => out.too_few += 1,
            }
        }
    }
    Ok(out)
}

fn estimate(metadata: &FleetMetadata, sessions: &Sessions, ages: Ages) -> Option<CreepingTendon> {
    let last_utc_s = sessions.rows.last()?.time_utc_s;
    let events = metadata.events.get(&sessions.tendon);
    let replaced = events.into_iter().flatten();
    let replaced = replaced.filter(|e| e.replaced && e.time_utc_s <= last_utc_s);
    let fitted_utc_s = replaced.map(|e| e.time_utc_s).reduce(f64::max);
    let robot = metadata.robot_type(&sessions.robot_type);
    let drift = robot.map_or(UNKNOWN_DRIFT_RAD_PER_K, |r| r.tolerances.drift_rad_per_k());
    let creep = creep(&sessions.rows, fitted_utc_s, ages, drift)?;
    let (name, joint) = sessions.tendon.clone();
    let mut fit = metadata.fit(&sessions.tendon);
    let tendon = robot.and_then(|r| tendon_of(r, &joint));
    fit.rope = fit.rope.or(tendon.and_then(|t| t.rope.clone()));
    Some(CreepingTendon {
        robot_type: sessions.robot_type.clone(),
        site: metadata.sites.get(&name).cloned(),
        robot: name,
        joint,
        fit,
        creep,
        strain_per_rad: tendon.map(|t| t.joint_pulley_radius_m / t.length_m),
    })
}
