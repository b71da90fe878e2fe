//! How well the change of temperature since the baseline is known.

use super::recorder::Recorded;
use super::result::TemperatureSource;
use super::warning::Warning;
use crate::baseline::Baseline;
use crate::estimator::{SessionOptions, mean_temperature};
use sinew_model::Z95;
use sinew_model::offset::{Belief, JointParameter, Prior};
use sinew_model::robot::Robot;
use sinew_rope::law::{CELSIUS_ZERO_K, retraction_share};

/// Where a recording's temperature comes from.
pub(super) fn source(recorded: &Recorded, options: &SessionOptions) -> TemperatureSource {
    if options.temperature_c.is_some() {
        TemperatureSource::Stated
    } else if mean_temperature(&recorded.blocks).is_finite() {
        TemperatureSource::Recorded
    } else {
        TemperatureSource::Unknown
    }
}

/// A stated temperature takes the place of the recorded one.
pub(super) fn state(recorded: &mut Recorded, options: &SessionOptions) {
    if let Some(stated) = options.temperature_c {
        for block in &mut recorded.blocks {
            block.temperature_c = stated.mean;
        }
    }
}

/// Standard deviation of the temperature's change from a baseline to a recording, K: each of the two is
/// recorded, stated, or as usual.
pub(super) fn change_deviation_k(
    robot: &Robot,
    baseline: &Baseline,
    source: TemperatureSource,
    options: &SessionOptions,
) -> f64 {
    let unknown_k = robot.tolerances.temperature_k;
    let now_k = match source {
        TemperatureSource::Recorded => 0.0,
        TemperatureSource::Stated => options.temperature_c.map_or(0.0, |t| t.deviation),
        TemperatureSource::Unknown => unknown_k,
    };
    let then_k = match baseline.temperature_c {
        Some(_) => baseline.temperature_deviation_k,
        None => unknown_k,
    };
    now_k.hypot(then_k)
}

/// Adds to the drift what the heat retraction of the ropes makes of it between the temperature a belief
/// refers to and that of a recording:
///
/// ```text
/// α_T ← α_T − R Δg(θ)/Δθ,   var α_T ← var α_T + (σ_R Δg/Δθ)²
/// ```
///
/// How much of a retraction comes back when the rope cools nobody has published: between nothing and all,
/// so half, ± 0.29. Nothing happens without both temperatures, or where they are the same.
pub(super) fn expect_retraction(robot: &Robot, prior: &Prior, belief: &mut Belief, to_c: f64) {
    /// Of an even spread from 0 to 1.
    const EVEN_DEVIATION: f64 = 0.289;
    let change_k = to_c - belief.temperature_c;
    let share = |c: f64| retraction_share(c + CELSIUS_ZERO_K);
    let retracts = share(to_c) - share(belief.temperature_c);
    if !change_k.is_finite() || retracts == 0.0 {
        return;
    }
    let d = prior.dimension();
    for (i, transmission) in robot.transmissions.iter().enumerate() {
        let Some(warmth) = transmission.as_ref().and_then(|t| t.warmth) else {
            continue;
        };
        let full = warmth.retraction_rad;
        let (mean, deviation) = if retracts > 0.0 {
            (full.mean, full.deviation)
        } else {
            let back = EVEN_DEVIATION * full.mean;
            (0.5 * full.mean, full.deviation.hypot(back))
        };
        let per_k = retracts / change_k;
        let at = prior.place(i, JointParameter::Drift);
        belief.mean[at] -= mean * per_k;
        belief.covariance[at * d + at] += (deviation * per_k).powi(2);
    }
}

/// A warning where warmth leaves more of a joint's offset unknown than everything else: the joint of which
/// it leaves most.
pub(super) fn unknown_drift(
    robot: &Robot,
    drift_rad_per_k: impl Fn(usize) -> f64,
    half_width_95_rad: impl Fn(usize) -> f64,
    warmer_k: f64,
) -> Option<Warning> {
    let unknown = |i: usize| Z95 * (drift_rad_per_k(i) * warmer_k).abs();
    // What the owner states himself is no news to him.
    let looked_up = |i: &usize| {
        let transmission = robot.transmissions[*i].as_ref();
        transmission.is_some_and(|t| t.warmth.is_some())
    };
    let elastic = (0..robot.arm.dof()).filter(looked_up);
    // Half of the variance.
    let much = elastic.filter(|&i| 2.0 * unknown(i).powi(2) > half_width_95_rad(i).powi(2));
    let most = much.max_by(|&a, &b| unknown(a).total_cmp(&unknown(b)))?;
    let tendon = robot.transmissions[most].as_ref()?.tendon.as_ref();
    Some(Warning::DriftUnknown {
        joint: robot.tendon_name(most).to_owned(),
        warmer_k,
        half_width_95_rad: unknown(most),
        frame_is_stated: tendon.is_some_and(|t| t.frame_expansion_per_k.is_some()),
    })
}
