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

/// Inverse of a symmetric positive definite matrix, scaled to unit diagonal first: the
/// parameters' units span fifteen orders of magnitude.
pub(crate) fn inverse(a: &[f64], n: usize) -> Result<alloc::vec::Vec<f64>, usize> {
    let mut scale = alloc::vec![0.0; n];
    for i in 0..n {
        let diagonal = a[i * n + i];
        if !(diagonal > 0.0 && diagonal.is_finite()) {
            return Err(i);
        }
        scale[i] = 1.0 / libm::sqrt(diagonal);
    }
    let mut scaled = alloc::vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            scaled[i * n + k] = a[i * n + k] * scale[i] * scale[k];
        }
    }
    let mut l = alloc::vec![0.0; n * n];
    factorise(&scaled, &mut l, n)?;
    let mut out = alloc::vec![0.0; n * n];
    let mut column = alloc::vec![0.0; n];
    for k in 0..n {
        column.fill(0.0);
        column[k] = 1.0;
        solve(&l, n, &mut column);
        for i in 0..n {
            out[i * n + k] = column[i] * scale[i] * scale[k];
        }
    }
    Ok(out)
}
