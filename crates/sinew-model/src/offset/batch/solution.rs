//! Result of a descent.

use crate::cholesky::{self, Factor};
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use alloc::vec::Vec;

/// An estimate of the model's state, and the information its covariance is the inverse of.
#[derive(Clone)]
pub(super) struct Solution {
    /// Without its covariance.
    pub(super) estimate: MapEstimate,
    /// Lower triangle of the information matrix.
    pub(super) information: Vec<f64>,
    /// Cholesky factor of the information matrix.
    pub(super) factor: Factor,
}

impl Solution {
    /// Half the robust chi-square of data and prior.
    pub(super) fn cost(&self) -> f64 {
        self.estimate.convergence.cost
    }

    /// Standard deviation of entry `k`.
    pub(super) fn std(&self, k: usize) -> f64 {
        let total = self.estimate.state.len();
        let mut unit = alloc::vec![0.0; total];
        unit[k] = 1.0;
        self.factor.forward(&mut unit);
        libm::sqrt(cholesky::dot(&unit, &unit))
    }

    /// Size of entry `k` over its standard deviation.
    pub(super) fn significance(&self, k: usize) -> f64 {
        self.estimate.state[k].abs() / self.std(k)
    }

    /// The state on condition that its entries from `first` on are zero, without them: with
    /// information `I`, `x + I⁻¹ I_·c c` of the others.
    pub(super) fn state_without(&self, first: usize) -> Vec<f64> {
        let mut state = self.estimate.state.clone();
        let total = state.len();
        let gone = state.split_off(first);
        let mut step = alloc::vec![0.0; first];
        let rows = self.information.chunks_exact(total).skip(first);
        for (c, row) in gone.iter().zip(rows) {
            for (step, shared) in step.iter_mut().zip(row) {
                *step += c * shared;
            }
        }
        // Of the others' information the factor is the first rows of the whole's.
        self.factor.solve(&mut step);
        for (x, step) in state.iter_mut().zip(step) {
            *x += step;
        }
        state
    }
}

/// Returns the inverse of an information matrix, only the lower triangle of which is set.
pub(super) fn covariance(lower: &[f64], total: usize) -> Result<Vec<f64>, MapError> {
    cholesky::inverse(lower, total).map_err(MapError::Prior)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::estimate::Convergence;
    use crate::offset::fixtures::random;

    /// Compared with the same in terms of the covariance, `x − P_·c P_cc⁻¹ c`.
    #[test]
    fn state_without_changes_is_conditional_mean() {
        const TOTAL: usize = 9;
        const FIRST: usize = 6;
        const GONE: usize = TOTAL - FIRST;
        let mut seed = 5;
        let rows: Vec<f64> = (0..2 * TOTAL * TOTAL).map(|_| random(&mut seed)).collect();
        let mut information = alloc::vec![0.0; TOTAL * TOTAL];
        for row in rows.chunks_exact(TOTAL) {
            for (i, a) in row.iter().enumerate() {
                for (k, b) in row.iter().enumerate() {
                    information[i * TOTAL + k] += a * b;
                }
            }
        }
        let p = covariance(&information, TOTAL).unwrap();
        let factor = Factor::of(&information, TOTAL).unwrap();
        let state: Vec<f64> = (0..TOTAL).map(|_| random(&mut seed)).collect();
        let own = |i: usize| (0..GONE).map(move |k| (FIRST + i) * TOTAL + FIRST + k);
        let own: Vec<f64> = (0..GONE).flat_map(own).map(|at| p[at]).collect();
        let inverse = covariance(&own, GONE).unwrap();
        let expected = |i: usize| {
            let mut x = state[i];
            for k in 0..GONE {
                for j in 0..GONE {
                    x -= p[i * TOTAL + FIRST + k] * inverse[k * GONE + j] * state[FIRST + j];
                }
            }
            x
        };
        let solution = Solution {
            estimate: MapEstimate {
                changes: Vec::new(),
                state: state.clone(),
                covariance: Vec::new(),
                temperature_c: f64::NAN,
                end_s: 0.0,
                noise_rad: Vec::new(),
                motor_noise_nm: Vec::new(),
                tension_noise_nm: Vec::new(),
                weights: Vec::new(),
                convergence: Convergence::new(0, f64::INFINITY, 0.0),
                stiffness_changes: Vec::new(),
                creep: Vec::new(),
                force: None,
                posteriors: Vec::new(),
                encoder_slips: Vec::new(),
            },
            information,
            factor,
        };
        let without = solution.state_without(FIRST);
        assert_eq!(without.len(), FIRST);
        for (i, x) in without.iter().enumerate() {
            assert!((x - expected(i)).abs() < 1e-12, "{i}: {x} {}", expected(i));
        }
        assert!((0..FIRST).any(|i| (without[i] - state[i]).abs() > 0.01));
    }
}
