//! Small linear least-squares problems with non-negative coefficients.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Relative norm of a column's remainder below which it is linearly dependent on the previous
/// columns.
const RANK_TOLERANCE: f64 = 1e-9;

/// Solution of `min ‖y − X β‖` with `β_j ≥ 0` for some j.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    /// Upper triangle of the factor of X, row by row, `p × p`.
    r: Vec<f64>,
    /// Unconstrained least-squares solution.
    pub(super) free: Vec<f64>,
    /// Constrained least-squares solution.
    pub(super) beta: Vec<f64>,
    /// Residual sum of squares with the constraints.
    pub(super) squares: f64,
    /// Σ ln r_jj² over linearly independent columns.
    pub(super) log_det: f64,
    pub(super) p: usize,
}

/// Orthogonalises columns (stored one after another, `n` each), in place.
///
/// Modified Gram–Schmidt, run twice: as accurate as Householder for this purpose.
fn factor(columns: &mut [f64], n: usize, p: usize) -> (Vec<f64>, f64) {
    let mut r = vec![0.0; p * p];
    let mut log_det = 0.0;
    for j in 0..p {
        let (done, rest) = columns.split_at_mut(j * n);
        let column = &mut rest[..n];
        let before = norm(column);
        for _ in 0..2 {
            for k in 0..j {
                if r[k * p + k] == 0.0 {
                    continue;
                }
                let other = &done[k * n..(k + 1) * n];
                let along = dot(other, column);
                r[k * p + j] += along;
                for (value, other) in column.iter_mut().zip(other) {
                    *value -= along * other;
                }
            }
        }
        let length = norm(column);
        if length > RANK_TOLERANCE * before && length.is_finite() {
            r[j * p + j] = length;
            log_det += 2.0 * length.ln();
            column.iter_mut().for_each(|value| *value /= length);
        }
    }
    (r, log_det)
}

/// Subtracts from `y` its components along an orthonormal basis and returns them; twice, as
/// [`factor`] does.
fn project(basis: &[f64], r: &[f64], p: usize, y: &mut [f64]) -> Vec<f64> {
    let n = y.len();
    let mut along = vec![0.0; p];
    for _ in 0..2 {
        for j in (0..p).filter(|j| r[j * p + j] != 0.0) {
            let column = &basis[j * n..(j + 1) * n];
            let part = dot(column, y);
            along[j] += part;
            for (value, other) in y.iter_mut().zip(column) {
                *value -= part * other;
            }
        }
    }
    along
}

/// Computes ln |XᵀX| over linearly independent columns.
pub(super) fn log_det(columns: &mut [f64], n: usize, p: usize) -> f64 {
    factor(columns, n, p).1
}

/// Solves the problem; `columns` become an orthonormal basis (a dependent column remains
/// unchanged), `y` the residuals.
pub(super) fn solve(columns: &mut [f64], y: &mut [f64], positive: &[bool]) -> Solution {
    let (n, p) = (y.len(), positive.len());
    let (r, log_det) = factor(columns, n, p);
    let along = project(columns, &r, p, y);
    let left = dot(y, y);
    let free = back(&r, &along, p);
    let mut solution = Solution {
        beta: free.clone(),
        squares: left,
        r,
        free,
        log_det,
        p,
    };
    let bound: Vec<usize> = (0..p).filter(|&j| positive[j]).collect();
    if bound.iter().all(|&j| solution.free[j] >= 0.0) {
        return solution;
    }
    // Few columns are constrained: the optimum is the best of the feasible solutions with some of
    // them at zero.
    let mut best = f64::INFINITY;
    for set in 1..1_u32 << bound.len() {
        let zero: Vec<bool> = (0..p)
            .map(|j| {
                bound
                    .iter()
                    .position(|&b| b == j)
                    .is_some_and(|bit| set >> bit & 1 == 1)
            })
            .collect();
        let (beta, more) = solution.without(&along, &zero);
        if more < best && bound.iter().all(|&j| beta[j] >= 0.0) {
            best = more;
            solution.beta = beta;
        }
    }
    solution.squares = left + best;
    for j in 0..p {
        if solution.r[j * p + j] == 0.0 {
            continue;
        }
        let explained: f64 = (j..p)
            .map(|k| solution.r[j * p + k] * solution.beta[k])
            .sum();
        let missing = along[j] - explained;
        for (value, other) in y.iter_mut().zip(&columns[j * n..(j + 1) * n]) {
            *value += missing * other;
        }
    }
    solution
}

impl Solution {
    /// Least-squares solution of `along ≈ R β` with some β at zero, and its residual squares.
    fn without(&self, along: &[f64], zero: &[bool]) -> (Vec<f64>, f64) {
        let p = self.p;
        let kept: Vec<usize> = (0..p).filter(|&j| !zero[j]).collect();
        let mut columns: Vec<f64> = kept
            .iter()
            .flat_map(|&j| (0..p).map(move |i| (i, j)))
            .map(|(i, j)| self.r[i * p + j])
            .collect();
        let (r, _) = factor(&mut columns, p, kept.len());
        let mut left = along.to_vec();
        let part = project(&columns, &r, kept.len(), &mut left);
        let small = back(&r, &part, kept.len());
        let mut beta = vec![0.0; p];
        for (&j, value) in kept.iter().zip(small) {
            beta[j] = value;
        }
        (beta, dot(&left, &left))
    }

