//! The few steps of linear algebra that the bound needs, row-major.

/// Adds `Hᵀ C⁻¹ H` to `information`; `rows` is `H`, `m × total`, `covariance` is `C`, `m × m`.
pub(super) fn add_information(
    covariance: &[f64],
    rows: &[f64],
    total: usize,
    information: &mut [f64],
) -> Option<()> {
    let m = rows.len() / total;
    let l = factor(covariance, m)?;
    // L⁻¹ H in place, row by row.
    let mut h = rows.to_vec();
    for i in 0..m {
        let (before, own) = h.split_at_mut(i * total);
        let own = &mut own[..total];
        for k in 0..i {
            let c = l[i * m + k];
            if c != 0.0 {
                for (x, y) in own.iter_mut().zip(&before[k * total..(k + 1) * total]) {
                    *x -= c * y;
                }
            }
        }
        for x in own.iter_mut() {
            *x /= l[i * m + i];
        }
    }
    for row in h.chunks_exact(total) {
        for (a, x) in row.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            for (to, y) in information[a * total..(a + 1) * total].iter_mut().zip(row) {
                *to += x * y;
            }
        }
    }
    Some(())
}

/// Diagonal of the inverse of a positive definite matrix.
pub(super) fn inverse_diagonal(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let l = factor(a, n)?;
    // Column k of L⁻¹; the inverse is L⁻ᵀ L⁻¹.
    let mut out = vec![0.0; n];
    let mut x = vec![0.0; n];
    for (k, out) in out.iter_mut().enumerate() {
        x.fill(0.0);
        for i in k..n {
            let sum: f64 = (k..i).map(|m| l[i * n + m] * x[m]).sum();
            let b = if i == k { 1.0 } else { 0.0 };
            x[i] = (b - sum) / l[i * n + i];
            *out += x[i] * x[i];
        }
    }
    Some(out)
}

/// Returns the lower Cholesky factor; `None` if the matrix is not positive definite.
fn factor(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..=i {
            let dot: f64 = l[i * n..i * n + k]
                .iter()
                .zip(&l[k * n..k * n + k])
                .map(|(a, b)| a * b)
                .sum();
            let sum = a[i * n + k] - dot;
            l[i * n + k] = if i != k {
                sum / l[k * n + k]
            } else if sum > 0.0 && sum.is_finite() {
                sum.sqrt()
            } else {
                return None;
            };
        }
    }
    Some(l)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn information_and_inverse_match_analytic_2x2() {
        // C = [[2, 1], [1, 2]], C⁻¹ = [[2, −1], [−1, 2]]/3; H = identity.
        let mut information = vec![0.0; 4];
        add_information(
            &[2.0, 1.0, 1.0, 2.0],
            &[1.0, 0.0, 0.0, 1.0],
            2,
            &mut information,
        )
        .unwrap();
        for (found, analytic) in information.iter().zip([2.0, -1.0, -1.0, 2.0]) {
            assert!((found - analytic / 3.0).abs() < 1e-15);
        }
        let diagonal = inverse_diagonal(&information, 2).unwrap();
        assert!(diagonal.iter().all(|x| (x - 2.0).abs() < 1e-14));
        assert!(inverse_diagonal(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
    }
}
