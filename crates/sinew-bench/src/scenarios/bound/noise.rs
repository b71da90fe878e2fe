//! Covariance of the sensor errors in the features of a recording.

/// Maximum lag of the autocovariance, s: a rest phase plus the memory of the filters.
const REACH_S: f64 = 3.0;

/// Autocovariance of a stationary error in blocks of equal length.
#[derive(Debug, Clone)]
pub(super) struct Autocovariance {
    block_s: f64,
    /// By lag in blocks, rad².
    lags: Vec<f64>,
}

impl Autocovariance {
    /// Estimates the autocovariance from the errors in consecutive blocks, one series per session, rad.
    ///
    /// The mean is not subtracted, because a constant error is an error. Lags have the weights of Bartlett's triangle,
    /// so that the spectrum is not negative; a relative variance of 1e-6 on the diagonal keeps the matrix invertible.
    pub(super) fn of(series: &[Vec<f64>], block_s: f64) -> Self {
        let reach = (REACH_S / block_s).ceil() as usize;
        let count: usize = series.iter().map(Vec::len).sum();
        let lags = (0..reach)
            .map(|lag| {
                let sum: f64 = series
                    .iter()
                    .flat_map(|s| s.iter().zip(s.iter().skip(lag)))
                    .map(|(a, b)| a * b)
                    .sum();
                (1.0 - lag as f64 / reach as f64) * sum / count.max(1) as f64
            })
            .collect();
        Self { block_s, lags }
    }

    /// Covariance of the errors in blocks at `times`, s; row-major, rad².
    pub(super) fn matrix(&self, times: &[f64]) -> Vec<f64> {
        let n = times.len();
        let least = 1e-6 * self.lags.first().copied().unwrap_or(0.0) + f64::MIN_POSITIVE;
        let mut out = vec![0.0; n * n];
        for (a, ta) in times.iter().enumerate() {
            for (b, tb) in times.iter().enumerate() {
                let lag = ((ta - tb).abs() / self.block_s).round() as usize;
                let same = if a == b { least } else { 0.0 };
                out[a * n + b] = self.lags.get(lag).copied().unwrap_or(0.0) + same;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_constant_and_white_errors_differ() {
        // Deterministic, uncorrelated numbers in −1…1.
        let mut state = 1u64;
        let mut white = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let alone: Vec<f64> = (0..20000).map(|_| white()).collect();
        let mut held = 0.0;
        let kept: Vec<f64> = (0..20000)
            .map(|k| {
                if k % 5 == 0 {
                    held = white();
                }
                held
            })
            .collect();
        let variance = 1.0 / 3.0;
        let c = Autocovariance::of(&[alone], 0.2).matrix(&[0.0, 0.2, 9.0]);
        // Of 20000 numbers a covariance scatters by 0.7 % of the variance.
        assert!((c[0] / variance - 1.0).abs() < 0.03 && c[1].abs() < 0.03 * variance);
        assert_eq!(c[2], 0.0);
        let c = Autocovariance::of(&[kept], 0.2).matrix(&[0.0, 0.2]);
        // Of neighbours, four of five share a number; the triangle takes a fifteenth.
        let expected = 0.8 * (1.0 - 1.0 / 15.0) * variance;
        assert!((c[1] / expected - 1.0).abs() < 0.05, "{}", c[1] / expected);
    }
}
