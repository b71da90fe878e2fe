//! What somebody states of a session, as far as it can be true.

use super::recorder::Window;
use sinew_model::Gaussian;
use sinew_model::offset::Payload;

/// A payload is known to this share of its mass where nothing else is stated.
const PAYLOAD_SHARE: f64 = 0.02;
/// A room's thermometer, one standard deviation, K.
const THERMOMETER_K: f64 = 2.0;
/// Temperatures a robot works at, °C.
const WORKING_C: std::ops::RangeInclusive<f64> = -60.0..=150.0;

/// What can't be true of a session.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatedError {
    /// A mass below 0.
    #[error("a payload of {0} kg is below 0")]
    Payload(f64),
    /// No temperature of a robot.
    #[error("{0} °C is no temperature a robot works at (-60 to 150 °C)")]
    Temperature(f64),
    /// A deviation below 0.
    #[error("± {0} is below 0")]
    Deviation(f64),
    /// A force from outside that nobody knows anything of, or knows exactly.
    #[error("a force known to ± {0} N: the deviation must be above 0 N, as in 0±2")]
    ForceDeviation(f64),
    /// A part of a recording without a length.
    #[error("{from_s} s to {to_s} s: the part must start at 0 s or later and end after its start")]
    Window {
        /// Start, s.
        from_s: f64,
        /// End, s.
        to_s: f64,
    },
}

/// What the gripper holds, kg, known to a standard deviation, 2 % where it isn't stated.
///
/// # Errors
/// [`StatedError`] below 0.
pub fn payload(mass_kg: f64, deviation_kg: Option<f64>) -> Result<Payload, StatedError> {
    if !(mass_kg >= 0.0) {
        return Err(StatedError::Payload(mass_kg));
    }
    let deviation_kg = deviation(deviation_kg)?.unwrap_or(PAYLOAD_SHARE * mass_kg);
    Ok(Payload::Known {
        mass_kg: Gaussian::new(mass_kg, deviation_kg),
    })
}

/// Temperature as a room's thermometer tells it, °C, to a standard deviation, 2 K where it isn't stated.
///
/// # Errors
/// [`StatedError`] outside what a robot works at.
pub fn temperature(c: f64, deviation_k: Option<f64>) -> Result<Gaussian, StatedError> {
    if !WORKING_C.contains(&c) {
        return Err(StatedError::Temperature(c));
    }
    let deviation_k = deviation(deviation_k)?.unwrap_or(THERMOMETER_K);
    Ok(Gaussian::new(c, deviation_k))
}

/// A constant force from outside at the tool along the axes of the base, N, each to a standard deviation.
///
/// # Errors
/// [`StatedError`] without a deviation above 0.
pub fn external_force(mean_n: [f64; 3], deviation_n: f64) -> Result<[Gaussian; 3], StatedError> {
    match deviation_n > 0.0 {
        true => Ok(mean_n.map(|mean_n| Gaussian::new(mean_n, deviation_n))),
        false => Err(StatedError::ForceDeviation(deviation_n)),
    }
}

/// A part of a recording, s from its start; `None`: up to its end.
///
/// # Errors
/// [`StatedError::Window`] without a length.
pub fn window(from_s: f64, to_s: Option<f64>) -> Result<Window, StatedError> {
    let to_s = to_s.unwrap_or(f64::INFINITY);
    match from_s >= 0.0 && from_s < to_s {
        true => Ok(Window { from_s, to_s }),
        false => Err(StatedError::Window { from_s, to_s }),
    }
}

fn deviation(stated: Option<f64>) -> Result<Option<f64>, StatedError> {
    match stated {
        Some(deviation) if !(deviation >= 0.0) => Err(StatedError::Deviation(deviation)),
        other => Ok(other),
    }
}
