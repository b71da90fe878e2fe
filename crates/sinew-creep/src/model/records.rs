//! Common properties of a set of curves: times, loads, temperatures.

use crate::curve::Curve;
use sinew_model::statistics::upper_median;

/// First and last measurement time after the first load, over all curves, s.
pub(super) fn span(curves: &[Curve]) -> (f64, f64) {
    let since = |curve: &Curve| -> (f64, f64) {
        let start = curve.steps.first().map_or(0.0, |step| step.0);
        let after = curve.time_s.iter().map(|t| t - start);
        let first = after.clone().find(|t| *t > 0.0).unwrap_or(1.0);
        (first, after.fold(first, f64::max))
    };
    let both = curves.iter().map(since);
    both.fold((f64::INFINITY, 0.0), |(short, long), (first, last)| {
        (short.min(first), long.max(last))
    })
}

/// Ratio of the largest to the smallest load.
pub(super) fn levels(curves: &[Curve]) -> f64 {
    let loads = || {
        let all = curves.iter().flat_map(|c| c.steps.iter().map(|s| s.1));
        all.filter(|l| *l > 0.05)
    };
    loads().fold(0.0, f64::max) / loads().fold(f64::INFINITY, f64::min)
}

pub(super) fn temperatures_differ(curves: &[Curve]) -> bool {
    let warm = || curves.iter().filter_map(|c| c.temperature_c);
    let span = warm().fold(f64::NEG_INFINITY, f64::max) - warm().fold(f64::INFINITY, f64::min);
    warm().count() == curves.len() && span > 3.0
}

/// Median time between measurements, s.
pub(super) fn typical_gap(curves: &[Curve]) -> f64 {
    let mut gaps: Vec<f64> = curves
        .iter()
        .flat_map(|c| c.time_s.windows(2).map(|w| w[1] - w[0]))
        .filter(|gap| *gap > 0.0)
        .collect();
    upper_median(&mut gaps).unwrap_or(1.0)
}

/// Adds the zero as one measurement before the load: a mean of the measurements it was computed
/// from.
pub(super) fn add_zero(curve: &mut Curve) {
    if curve.zero_count > 0.0 {
        let start = curve.steps.first().map_or(0.0, |step| step.0);
        let before = curve.tension.map_or(0.0, |t| 0.5 * t.preloaded_s);
        curve.time_s.insert(0, start - before.max(1e-3));
        curve.strain.insert(0, 0.0);
        curve.count.insert(0, curve.zero_count);
    }
}
