//! Noise model of a record: white noise plus a slow part.
//!
//! `y = X β + x + v`, `cov(x_i, x_j) = σ² ρ exp(−|u_i − u_j|/τ_c)`, `var v_i = σ² (1 − ρ)/c_i` with
//! `c_i` the number of measurements averaged into point `i`. The slow part represents the climate
//! of the room, the warm-up of a sensor and above all the model error of the law. It is smooth over
//! the logarithm of time, as creep is, so `u = ln(1 + t/t₀)` ([`Clock`]): on the 204 spruce tests
//! this is far more probable than a correlation time in seconds. A Kalman filter with one state
//! whitens a column in O(n), at any spacing of the samples.

use super::curve::Curve;
use super::law::Law;

/// Parameters of the noise.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Noise {
    /// Share of the slow part in the variance of a single measurement, 0 to [`SHARE_MAX`].
    pub share: f64,
    /// Correlation time `τ_c` of the slow part: e-folds of the time under load; for a straight
    /// line, s.
    pub memory: f64,
}

/// Time scale of the slow part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clock {
    /// Logarithmic scale `ln(1 + t/t₀)` since the first load.
    Logarithm {
        /// Reference time `t₀`, s.
        unit_s: f64,
    },
    /// Linear scale in seconds.
    Seconds,
}

impl Clock {
    /// Reference time `t₀` as a share of the record.
    const UNIT_SHARE: f64 = 1e-3;

    /// Selects the scale: linear for a straight line, which is fitted to a late part of a record.
    pub(super) fn of(law: Law, long_s: f64) -> Self {
        match law {
            Law::Line => Clock::Seconds,
            _ => Clock::Logarithm {
                unit_s: Self::UNIT_SHARE * long_s,
            },
        }
    }

    pub(super) fn at(self, curve: &Curve, t: f64) -> f64 {
        match self {
            Clock::Seconds => t,
            Clock::Logarithm { unit_s } => {
                let start = curve.steps.first().map_or(0.0, |s| s.0);
                ((t - start).max(0.0) / unit_s).ln_1p()
            }
        }
    }
}

/// Maximum share: a measurement without any white noise would make duplicate time stamps singular.
pub const SHARE_MAX: f64 = 0.995;

impl Noise {
    /// Independent measurements without a slow part.
    pub const WHITE: Noise = Noise {
        share: 0.0,
        memory: 1.0,
    };
}

/// Whitening filter of one specimen: gains depend on times only, so that they apply to every
/// column.
#[derive(Debug, Clone, Default)]
pub(super) struct Filter {
    decay: Vec<f64>,
    gain: Vec<f64>,
    inverse_std: Vec<f64>,
    /// Determinant ln |K| of the specimen's covariance over σ².
    pub(super) log_det: f64,
    /// Variance of the slow part after the last measurement, over σ².
    pub(super) state_variance: f64,
}

impl Filter {
    /// Computes the gains for increasing clock values and numbers of measurements per point
    /// `count`.
    pub(super) fn prepare(&mut self, clock: &[f64], count: &[f64], noise: Noise) {
        self.decay.clear();
        self.gain.clear();
        self.inverse_std.clear();
        self.log_det = 0.0;
        let mut variance = noise.share;
        let mut before = f64::NAN;
        for (&t, &count) in clock.iter().zip(count) {
            let decay = if before.is_nan() || noise.share == 0.0 {
                0.0
            } else {
                (-(t - before) / noise.memory).exp()
            };
            before = t;
            variance = decay * decay * variance + noise.share * (1.0 - decay * decay);
            let total = variance + (1.0 - noise.share) / count;
            let gain = variance / total;
            self.decay.push(decay);
            self.gain.push(gain);
            self.inverse_std.push(1.0 / total.sqrt());
            self.log_det += total.ln();
            variance *= 1.0 - gain;
        }
        self.state_variance = variance;
    }

    /// Whitens a column in place; returns the filter's state after the last measurement.
    pub(super) fn whiten(&self, column: &mut [f64]) -> f64 {
        let mut state = 0.0;
        for (index, value) in column.iter_mut().enumerate() {
            state *= self.decay[index];
            let innovation = *value - state;
            state += self.gain[index] * innovation;
            *value = innovation * self.inverse_std[index];
        }
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filter_matches_dense_covariance() {
        let time = [0.0, 1.0, 1.0, 4.0, 9.0];
        let count = [1.0, 2.0, 1.0, 1.0, 5.0];
        let noise = Noise {
            share: 0.6,
            memory: 3.0,
        };
        // Dense covariance and its Cholesky factor.
        let n = time.len();
        let mut l = vec![vec![0.0_f64; n]; n];
        for i in 0..n {
            for j in 0..n {
                let apart: f64 = time[i] - time[j];
                l[i][j] = noise.share * (-apart.abs() / noise.memory).exp();
                if i == j {
                    l[i][j] += (1.0 - noise.share) / count[i];
                }
            }
        }
        let mut log_det = 0.0;
        for j in 0..n {
            for k in 0..j {
                for i in j..n {
                    l[i][j] -= l[i][k] * l[j][k];
                }
            }
            let pivot = l[j][j].sqrt();
            log_det += 2.0 * pivot.ln();
            for i in j..n {
                l[i][j] /= pivot;
            }
        }
        let column = [1.0, -2.0, 0.5, 3.0, 1.0];
        let mut dense = column;
        for i in 0..n {
            for j in 0..i {
                dense[i] -= l[i][j] * dense[j];
            }
            dense[i] /= l[i][i];
        }
        let mut filter = Filter::default();
        filter.prepare(&time, &count, noise);
        let mut quick = column;
        filter.whiten(&mut quick);
        // Five steps of O(1) numbers: a few dozen rounding errors.
        for (a, b) in quick.iter().zip(&dense) {
            assert!((a - b).abs() < 1e-13, "{quick:?} {dense:?}");
        }
        assert!((filter.log_det - log_det).abs() < 1e-13);
    }
}
