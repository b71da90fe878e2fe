//! Every tendon of a fleet as one row: how fast its rope creeps, and what it belongs to.
//!
//! Robots are taken some at a time: what stays in memory is a row per tendon.

use crate::FleetError;
use crate::beside::{Beside, tendon_of};
use crate::creep::{Ages, Creep, creep};
use crate::engine::Engine;
use crate::folder::sides::Fitted;
use crate::sessions::Sessions;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Robots that are in memory at a time.
const TOGETHER: usize = 50;
/// Drift of a joint whose robot nobody described, as in `sinew trend`, rad/K.
const UNKNOWN_DRIFT_RAD_PER_K: f64 = 0.3e-3;

/// A tendon and how fast its rope creeps.
#[derive(Debug, Clone, PartialEq)]
pub struct CreepingTendon {
    /// Robot.
    pub robot: String,
    /// Joint.
    pub joint: String,
    /// Type of the robot.
    pub robot_type: String,
    /// Rope and batch, as far as they are known.
    pub fit: Fitted,
    /// Site, if it is known.
    pub site: Option<String>,
    /// How fast its rope creeps.
    pub creep: Creep,
    /// Strain of its rope per offset of the joint, 1/rad; `None`: its type isn't described.
    pub strain_per_rad: Option<f64>,
}

/// The tendons of a fleet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gathered {
    /// Those whose creep can be told, by robot and joint.
    pub tendons: Vec<CreepingTendon>,
    /// Those with too few sessions.
    pub too_few: usize,
    /// Robot types of which there is no description.
    pub unknown_types: BTreeSet<String>,
}

/// Looks through a fleet.
///
/// # Errors
/// [`FleetError`].
pub fn gather(
    engine: &mut Engine,
    described: &[PathBuf],
    ages: Ages,
) -> Result<Gathered, FleetError> {
    let beside = Beside::read(&engine.folder.path, described)?;
    let robots = engine.folder.robots().into_iter();
    let names: Vec<String> = robots.map(str::to_owned).collect();
    let mut out = Gathered::default();
    for robots in names.chunks(TOGETHER) {
        let tendons = engine.sessions(robots)?;
        let looked: Vec<Option<CreepingTendon>> =
            tendons.par_iter().map(|t| look(&beside, t, ages)).collect();
        for (sessions, found) in tendons.iter().zip(looked) {
            if beside.robot_type(&sessions.robot_type).is_none() {
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

fn look(beside: &Beside, sessions: &Sessions, ages: Ages) -> Option<CreepingTendon> {
    let last_utc_s = sessions.rows.last()?.time_utc_s;
    let events = beside.events.get(&sessions.tendon);
    let replaced = events.into_iter().flatten();
    let replaced = replaced.filter(|e| e.replaced && e.time_utc_s <= last_utc_s);
    let fitted_utc_s = replaced.map(|e| e.time_utc_s).reduce(f64::max);
    let robot = beside.robot_type(&sessions.robot_type);
    let drift = robot.map_or(UNKNOWN_DRIFT_RAD_PER_K, |r| r.tolerances.drift_rad_per_k());
    let creep = creep(&sessions.rows, fitted_utc_s, ages, drift)?;
    let (name, joint) = sessions.tendon.clone();
    let mut fit = beside.fit(&sessions.tendon);
    let tendon = robot.and_then(|r| tendon_of(r, &joint));
    fit.rope = fit.rope.or(tendon.and_then(|t| t.rope.clone()));
    Some(CreepingTendon {
        robot_type: sessions.robot_type.clone(),
        site: beside.sites.get(&name).cloned(),
        robot: name,
        joint,
        fit,
        creep,
        strain_per_rad: tendon.map(|t| t.joint_pulley_radius_m / t.length_m),
    })
}
