//! How well the change of temperature since the baseline is known.

use super::recorder::Recorded;
use super::result::TemperatureSource;
use crate::baseline::Baseline;
use crate::estimator::{SessionOptions, mean_temperature};
use sinew_model::robot::Robot;

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
