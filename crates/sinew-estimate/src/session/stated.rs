//! Validation of values that the user specifies for a session.

use super::recorder::Window;
use sinew_model::Gaussian;
use sinew_model::offset::Payload;

/// Default standard deviation of a specified payload, relative to its mass.
const PAYLOAD_STD_RATIO: f64 = 0.02;
/// Default standard deviation of a specified temperature, K: that of a room thermometer.
const TEMPERATURE_STD_K: f64 = 2.0;
/// Range of valid operating temperatures, °C.
const WORKING_C: std::ops::RangeInclusive<f64> = -60.0..=150.0;

/// Error of a value specified for a session.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatedError {
    /// Negative or non-finite payload mass, kg.
    #[error("invalid payload {0} kg: specify a mass of 0 kg or more")]
    Payload(f64),
    /// Temperature outside the operating range of a robot, °C.
    #[error("invalid temperature {0} °C: specify an operating temperature (−60 to 150 °C)")]
    Temperature(f64),
    /// Negative or non-finite standard deviation.
    #[error("invalid standard deviation {0}: specify 0 or more")]
    Deviation(f64),
    /// Standard deviation of an external force that is not positive, N.
    #[error(
        "invalid standard deviation of the external force, {0} N: specify more than 0 N, as in 0±2"
    )]
    ForceDeviation(f64),
    /// Interval of a recording that is empty or starts before 0 s.
    #[error(
        "invalid interval {from_s} s to {to_s} s: it must start at 0 s or later and end after its start"
    )]
    Window {
        /// Start of the interval, s.
        from_s: f64,
        /// End of the interval, s.
        to_s: f64,
    },
}

/// Creates a payload from its mass in kg and its standard deviation in kg; the default is 2 % of the mass.
///
/// # Errors
/// Returns [`StatedError::Payload`] or [`StatedError::Deviation`] if a value is negative or NaN.
pub fn payload(mass_kg: f64, std_kg: Option<f64>) -> Result<Payload, StatedError> {
    if !(mass_kg >= 0.0) {
        return Err(StatedError::Payload(mass_kg));
    }
    let std_kg = std(std_kg)?.unwrap_or(PAYLOAD_STD_RATIO * mass_kg);
    Ok(Payload::Specified {
        mass_kg: Gaussian::new(mass_kg, std_kg),
    })
}

/// Creates a temperature from its value in °C and its standard deviation in K; the default is 2 K.
///
/// # Errors
/// Returns [`StatedError::Temperature`] outside −60 to 150 °C, and [`StatedError::Deviation`] if `std_k` is negative or
/// NaN.
pub fn temperature(c: f64, std_k: Option<f64>) -> Result<Gaussian, StatedError> {
    if !WORKING_C.contains(&c) {
        return Err(StatedError::Temperature(c));
    }
    let std_k = std(std_k)?.unwrap_or(TEMPERATURE_STD_K);
    Ok(Gaussian::new(c, std_k))
}

/// Creates a constant external force at the tool along the axes of the base frame, in N, with one standard deviation in
/// N for all components.
///
/// # Errors
/// Returns [`StatedError::ForceDeviation`] if `std_n` is not positive.
pub fn external_force(mean_n: [f64; 3], std_n: f64) -> Result<[Gaussian; 3], StatedError> {
    match std_n > 0.0 {
        true => Ok(mean_n.map(|mean_n| Gaussian::new(mean_n, std_n))),
        false => Err(StatedError::ForceDeviation(std_n)),
    }
}

/// Creates an interval of a recording, in s from its start; `None` for `to_s` is the end of the recording.
///
/// # Errors
/// Returns [`StatedError::Window`] if the interval is empty or starts before 0 s.
pub fn window(from_s: f64, to_s: Option<f64>) -> Result<Window, StatedError> {
    let to_s = to_s.unwrap_or(f64::INFINITY);
    match from_s >= 0.0 && from_s < to_s {
        true => Ok(Window { from_s, to_s }),
        false => Err(StatedError::Window { from_s, to_s }),
    }
}

fn std(specified: Option<f64>) -> Result<Option<f64>, StatedError> {
    match specified {
        Some(std) if !(std >= 0.0) => Err(StatedError::Deviation(std)),
        other => Ok(other),
    }
}
