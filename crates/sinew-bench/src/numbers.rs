//! Many numbers in one.

use sinew_model::statistics::quantile;

/// NaN of none.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
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

/// Nothing for what isn't finite.
pub(crate) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Least-squares line: its value at the middle, its slope, and what is left.
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
