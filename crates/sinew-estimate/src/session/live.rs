//! The recursive form of the session estimate, for a robot that runs.

use super::result::TemperatureSource;
use super::temperature;
use crate::baseline::Baseline;
use crate::error::SessionError;
use crate::estimator::{SessionOptions, estimator};
use sinew_model::offset::{Belief, Prior, RecursiveOffsets, UNKNOWN_OFFSET_RAD, beliefs};
use sinew_model::robot::Robot;

/// The recursive form since `baseline` (with the file's name), for a robot that runs: blocks of a
/// [`FeatureObserver`](sinew_model::offset::FeatureObserver) with [`FeatureConfig::default`](sinew_model::offset::FeatureConfig) go into
/// [`RecursiveOffsets::step`].
///
/// Blocks carry the temperature; one that [`SessionOptions::temperature_c`] states takes its place. While neither is known the
/// intervals hold what a temperature nobody knows makes of the offsets, as those of a recording do. Allocates here only.
/// `examples/live_offsets.rs` runs it sample by sample.
///
/// # Errors
/// [`SessionError`] when the baseline is of another robot.
pub fn live(
    robot: &Robot,
    (baseline, file): (&Baseline, &str),
    options: &SessionOptions,
) -> Result<RecursiveOffsets, SessionError> {
    let estimator = estimator(robot, options);
    let mut belief = baseline.belief(robot, estimator.prior(), file)?;
    let temperature = match options.temperature_c {
        Some(_) => TemperatureSource::Stated,
        None => TemperatureSource::Recorded,
    };
    let change_k = temperature::change_deviation_k(robot, baseline, temperature, options);
    beliefs::age(estimator.prior(), &mut belief);
    let unknown = TemperatureSource::Unknown;
    let unknown_k = temperature::change_deviation_k(robot, baseline, unknown, options);
    let unknown_rad =
        beliefs::unknown_temperature(estimator.prior(), &mut belief.clone(), unknown_k);
    let added_rad = open(estimator.prior(), &mut belief, options, change_k);
    let mut filter =
        RecursiveOffsets::new(estimator, belief).map_err(|error| SessionError::Map {
            file: file.into(),
            error,
        })?;
    filter.add_deviation(&added_rad);
    let stated_c = options.temperature_c.map_or(f64::NAN, |t| t.mean);
    filter.expect_temperature(stated_c, &unknown_rad);
    filter.expect_noise(&baseline.noise_rad, &baseline.motor_noise_nm);
    Ok(filter)
}

/// The recursive form without a baseline: offsets against the encoders' zero, from the tolerances of robot.toml.
/// Allocates here only.
///
/// # Errors
/// [`SessionError`] when the tolerances make no prior.
pub fn live_without_baseline(
    robot: &Robot,
    options: &SessionOptions,
) -> Result<RecursiveOffsets, SessionError> {
    let estimator = estimator(robot, options);
    let prior = estimator.prior();
    let mut fresh = prior.belief(options.payload, UNKNOWN_OFFSET_RAD);
    prior.hold_zero(&mut fresh);
    fresh.temperature_c = options.temperature_c.map_or(f64::NAN, |t| t.mean);
    RecursiveOffsets::new(estimator, fresh).map_err(|error| SessionError::Map {
        file: robot.name.clone(),
        error,
    })
}

/// What `filter`, which [`live`] began from `before`, knows by `end_time_ns` of `recording`, as the next of the chain:
/// for the next [`live`] or [`estimate`](super::estimate).
///
/// # Errors
/// [`SessionError::Provisional`] while the filter doubts what it believes.
pub fn live_saved(
    robot: &Robot,
    before: &Baseline,
    filter: &RecursiveOffsets,
    (recording, end_time_ns): (&str, i64),
) -> Result<Baseline, SessionError> {
    // What is left of a block's work is done on a copy: nothing is lost, and the filter goes on where it was.
    let mut filter = filter.clone();
    filter.finish();
    if filter.is_provisional() {
        return Err(SessionError::Provisional {
            recording: recording.into(),
        });
    }
    let belief = filter.belief().map_err(|error| SessionError::Map {
        file: recording.into(),
        error,
    })?;
    let mut recordings = before.recordings.clone();
    recordings.push(recording.into());
    let noise = filter.noise().map(<[f64]>::to_vec);
    let mut next = Baseline::new(robot, recordings, end_time_ns, &belief, noise);
    next.before.clone_from(&before.before);
    next.temperature_deviation_k = before.temperature_deviation_k;
    next.zero_time_ns = before.zero_time();
    Ok(next)
}

/// What a baseline knows, in another recording: offsets may be anything, the gripper hold something else, and the
/// temperature be another by `change_k`, a standard deviation. Returns what that leaves unknown of every joint's
/// offset, rad.
pub(super) fn open(
    prior: &Prior,
    belief: &mut Belief,
    options: &SessionOptions,
    change_k: f64,
) -> Vec<f64> {
    prior.open_offsets(belief, UNKNOWN_OFFSET_RAD);
    prior.open_payload(belief, options.payload);
    beliefs::unknown_temperature(prior, belief, change_k)
}
