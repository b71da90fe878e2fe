//! Encoder zero offsets that are inconsistent with robot.toml.

use super::segments::Segments;
use super::warning::Warning;
use crate::error::SessionError;
use sinew_model::offset::{JointParameter, Prior, StateEstimate};
use sinew_model::robot::Robot;

/// Minimum z-score of an encoder zero offset against its specified value to be reported.
const MIN_Z_SCORE: f64 = 5.0;
/// Minimum difference of an encoder zero offset from its specified value to be reported, rad: friction explains smaller
/// ones.
const MIN_DIFFERENCE_RAD: f64 = 2e-3;

/// Estimates from `start` with a free encoder zero at every joint, and returns the estimate with a warning for each
/// inconsistent joint; `None` if the recording is consistent with the specified zeros.
///
/// If a zero is fixed at a wrong value, the estimates of stiffness and masses are biased to fit, and the remainder
/// appears in the residual. A free zero then differs from the specified value by many standard deviations.
pub(super) fn estimate_zero(
    robot: &Robot,
    prior: &Prior,
    start: &StateEstimate,
    estimate: impl Fn(StateEstimate) -> Result<Segments, SessionError>,
) -> Result<Option<(Segments, Vec<Warning>)>, SessionError> {
    let elastic = || (0..robot.axes()).filter(|&i| prior.is_elastic(i));
    let mut free_zero = start.clone();
    for joint in elastic() {
        prior.tension(&mut free_zero, joint);
    }
    let free = estimate(free_zero)?;
    let warnings = elastic().filter_map(|joint| {
        let at = prior.place(joint, JointParameter::Zero);
        let (zero_rad, specified) = (free.state_estimate.entry(at), start.entry(at));
        let difference_rad = (zero_rad.mean - specified.mean).abs();
        let std_rad = zero_rad.std.hypot(specified.std);
        (difference_rad > MIN_Z_SCORE * std_rad && difference_rad > MIN_DIFFERENCE_RAD).then(|| {
            Warning::EncoderZeroOffset {
                joint: robot.tendon_name(joint).to_owned(),
                zero_rad,
            }
        })
    });
    let warnings: Vec<Warning> = warnings.collect();
    Ok((!warnings.is_empty()).then_some((free, warnings)))
}
