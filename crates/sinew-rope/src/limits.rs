//! Limits of a prediction: a melted fibre, creep rupture, or a rope pulled out of its route.

use super::CatalogueRope;
use super::predict_error::PredictError;
use super::route::Request;
use crate::law::Polymer;

/// Lowest melting temperature of HMPE fibres, °C; 144 to 152 °C are reported.
pub(crate) const HMPE_MELTS_C: f64 = 144.0;
/// Rejects a temperature at which the rope's fibre melts.
///
/// # Errors
/// Returns [`PredictError::Melts`] at or above the melting temperature of HMPE.
pub(crate) fn check_temperature(rope: &CatalogueRope, hottest_c: f64) -> Result<(), PredictError> {
    if rope.entry.material == Polymer::Hmpe && hottest_c >= HMPE_MELTS_C {
        return Err(PredictError::Melts {
            rope: rope.entry.name.clone(),
            temperature_c: hottest_c,
            melts_c: HMPE_MELTS_C,
        });
    }
    Ok(())
}

/// Rejects a request that no rope of this material can fulfil, independent of its parameters.
///
/// # Errors
/// Returns [`PredictError::Melts`] for a molten fibre and [`PredictError::Stroke`] for a stroke as long as
/// the strand.
pub(super) fn check(rope: &CatalogueRope, request: &Request) -> Result<(), PredictError> {
    let route = &request.route;
    if route.stroke_m >= route.length_m {
        return Err(PredictError::Stroke {
            stroke_m: route.stroke_m,
            length_m: route.length_m,
        });
    }
    check_temperature(rope, request.duty.summary().temperature_max_c)
}
