//! Kalman filter for one curve and one noise.

use super::gauss::{LogSum, above_zero};
use sinew_model::Gaussian;

/// Number of states: level, amplitude, temperature drift, slow error, baseline error, removed offset,
/// amplitude of the additional creep since the last re-tensioning, additional baseline error of less
/// accurate sessions, offset error per stiffness error.
///
/// The states that a tendon acquires with its events come last: until then they are neither observed
/// nor correlated with the others, and the arithmetic of the filters skips them (`live` states are the others).
pub const STATES: usize = 9;
/// Number of entries of the lower triangle of a covariance.
pub(super) const TRIANGLE: usize = STATES * (STATES + 1) / 2;
pub(super) const LEVEL: usize = 0;
pub(super) const AMPLITUDE: usize = 1;
pub(super) const DRIFT: usize = 2;
pub(super) const SLOW: usize = 3;
pub(super) const BASELINE: usize = 4;
pub(super) const TAKEN_OUT: usize = 5;
pub(super) const RETENSIONED: usize = 6;
pub(super) const EXCESS: usize = 7;
pub(super) const STIFFNESS: usize = 8;
/// Number of live states before the first event.
pub(super) const LIVE_AT_START: usize = BASELINE + 1;
/// Number of live states after a new baseline or a re-tensioning.
pub(super) const LIVE_TENSIONED: usize = RETENSIONED + 1;

/// A Kalman filter for one curve and one noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Index of the curve.
    pub curve: u32,
    /// Index of the noise.
    pub noise: u32,
    /// Logarithm of the filter's probability, up to a constant of the bank.
    pub log_weight: f64,
    /// Means of the states: rad, 1, rad/K, rad, rad, rad, 1, rad, rad.
    pub mean: [f64; STATES],
    /// Lower triangle of the covariance, row by row.
    pub covariance: [f64; TRIANGLE],
}

/// Prediction of a filter for a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    /// Mean of the recorded value, rad.
    pub(super) mean: f64,
    /// Variance without the record's independent error, rad².
    pub(super) variance: f64,
    /// Covariance with every state.
    pub(super) with_states: [f64; STATES],
}

/// Index of the entry `(i, k)` in the triangle.
#[inline]
pub(super) const fn entry(i: usize, k: usize) -> usize {
    if i >= k {
        i * (i + 1) / 2 + k
    } else {
        k * (k + 1) / 2 + i
    }
}

impl Component {
    /// Predicts a record with observation vector `h` from the `live` states.
    pub(super) fn expect(&self, h: &[f64; STATES], live: usize) -> Expected {
        if live <= LIVE_AT_START {
            self.expect_of::<LIVE_AT_START>(h)
        } else if live <= LIVE_TENSIONED {
            self.expect_of::<LIVE_TENSIONED>(h)
        } else {
            self.expect_of::<STATES>(h)
        }
    }

