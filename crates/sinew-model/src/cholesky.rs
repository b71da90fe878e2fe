//! Cholesky factorisation of small dense symmetric matrices, row-major.

/// Factorises `A = L Lᵀ`, lower triangle to `l`; both `n × n`, row-major.
///
/// Returns the row at which `a` stops being positive definite (NaN included).
pub(crate) fn factorise(a: &[f64], l: &mut [f64], n: usize) -> Result<(), usize> {
    /// Rows at once: what is read of the rows above serves all of them.
    const FOUR: usize = 4;
    let mut from = 0;
    while from < n {
        let rows = FOUR.min(n - from);
        let (above, own) = l.split_at_mut(from * n);
        // The columns of the rows above, of four rows at once; of fewer they are done with their own.
        let mut open = 0;
        if let ([r0, r1, r2, r3], FOUR) = (rows_of(own, n), rows) {
            for (k, row) in above.chunks_exact(n).enumerate() {
                let known = &row[..k];
                let sums = dots(known, [&r0[..k], &r1[..k], &r2[..k], &r3[..k]]);
                for (i, (r, sum)) in [&mut *r0, r1, r2, r3].into_iter().zip(sums).enumerate() {
                    r[k] = (a[(from + i) * n + k] - sum) / row[k];
                }
            }
            open = from;
        }
        for i in from..from + rows {
            for k in open..=i {
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
        from += rows;
    }
    Ok(())
}

/// The first four rows of so many columns; empty ones where there are fewer.
fn rows_of(all: &mut [f64], n: usize) -> [&mut [f64]; 4] {
    let mut rows = all.chunks_exact_mut(n.max(1));
    core::array::from_fn(|_| rows.next().unwrap_or_default())
}

/// Scalar products of one with four.
fn dots(a: &[f64], [b0, b1, b2, b3]: [&[f64]; 4]) -> [f64; 4] {
    const LANES: usize = 2;
    let mut sums = [[0.0; LANES]; 4];
    let whole = a.len() / LANES * LANES;
    let parts = a.chunks_exact(LANES).zip(b0.chunks_exact(LANES));
    let parts = parts.zip(b1.chunks_exact(LANES));
    let parts = parts.zip(b2.chunks_exact(LANES).zip(b3.chunks_exact(LANES)));
    for (((a, b0), b1), (b2, b3)) in parts {
        for lane in 0..LANES {
            sums[0][lane] += a[lane] * b0[lane];
            sums[1][lane] += a[lane] * b1[lane];
            sums[2][lane] += a[lane] * b2[lane];
            sums[3][lane] += a[lane] * b3[lane];
        }
    }
    let mut out = sums.map(|s| s.iter().sum());
    for (sum, b) in out.iter_mut().zip([b0, b1, b2, b3]) {
        for k in whole..a.len() {
            *sum += a[k] * b[k];
        }
    }
    out
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
    backward(l, n, x);
}

/// Solves `Lᵀ x = b` in place.
pub(crate) fn backward(l: &[f64], n: usize, x: &mut [f64]) {
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
