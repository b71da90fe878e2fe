//! Uncertainty of the temperature change since the baseline.

use super::recorder::Recorded;
use super::result::TemperatureSource;
use super::warning::Warning;
use crate::baseline::Baseline;
use crate::estimator::{SessionOptions, mean_temperature};
use sinew_model::Z95;
use sinew_model::offset::{JointParameter, Prior, StateEstimate};
use sinew_model::robot::Robot;
use sinew_rope::law::{CELSIUS_ZERO_K, retraction_share};

/// Returns the source of a recording's temperature.
pub(super) fn source(recorded: &Recorded, options: &SessionOptions) -> TemperatureSource {
    if options.temperature_c.is_some() {
        TemperatureSource::Stated
    } else if mean_temperature(&recorded.blocks).is_finite() {
        TemperatureSource::Recorded
    } else {
        TemperatureSource::Unknown
    }
}

/// Replaces the recorded temperature by the specified one, if there is one.
pub(super) fn apply_specified(recorded: &mut Recorded, options: &SessionOptions) {
    if let Some(specified) = options.temperature_c {
        for block in &mut recorded.blocks {
            block.temperature_c = specified.mean;
        }
    }
}

/// Standard deviation of the temperature change from a baseline to a recording, K.
///
/// Each of the two temperatures is recorded, specified, or unknown; an unknown one has the tolerance in robot.toml.
pub(super) fn change_std_k(
    robot: &Robot,
    baseline: &Baseline,
    source: TemperatureSource,
    options: &SessionOptions,
) -> f64 {
    let unknown_k = robot.tolerances.temperature_k;
    let then_k = match baseline.temperature_c {
        Some(_) => baseline.temperature_std_k,
        None => unknown_k,
    };
    now_std_k(robot, source, options).hypot(then_k)
}

/// Standard deviation of the temperature change from the zeroing of the encoders to a recording, K: the temperature at
/// zeroing is not stated.
pub(super) fn since_zeroing_std_k(
    robot: &Robot,
    source: TemperatureSource,
    options: &SessionOptions,
) -> f64 {
    now_std_k(robot, source, options).hypot(robot.tolerances.temperature_k)
}

/// Standard deviation of the temperature of a recording, K.
fn now_std_k(robot: &Robot, source: TemperatureSource, options: &SessionOptions) -> f64 {
    match source {
        TemperatureSource::Recorded => 0.0,
        TemperatureSource::Stated => options.temperature_c.map_or(0.0, |t| t.std),
        TemperatureSource::Unknown => robot.tolerances.temperature_k,
    }
}

/// Adds the heat retraction of the ropes to the drift, between the reference temperature of `state_estimate` and `to_c`, the
/// temperature of a recording in °C:
///
/// ```text
/// α_T ← α_T − R Δg(θ)/Δθ,   var α_T ← var α_T + (σ_R Δg/Δθ)²
/// ```
///
/// No published data state the share of the retraction that is recovered when the rope cools. It is assumed uniform
/// between 0 and 1: mean 0.5, standard deviation 0.29. The state estimate does not change if one temperature is
/// unknown, or if
/// both are equal.
pub(super) fn expect_retraction(
    robot: &Robot,
    prior: &Prior,
    state_estimate: &mut StateEstimate,
    to_c: f64,
) {
    /// Standard deviation of a uniform distribution from 0 to 1.
    const UNIFORM_STD: f64 = 0.289;
    let change_k = to_c - state_estimate.temperature_c;
    let share = |c: f64| retraction_share(c + CELSIUS_ZERO_K);
    let retracts = share(to_c) - share(state_estimate.temperature_c);
    if !change_k.is_finite() || retracts == 0.0 {
        return;
    }
    let d = prior.dimension();
    for (i, transmission) in robot.transmissions.iter().enumerate() {
        let Some(temperature_effect) = transmission.as_ref().and_then(|t| t.temperature_effect)
        else {
            continue;
        };
        let full = temperature_effect.retraction_rad;
        let (mean, std) = if retracts > 0.0 {
            (full.mean, full.std)
        } else {
            let back = UNIFORM_STD * full.mean;
            (0.5 * full.mean, full.std.hypot(back))
        };
        let per_k = retracts / change_k;
        let at = prior.place(i, JointParameter::Drift);
        state_estimate.mean[at] -= mean * per_k;
        state_estimate.covariance[at * d + at] += (std * per_k).powi(2);
    }
}

/// Returns a warning for the joint with the largest thermal uncertainty, if that contributes more than half of the
/// variance of its offset.
pub(super) fn unknown_drift(
    robot: &Robot,
    drift_rad_per_k: impl Fn(usize) -> f64,
    half_width_95_rad: impl Fn(usize) -> f64,
    temperature_difference_k: f64,
) -> Option<Warning> {
    let unknown = |i: usize| Z95 * (drift_rad_per_k(i) * temperature_difference_k).abs();
    // A drift that robot.toml specifies needs no warning: only ropes of the catalogue are checked.
    let has_thermal_model = |i: &usize| {
        let transmission = robot.transmissions[*i].as_ref();
        transmission.is_some_and(|t| t.temperature_effect.is_some())
    };
    let elastic = (0..robot.axes()).filter(has_thermal_model);
    // More than half of the variance.
    let dominant = elastic.filter(|&i| 2.0 * unknown(i).powi(2) > half_width_95_rad(i).powi(2));
    let most = dominant.max_by(|&a, &b| unknown(a).total_cmp(&unknown(b)))?;
    let tendon = robot.transmissions[most].as_ref()?.tendon.as_ref();
    Some(Warning::ThermalEffect {
        joint: robot.tendon_name(most).to_owned(),
        temperature_difference_k,
        half_width_95_rad: unknown(most),
        frame_is_specified: tendon.is_some_and(|t| t.frame_expansion_per_k.is_some()),
    })
}
