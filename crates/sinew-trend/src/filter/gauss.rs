//! Logarithms of densities and of their sums.

const LN_TWO_PI: f64 = 1.837_877_066_409_345_5;

/// Logarithm of the density of an error of mean 0.
pub(super) fn log_normal(error: f64, variance: f64) -> f64 {
    -0.5 * (LN_TWO_PI + libm::log(variance) + error * error / variance)
}

/// Probability that a normal number is above 0; at least 1e-300.
pub(super) fn above_zero(mean: f64, std: f64) -> f64 {
    (0.5 * libm::erfc(-mean / (std * core::f64::consts::SQRT_2))).max(1e-300)
}

/// `ln Σ exp`, without overflow.
#[derive(Debug, Clone, Copy)]
pub(super) struct LogSum {
    most: f64,
    sum: f64,
}

impl LogSum {
    pub(super) fn new() -> Self {
        Self {
            most: f64::NEG_INFINITY,
            sum: 0.0,
        }
    }

    pub(super) fn add(&mut self, log: f64) {
        if !log.is_finite() {
            return;
        }
        if log > self.most {
            self.sum = self.sum * libm::exp(self.most - log) + 1.0;
            self.most = log;
        } else {
            self.sum += libm::exp(log - self.most);
        }
    }

    pub(super) fn value(self) -> f64 {
        self.most + libm::log(self.sum)
    }
}
