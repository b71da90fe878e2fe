//! Mean and extremes of readings.

use serde::{Deserialize, Serialize};

/// Mean, lowest and highest of readings, in the unit that the field's name says.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Span {
    /// Mean.
    pub mean: f64,
    /// Lowest.
    pub low: f64,
    /// Highest.
    pub high: f64,
}

impl Span {
    /// Of a value that stays.
    pub(super) fn point(value: f64) -> Self {
        Self {
            mean: value,
            low: value,
            high: value,
        }
    }

    /// Of readings; `None` without any.
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        let (low, high) = extremes(values);
        (!values.is_empty()).then(|| Self {
            mean: values.iter().sum::<f64>() / values.len() as f64,
            low,
            high,
        })
    }
}

/// Smallest and largest; an empty range the wrong way round of none.
pub(super) fn extremes(values: &[f64]) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), wider)
}
