//! Many numbers in one.

use sinew_model::statistics::quantile;

/// NaN of none.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean of pairs of a weight and a value; NaN of none.
pub(crate) fn weighted_mean(pairs: &[(f64, f64)]) -> f64 {
    let weights: f64 = pairs.iter().map(|(weight, _)| weight).sum();
    pairs.iter().map(|(weight, v)| weight * v).sum::<f64>() / weights
}

/// Root mean square; NaN of none.
pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Quantile of numbers in any order; NaN of none.
pub(crate) fn quantile_of(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    quantile(&values, share)
}

/// `None` for a non-finite value.
pub(crate) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Fits a least-squares line; returns its value at the centre, its slope, and the residuals.
pub(crate) fn line(points: &[(f64, f64)]) -> (f64, f64, Vec<f64>) {
    let n = points.len() as f64;
    let (mx, my) = points
        .iter()
        .fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| {
        (a + (x - mx) * (y - my), b + (x - mx) * (x - mx))
    });
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    let left = points
        .iter()
        .map(|(x, y)| y - my - slope * (x - mx))
        .collect();
    (my, slope, left)
}
