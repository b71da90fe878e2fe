//! One Kalman filter: a curve and a noise.

use super::gauss::above_zero;

/// Level, taken out, amplitude, temperature drift, slow error, error per error of the stiffness, the baseline's error,
/// what poorer sessions have beyond it.
pub const STATES: usize = 8;
/// Entries of the lower triangle of a covariance.
pub(super) const TRIANGLE: usize = STATES * (STATES + 1) / 2;
pub(super) const LEVEL: usize = 0;
pub(super) const TAKEN_OUT: usize = 1;
pub(super) const AMPLITUDE: usize = 2;
pub(super) const DRIFT: usize = 3;
pub(super) const SLOW: usize = 4;
pub(super) const STIFFNESS: usize = 5;
pub(super) const BASELINE: usize = 6;
pub(super) const EXCESS: usize = 7;

/// A Kalman filter for one curve and one noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Index of the curve.
    pub curve: u32,
    /// Index of the noise.
    pub noise: u32,
    /// Logarithm of its probability, up to a constant of the bank.
    pub log_weight: f64,
    /// Means: rad, rad, 1, rad/K, rad, rad, rad, rad.
    pub mean: [f64; STATES],
    /// Lower triangle of the covariance, row by row.
    pub covariance: [f64; TRIANGLE],
}

/// What a filter expects of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    /// Mean of what is recorded, rad.
    pub(super) mean: f64,
    /// Its variance without the record's own error, rad².
    pub(super) variance: f64,
    /// Its covariance with every state.
    pub(super) with_states: [f64; STATES],
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
    /// What it expects of a record that sees `h` of each state.
    pub(super) fn expect(&self, h: &[f64; STATES]) -> Expected {
        let mut with_states = [0.0; STATES];
        let mut at = 0;
        for i in 0..STATES {
            let mut sum = 0.0;
            for k in 0..i {
                let p = self.covariance[at + k];
                sum += p * h[k];
                with_states[k] += p * h[i];
            }
            with_states[i] += sum + self.covariance[at + i] * h[i];
            at += i + 1;
        }
        let (mut mean, mut variance) = (0.0, 0.0);
        for i in 0..STATES {
            mean += h[i] * self.mean[i];
            variance += h[i] * with_states[i];
        }
        Expected {
            mean,
            variance: variance.max(0.0),
            with_states,
        }
    }

    /// Kalman update by a record that is `error` off what was expected, with variance `s` in all. The weight is left
    /// to the caller, who knows the evidence already.
    pub(super) fn correct(&mut self, expected: &Expected, error: f64, s: f64) {
        let ph = &expected.with_states;
        let mut at = 0;
        for i in 0..STATES {
            let gain = ph[i] / s;
            self.mean[i] += gain * error;
            for k in 0..=i {
                self.covariance[at + k] -= gain * ph[k];
            }
            // Rounding must not make a variance negative.
            let own = &mut self.covariance[at + i];
            *own = own.max(0.0);
            at += i + 1;
        }
    }

    /// Adds to the variance of a state.
    pub(super) fn open(&mut self, state: usize, variance: f64) {
        self.covariance[entry(state, state)] += variance;
    }

    /// Multiplies a state by a factor.
    pub(super) fn scale(&mut self, state: usize, factor: f64) {
        self.mean[state] *= factor;
        for k in 0..STATES {
            let twice = if k == state { factor } else { 1.0 };
            self.covariance[entry(state, k)] *= factor * twice;
        }
    }

    /// Makes of a state `scale` times another one, which it may be itself, with no memory of what it was.
    pub(super) fn make(&mut self, state: usize, scale: f64, of: usize) {
        let variance = scale * scale * self.covariance[entry(of, of)];
        let with: [f64; STATES] = core::array::from_fn(|k| scale * self.covariance[entry(of, k)]);
        self.mean[state] = scale * self.mean[of];
        for k in 0..STATES {
            self.covariance[entry(state, k)] = with[k];
        }
        self.covariance[entry(state, state)] = variance;
    }

    /// Logarithm of the weight with `a > 0` reckoned in.
    pub(super) fn weight_above_zero(&self) -> f64 {
        let deviation = libm::sqrt(self.covariance[entry(AMPLITUDE, AMPLITUDE)]).max(1e-300);
        self.log_weight + libm::log(above_zero(self.mean[AMPLITUDE], deviation))
    }
}
