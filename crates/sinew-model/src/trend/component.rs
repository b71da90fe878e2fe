//! One Kalman filter: a curve and a noise.

use super::gauss::{above_zero, log_normal};

/// Level, taken out, amplitude, temperature drift, slow error, error per error of the stiffness.
pub const STATES: usize = 6;
/// Entries of the lower triangle of a covariance.
pub(super) const TRIANGLE: usize = STATES * (STATES + 1) / 2;
pub(super) const LEVEL: usize = 0;
pub(super) const TAKEN_OUT: usize = 1;
pub(super) const AMPLITUDE: usize = 2;
pub(super) const DRIFT: usize = 3;
pub(super) const SLOW: usize = 4;
pub(super) const SHARED: usize = 5;

/// A Kalman filter for one curve and one noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Index of the curve.
    pub curve: u32,
    /// Index of the noise.
    pub noise: u32,
    /// Logarithm of its probability, up to a constant of the bank.
    pub log_weight: f64,
    /// Means: rad, rad, 1, rad/K, rad, rad.
    pub mean: [f64; STATES],
    /// Lower triangle of the covariance, row by row.
    pub covariance: [f64; TRIANGLE],
}

/// Where `(i, k)` stands in the triangle.
pub(super) const fn entry(i: usize, k: usize) -> usize {
    if i >= k {
        i * (i + 1) / 2 + k
    } else {
        k * (k + 1) / 2 + i
    }
}

impl Component {
    /// Mean and variance of what a record sees, without its own error.
    pub(super) fn predict(&self, h: &[f64; STATES]) -> (f64, f64) {
        let mut expected = 0.0;
        let mut variance = 0.0;
        for i in 0..STATES {
            expected += h[i] * self.mean[i];
            let mut ph = 0.0;
            for k in 0..STATES {
                ph += self.covariance[entry(i, k)] * h[k];
            }
            variance += h[i] * ph;
        }
        (expected, variance.max(0.0))
    }

    /// Kalman update; the weight takes the evidence. Returns the gain.
    pub(super) fn correct(
        &mut self,
        h: &[f64; STATES],
        value: f64,
        own_variance: f64,
    ) -> [f64; STATES] {
        let mut ph = [0.0; STATES];
        for i in 0..STATES {
            for k in 0..STATES {
                ph[i] += self.covariance[entry(i, k)] * h[k];
            }
        }
        let (expected, variance) = self.predict(h);
        let s = variance + own_variance;
        let error = value - expected;
        for i in 0..STATES {
            self.mean[i] += ph[i] / s * error;
            for k in 0..=i {
                self.covariance[entry(i, k)] -= ph[i] * ph[k] / s;
            }
            // Rounding must not make a variance negative.
            let own = &mut self.covariance[entry(i, i)];
            *own = own.max(0.0);
        }
        self.log_weight += log_normal(error, s);
        ph.map(|v| v / s)
    }

    /// Logarithm of the weight with `a > 0` reckoned in.
    pub(super) fn weight_above_zero(&self) -> f64 {
        let deviation = libm::sqrt(self.covariance[entry(AMPLITUDE, AMPLITUDE)]).max(1e-300);
        self.log_weight + libm::log(above_zero(self.mean[AMPLITUDE], deviation))
    }
}
