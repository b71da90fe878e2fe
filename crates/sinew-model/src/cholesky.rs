//! Cholesky factorisation of small dense symmetric matrices, row-major.

/// Factorises `A = L Lᵀ`, lower triangle to `l`; both `n × n`, row-major.
///
/// Returns the row at which `a` stops being positive definite (NaN included).
pub(crate) fn factorise(a: &[f64], l: &mut [f64], n: usize) -> Result<(), usize> {
    for i in 0..n {
        for k in 0..=i {
            let sum = a[i * n + k] - dot(&l[i * n..i * n + k], &l[k * n..k * n + k]);
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

/// Scalar product in four partial sums, which a processor adds side by side.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4
        .remainder()
        .iter()
        .zip(b4.remainder())
        .map(|(a, b)| a * b)
        .sum();
    for (a, b) in a4.zip(b4) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let [s0, s1, s2, s3] = sums;
    (s0 + s1) + (s2 + s3) + rest
}

/// Solves `L x = b` in place.
pub(crate) fn forward(l: &[f64], n: usize, x: &mut [f64]) {
    // Until the first entry that isn't zero nothing happens.
    let from = x.iter().position(|x| *x != 0.0).unwrap_or(n);
    for i in from..n {
        let (known, rest) = x.split_at_mut(i);
        let row = &l[i * n + from..i * n + i];
        rest[0] = (rest[0] - dot(row, &known[from..])) / l[i * n + i];
    }
}

/// Solves `L Lᵀ x = b` in place.
pub(crate) fn solve(l: &[f64], n: usize, x: &mut [f64]) {
    forward(l, n, x);
    for i in (0..n).rev() {
        let (open, known) = x.split_at_mut(i);
        known[0] /= l[i * n + i];
        for (x, l) in open.iter_mut().zip(&l[i * n..i * n + i]) {
            *x -= l * known[0];
        }
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
    // L⁻¹ row by row, then A⁻¹ = L⁻ᵀ L⁻¹, its lower half, by rows of L⁻¹.
    let mut inverse = alloc::vec![0.0; n * n];
    for i in 0..n {
        let (above, own) = inverse.split_at_mut(i * n);
        let own = &mut own[..=i];
        own[i] = 1.0;
        for (k, row) in above.chunks_exact(n).enumerate() {
            let factor = l[i * n + k];
            for (x, above) in own.iter_mut().zip(&row[..=k]) {
                *x -= factor * above;
            }
        }
        for x in own {
            *x /= l[i * n + i];
        }
    }
    let mut out = alloc::vec![0.0; n * n];
    for (k, row) in inverse.chunks_exact(n).enumerate() {
        for i in 0..=k {
            let factor = row[i];
            for (x, row) in out[i * n..=i * n + i].iter_mut().zip(row) {
                *x += factor * row;
            }
        }
    }
    for i in 0..n {
        for k in 0..=i {
            out[i * n + k] *= scale[i] * scale[k];
            out[k * n + i] = out[i * n + k];
        }
    }
    Ok(out)
}
