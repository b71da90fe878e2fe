//! Encoders that were not zeroed, though robot.toml says so.

use super::segments::Segments;
use super::warning::Warning;
use crate::error::SessionError;
use sinew_model::offset::{Belief, JointParameter, Prior};
use sinew_model::robot::Robot;

/// A zero so many of its own standard deviations away isn't where it was said to be …
const SURE: f64 = 5.0;
/// … unless friction reads like that, rad.
const LEAST_RAD: f64 = 2e-3;

/// The estimate from `start` with the zero of every joint anywhere, and which joints' was off; `None` where the recording
/// agrees with what is stated.
///
/// With a zero held where it isn't, stiffness and masses are bent to fit, and what they can't take up is left as
/// residual. Freed, it comes out many of its standard deviations away.
pub(super) fn opened(
    robot: &Robot,
    prior: &Prior,
    start: &Belief,
    estimate: impl Fn(Belief) -> Result<Segments, SessionError>,
) -> Result<Option<(Segments, Vec<Warning>)>, SessionError> {
    let elastic = || (0..robot.arm.dof()).filter(|&i| prior.is_elastic(i));
    let mut open = start.clone();
    for joint in elastic() {
        prior.tension(&mut open, joint);
    }
    let free = estimate(open)?;
    let off = elastic().filter_map(|joint| {
        let at = prior.place(joint, JointParameter::Zero);
        let (zero_rad, stated) = (free.belief.entry(at), start.entry(at));
        let far_rad = (zero_rad.mean - stated.mean).abs();
        let unsure_rad = zero_rad.deviation.hypot(stated.deviation);
        (far_rad > SURE * unsure_rad && far_rad > LEAST_RAD).then(|| Warning::NotZeroed {
            joint: robot.tendon_name(joint).to_owned(),
            zero_rad,
        })
    });
    let off: Vec<Warning> = off.collect();
    Ok((!off.is_empty()).then_some((free, off)))
}
