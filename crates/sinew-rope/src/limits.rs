//! Where no rope is left to predict: melted, crept apart, or pulled out of its route.

use super::CatalogueRope;
use super::refusal::PredictError;
use super::route::Request;
use crate::law::Polymer;

/// HMPE melts from here on, °C: the lower end of what is reported for its fibres, 144 to 152 °C.
pub(crate) const HMPE_MELTS_C: f64 = 144.0;
/// Refuses a temperature at which the rope's fibre melts.
///
/// # Errors
/// [`PredictError::Melts`].
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

/// Refuses what no rope of this kind can do, whatever its parameters.
///
/// # Errors
/// [`PredictError::Melts`], [`PredictError::Stroke`].
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
