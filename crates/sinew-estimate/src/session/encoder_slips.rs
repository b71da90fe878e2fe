//! Attribution of offset changes to the encoders.

use super::recorder::Recorded;
use crate::cause::Cause;
use crate::jumps::quickness;
use sinew_model::Gaussian;
use sinew_model::offset::{ChangeKind, ChangePoint, MapEstimate, Prior};
use sinew_model::robot::Robot;

/// Offset changes of a posterior that are slips of an encoder.
pub(super) fn encoder_slips(
    robot: &Robot,
    prior: &Prior,
    recorded: &Recorded,
    map: &MapEstimate,
) -> Vec<ChangePoint> {
    let is_encoder = |(k, point): (usize, &ChangePoint)| {
        let ChangeKind::Offset(joint) = point.kind else {
            return None;
        };
        let time_s = map.posterior(point).map_or(point.at_s, |p| p.time_s);
        let found = cause(robot, recorded, joint, (time_s, map.change(prior, k)));
        found.is_some_and(Cause::is_encoder).then_some(*point)
    };
    map.changes
        .iter()
        .enumerate()
        .filter_map(is_encoder)
        .collect()
}

/// Cause of an offset change of a joint at a time (s) of a size (rad): the rope or one of the encoders; `None` for a
/// rigid joint.
pub(super) fn cause(
    robot: &Robot,
    recorded: &Recorded,
    joint: usize,
    (time_s, size_rad): (f64, Gaussian),
) -> Option<Cause> {
    let nearest = recorded
        .blocks
        .partition_point(|b| b.time_s < time_s)
        .min(recorded.blocks.len().saturating_sub(1));
    let block = recorded.blocks.get(nearest)?;
    let t = robot.transmissions.get(joint)?.as_ref()?;
    let (stiffness, inertia) = (t.stiffness_nm_per_rad, t.motor_inertia_kg_m2);
    let quickness = quickness(&robot.arm, &block.q, joint, stiffness, inertia);
    Some(recorded.jumps.cause(joint, time_s, size_rad, quickness))
}
