//! Weights and noise estimates that are robust to outliers.

/// Redescending weight of a block whose mean normalised square residual is `chi`:
/// `(c²/(c² + χ))²` (Geman and McClure).
///
/// * `scale`: `c`, standard deviations.
pub(crate) fn redescending_weight(chi: f64, scale: f64) -> f64 {
    let w = scale * scale / (scale * scale + chi);
    w * w
}
