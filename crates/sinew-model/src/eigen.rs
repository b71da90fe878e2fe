//! Eigenvalues of small symmetric matrices.

use alloc::vec::Vec;

/// Largest number of sweeps. Convergence is quadratic; matrices of 50 rows take about 8.
const MAX_SWEEPS: usize = 60;

/// Eigenvalues of a symmetric matrix `a`, row-major `n × n`, and the eigenvectors as rows of the second result, in the
/// same order.
///
/// # Source
/// Cyclic Jacobi rotations: G. H. Golub and C. F. Van Loan, *Matrix Computations*, section 8.5.
pub(crate) fn symmetric(mut a: Vec<f64>, n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut v = alloc::vec![0.0; n * n];
    v.iter_mut().step_by(n + 1).for_each(|x| *x = 1.0);
    // Smaller off-diagonal entries change an eigenvalue by less than the rounding error of the largest.
    let trace: f64 = a.iter().step_by(n + 1).sum();
    let negligible = f64::EPSILON * trace.abs();
    for _ in 0..MAX_SWEEPS {
        let mut is_diagonal = true;
        for p in 0..n {
            for q in p + 1..n {
                let off = a[p * n + q];
                if off.abs() <= negligible {
                    continue;
                }
                is_diagonal = false;
                let ratio = (a[q * n + q] - a[p * n + p]) / (2.0 * off);
                let t = 1.0_f64.copysign(ratio) / (ratio.abs() + libm::hypot(ratio, 1.0));
                let c = 1.0 / libm::hypot(t, 1.0);
                let s = t * c;
                for k in 0..n {
                    let (x, y) = (a[k * n + p], a[k * n + q]);
                    (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
                }
                for k in 0..n {
                    let (x, y) = (a[p * n + k], a[q * n + k]);
                    (a[p * n + k], a[q * n + k]) = (c * x - s * y, s * x + c * y);
                    let (x, y) = (v[p * n + k], v[q * n + k]);
                    (v[p * n + k], v[q * n + k]) = (c * x - s * y, s * x + c * y);
                }
            }
        }
        if is_diagonal {
            break;
        }
    }
    (a.into_iter().step_by(n + 1).collect(), v)
}