    fn expect_of<const N: usize>(&self, h: &[f64; STATES]) -> Expected {
        let mut with_states = [0.0; STATES];
        let mut at = 0;
        for i in 0..N {
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
        for i in 0..N {
            mean += h[i] * self.mean[i];
            variance += h[i] * with_states[i];
        }
        Expected {
            mean,
            variance: variance.max(0.0),
            with_states,
        }
    }

    /// Kalman update of the `live` states with innovation `error` and its variance `s`. The weight is
    /// left unchanged, because the caller has the evidence already.
    pub(super) fn correct(&mut self, expected: &Expected, error: f64, s: f64, live: usize) {
        if live <= LIVE_AT_START {
            self.correct_of::<LIVE_AT_START>(expected, error, s)
        } else if live <= LIVE_TENSIONED {
            self.correct_of::<LIVE_TENSIONED>(expected, error, s)
        } else {
            self.correct_of::<STATES>(expected, error, s)
        }
    }

    fn correct_of<const N: usize>(&mut self, expected: &Expected, error: f64, s: f64) {
        let ph = &expected.with_states;
        let mut at = 0;
        for i in 0..N {
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

    /// Inflates the variance of a state.
    pub(super) fn open(&mut self, state: usize, variance: f64) {
        self.covariance[entry(state, state)] += variance;
    }

    /// Advances the level by `step` times one of the `live` states.
    pub(super) fn shear(&mut self, state: usize, step: f64, live: usize) {
        self.mean[LEVEL] += self.mean[state] * step;
        let p = &mut self.covariance;
        p[entry(LEVEL, LEVEL)] +=
            step * (2.0 * p[entry(state, LEVEL)] + step * p[entry(state, state)]);
        for k in AMPLITUDE..live {
            p[entry(LEVEL, k)] += step * p[entry(state, k)];
        }
    }

    /// Adds the walk of an amplitude, of this variance, while the level advances by `step` times it.
    pub(super) fn walk(&mut self, amplitude: usize, variance: f64, step: f64) {
        let p = &mut self.covariance;
        p[entry(amplitude, amplitude)] += variance;
        p[entry(amplitude, LEVEL)] += 0.5 * variance * step;
        p[entry(LEVEL, LEVEL)] += variance * step * step / 3.0;
    }

    /// Sets a state to `factor` times another one; the factor is independent of all states.
    pub(super) fn make_random(&mut self, state: usize, factor: Gaussian, of: usize) {
        let mean = self.mean[of];
        let variance = self.covariance[entry(of, of)];
        self.make(state, factor.mean, of);
        self.open(state, factor.std * factor.std * (variance + mean * mean));
    }

    /// Multiplies a state by a factor.
    pub(super) fn scale(&mut self, state: usize, factor: f64) {
        self.mean[state] *= factor;
        for k in 0..STATES {
            let twice = if k == state { factor } else { 1.0 };
            self.covariance[entry(state, k)] *= factor * twice;
        }
    }

    /// Sets a state to `scale` times another one, which may be the same, and discards its former
    /// value.
    pub(super) fn make(&mut self, state: usize, scale: f64, of: usize) {
        let variance = scale * scale * self.covariance[entry(of, of)];
        let with: [f64; STATES] = core::array::from_fn(|k| scale * self.covariance[entry(of, k)]);
        self.mean[state] = scale * self.mean[of];
        for k in 0..STATES {
            self.covariance[entry(state, k)] = with[k];
        }
        self.covariance[entry(state, state)] = variance;
    }

    /// Merges both into the normal distribution with their common mean and covariance:
    ///
    /// ```text
    /// m = Σ w m_i    P = Σ w (P_i + (m_i − m)(m_i − m)ᵀ)
    /// ```
    pub(super) fn merge(&mut self, other: &Self) {
        let log_weight = {
            let mut sum = LogSum::new();
            sum.add(self.log_weight);
            sum.add(other.log_weight);
            sum.value()
        };
        let share = libm::exp(other.log_weight - log_weight);
        let apart: [f64; STATES] = core::array::from_fn(|i| other.mean[i] - self.mean[i]);
        let mut at = 0;
        for i in 0..STATES {
            for k in 0..=i {
                let (own, its) = (self.covariance[at + k], other.covariance[at + k]);
                self.covariance[at + k] =
                    own + share * (its - own) + share * (1.0 - share) * apart[i] * apart[k];
            }
            at += i + 1;
        }
        for (mean, apart) in self.mean.iter_mut().zip(apart) {
            *mean += share * apart;
        }
        self.log_weight = log_weight;
    }

    /// Logarithm of the weight including the probability of `a > 0`.
    pub(super) fn weight_above_zero(&self) -> f64 {
        let std = libm::sqrt(self.covariance[entry(AMPLITUDE, AMPLITUDE)]).max(1e-300);
        self.log_weight + libm::log(above_zero(self.mean[AMPLITUDE], std))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merge_preserves_moments() {
        let of = |share: f64, level: f64, drift: f64, variance: f64| {
            let mut covariance = [0.0; TRIANGLE];
            covariance[entry(LEVEL, LEVEL)] = variance;
            covariance[entry(DRIFT, LEVEL)] = 0.1 * variance;
            covariance[entry(DRIFT, DRIFT)] = variance;
            let mut mean = [0.0; STATES];
            (mean[LEVEL], mean[DRIFT]) = (level, drift);
            Component {
                curve: 3,
                noise: 2,
                log_weight: libm::log(share),
                mean,
                covariance,
            }
        };
        // A quarter and three quarters of 1 and 5, of 2 and 0: 4 and 0.5.
        let mut both = of(0.25, 1.0, 2.0, 1.0);
        both.merge(&of(0.75, 5.0, 0.0, 2.0));
        let p = |i: usize, k: usize| both.covariance[entry(i, k)];
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        near(both.log_weight, 0.0);
        near(both.mean[LEVEL], 4.0);
        near(both.mean[DRIFT], 0.5);
        // Σ w (P + d dᵀ): 1.75 + (9/4 + 3/4), 1.75 + (2.25/4 + 0.25 · 3/4), 0.175 + (−3 · 1.5/4 − 1 · 0.5 · 3/4).
        near(p(LEVEL, LEVEL), 4.75);
        near(p(DRIFT, DRIFT), 2.5);
        near(p(LEVEL, DRIFT), -1.325);
    }
}