    /// Draws β from the normal distribution around the free solution, truncated to `β_j ≥ 0`.
    pub(super) fn draw(&self, sigma: f64, positive: &[bool], random: &mut impl Rng) -> Vec<f64> {
        /// Maximum number of rejection draws before coordinate-wise sampling.
        const MAX_ATTEMPTS: usize = 20;
        /// Number of sweeps after which a coordinate sampler is independent of its start for few
        /// columns.
        const SWEEPS: usize = 25;
        let p = self.p;
        for _ in 0..MAX_ATTEMPTS {
            let z: Vec<f64> = (0..p).map(|_| sigma * sample_normal(random)).collect();
            let step = back(&self.r, &z, p);
            let beta: Vec<f64> = self.free.iter().zip(&step).map(|(f, s)| f + s).collect();
            if (0..p).all(|j| !positive[j] || beta[j] >= 0.0) {
                return beta;
            }
        }
        // Coordinates in turn, each from its truncated normal distribution.
        let mut beta = self.beta.clone();
        let mut shift: Vec<f64> = beta.iter().zip(&self.free).map(|(b, f)| b - f).collect();
        for _ in 0..SWEEPS {
            for j in 0..p {
                // Precision row j of RᵀR.
                let (mut own, mut cross) = (0.0, 0.0);
                for k in 0..p {
                    let mut entry = 0.0;
                    for i in 0..=j.min(k) {
                        entry += self.r[i * p + j] * self.r[i * p + k];
                    }
                    if k == j {
                        own = entry;
                    } else {
                        cross += entry * shift[k];
                    }
                }
                if own <= 0.0 {
                    continue;
                }
                let (centre, std) = (-cross / own, sigma / own.sqrt());
                shift[j] = if positive[j] {
                    centre + std * above((-self.free[j] - centre) / std, random)
                } else {
                    centre + std * sample_normal(random)
                };
                beta[j] = self.free[j] + shift[j];
                if positive[j] {
                    beta[j] = beta[j].max(0.0);
                }
            }
        }
        beta
    }
}

fn sample_normal(random: &mut impl Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Draws a standard normal number above `low` (Robert, Statistics and Computing 5, 1995).
fn above(low: f64, random: &mut impl Rng) -> f64 {
    /// Maximum number of attempts: the tail's rejection accepts at least three quarters of them.
    const MAX_ATTEMPTS: usize = 1000;
    if low < 0.5 {
        for _ in 0..MAX_ATTEMPTS {
            let z = sample_normal(random);
            if z >= low {
                return z;
            }
        }
    }
    let low = low.max(0.0);
    let rate = 0.5 * (low + (low * low + 4.0).sqrt());
    for _ in 0..MAX_ATTEMPTS {
        let exponential: f64 = rand_distr::Exp1.sample(random);
        let z = low + exponential / rate;
        let keep: f64 = rand_distr::Exp1.sample(random);
        if keep >= 0.5 * (z - rate) * (z - rate) {
            return z;
        }
    }
    low
}

/// Solves the upper triangle; a dependent column gets zero.
fn back(r: &[f64], along: &[f64], p: usize) -> Vec<f64> {
    let mut beta = vec![0.0; p];
    for j in (0..p).rev() {
        if r[j * p + j] == 0.0 {
            continue;
        }
        let mut value = along[j];
        for k in j + 1..p {
            value -= r[j * p + k] * beta[k];
        }
        beta[j] = value / r[j * p + j];
    }
    beta
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn constrained_coefficient_stops_at_zero() {
        // y decreases; a column that may only increase is excluded, the constant is the mean.
        let mut x = vec![1.0, 1.0, 1.0, 0.0, 1.0, 2.0];
        let mut y = vec![3.0, 2.0, 1.0];
        let s = solve(&mut x, &mut y, &[false, true]);
        assert!((s.free[1] + 1.0).abs() < 1e-14);
        assert!((s.beta[0] - 2.0).abs() < 1e-14 && s.beta[1] == 0.0);
        assert!((s.squares - 2.0).abs() < 1e-13);
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for _ in 0..100 {
            assert!(s.draw(0.1, &[false, true], &mut random)[1] >= 0.0);
        }
    }

    #[test]
    fn truncated_normal_has_mean_of_tail() {
        // Mean above 2: φ(2)/Q(2) = 2.373; the mean of 20 000 draws has error 0.0025.
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mean = (0..20_000).map(|_| above(2.0, &mut random)).sum::<f64>() / 20_000.0;
        assert!((mean - 2.373).abs() < 0.01, "{mean}");
    }
}
