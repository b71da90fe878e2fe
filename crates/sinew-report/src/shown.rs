//! How values become what is shown.

/// What isn't known is shown as the tables show NaN.
pub(crate) fn or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

/// From rad per relative error to mrad per percent.
pub(crate) const MRAD_PER_PERCENT: f64 = 1e3 * 0.01;
