//! Cholesky factorisation of small dense symmetric matrices, row-major.

/// Factorises `A = L Lᵀ`, lower triangle to `l`; both `n × n`, row-major.
///
/// Returns the row at which `a` stops being positive definite (NaN included).
pub(crate) fn factorise(a: &[f64], l: &mut [f64], n: usize) -> Result<(), usize> {
    for i in 0..n {
        for k in 0..=i {
            let (row_i, row_k) = (&l[i * n..i * n + k], &l[k * n..k * n + k]);
            let dot: f64 = row_i.iter().zip(row_k).map(|(a, b)| a * b).sum();
            let sum = a[i * n + k] - dot;
            if i == k {
                if !(sum > 0.0 && sum.is_finite()) {
                    return Err(i);
                }
                l[i * n + i] = libm::sqrt(sum);
            } else {
                l[i * n + k] = sum / l[k * n + k];
            }
        }
    }
    Ok(())
}

/// Solves `L Lᵀ x = b` in place.
pub(crate) fn solve(l: &[f64], n: usize, x: &mut [f64]) {
    for i in 0..n {
        for k in 0..i {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= l[k * n + i] * x[k];
        }
        x[i] /= l[i * n + i];
    }
}
