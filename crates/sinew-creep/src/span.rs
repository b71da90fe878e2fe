//! Mean and extremes of measurements.

use serde::{Deserialize, Serialize};

/// Mean, minimum and maximum of measurements, in the unit of the field's name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Span {
    /// Mean of the measurements.
    pub mean: f64,
    /// Minimum of the measurements.
    pub low: f64,
    /// Maximum of the measurements.
    pub high: f64,
}

impl Span {
    /// Span of a constant value.
    pub(super) fn point(value: f64) -> Self {
        Self {
            mean: value,
            low: value,
            high: value,
        }
    }

    /// Span of measurements; `None` without any.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        let (low, high) = extremes(values);
        (!values.is_empty()).then(|| Self {
            mean: values.iter().sum::<f64>() / values.len() as f64,
            low,
            high,
        })
    }
}

/// Minimum and maximum; infinity and minus infinity without values.
pub(super) fn extremes(values: &[f64]) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), wider)
}
