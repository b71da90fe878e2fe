//! Order statistics.

/// Ratio of the standard deviation of a normal distribution to its median absolute deviation, `1/Φ⁻¹(3/4)`.
pub const DEVIATION_PER_MEDIAN: f64 = 1.4826;

/// Quantile of sorted numbers by linear interpolation; `share` of them lie below it. NaN of none.
///
/// `x₍ₖ₎ + (h − k)(x₍ₖ₊₁₎ − x₍ₖ₎)` with `h = share (n − 1)` and `k = ⌊h⌋`.
///
/// # Source
/// R. J. Hyndman, Y. Fan, *Sample Quantiles in Statistical Packages*, 1996, definition 7.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let at = share.clamp(0.0, 1.0) * last as f64;
    let below = libm::floor(at);
    let (k, rest) = (below as usize, at - below);
    let next = sorted[(k + 1).min(last)];
    sorted[k] + (next - sorted[k]) * rest
}

/// Returns the upper median, which is one of the values and therefore finite if more than half of them are. Reorders
/// the values; `None` without values.
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_on_straight_lines_between_values() {
        assert_eq!(quantile(&[1.0, 2.0, 3.0], 0.5), 2.0);
        assert_eq!(quantile(&[0.0, 10.0], 0.95), 9.5);
        assert_eq!(quantile(&[0.0, 10.0], 2.0), 10.0);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn upper_median_is_one_of_values() {
        assert_eq!(upper_median(&mut [3.0, 1.0, f64::INFINITY, 2.0]), Some(3.0));
        assert_eq!(upper_median(&mut []), None);
    }
}
