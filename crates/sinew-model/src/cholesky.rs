//! Cholesky factorisation of small dense symmetric matrices, row-major.

use crate::tile::{TILE, Tile, products};
use alloc::vec::Vec;

/// Factorises `A = L Lᵀ`, lower triangle to `l`; both `n × n`, row-major.
///
/// Returns the row at which `a` stops being positive definite (NaN included).
pub fn factorise(a: &[f64], l: &mut [f64], n: usize) -> Result<(), usize> {
    for i in 0..n {
        for k in 0..=i {
            let sum = a[i * n + k] - dot(&l[i * n..i * n + k], &l[k * n..k * n + k]);
            if i == k {
                l[i * n + i] = root(sum).ok_or(i)?;
            } else {
                l[i * n + k] = sum / l[k * n + k];
            }
        }
    }
    Ok(())
}

/// Returns the square root of a pivot; `None` if there is no factor.
fn root(pivot: f64) -> Option<f64> {
    (pivot > 0.0 && pivot.is_finite()).then(|| libm::sqrt(pivot))
}

/// Factorises a covariance that may be singular, `A = L Lᵀ`, lower triangle to `l`; both `n × n`,
/// row-major. Sums run one term after the other.
///
/// * `pivot`: square root of the remaining diagonal entry, or `None` if the matrix is not a covariance. Below a pivot
///   of 0 the factor is 0.
///
/// Returns the row of the invalid `pivot`.
pub fn factorise_singular(
    a: &[f64],
    l: &mut [f64],
    n: usize,
    pivot: impl Fn(f64) -> Option<f64>,
) -> Result<(), usize> {
    for i in 0..n {
        for k in 0..=i {
            let sum: f64 = (0..k).map(|m| l[i * n + m] * l[k * n + m]).sum();
            let left = a[i * n + k] - sum;
            l[i * n + k] = if i == k {
                pivot(left).ok_or(i)?
            } else if l[k * n + k] > 0.0 {
                left / l[k * n + k]
            } else {
                0.0
            };
        }
    }
    Ok(())
}

/// A Cholesky factor by tiles: for large matrices.
#[derive(Debug, Clone)]
pub struct Factor {
    n: usize,
    /// Columns of four rows together, up to a multiple of four; then the next four.
    width: usize,
    rows: Vec<[f64; TILE]>,
    /// Inverses of the tiles on the diagonal, by columns.
    inverses: Vec<Tile>,
}

impl Factor {
    /// Room for the factor of a matrix `n × n`; allocates here only.
    pub fn new(n: usize) -> Self {
        let width = n.next_multiple_of(TILE);
        Self {
            n,
            width,
            rows: alloc::vec![[0.0; TILE]; width / TILE * width],
            inverses: alloc::vec![[[0.0; TILE]; TILE]; width / TILE],
        }
    }

    /// Computes the factor of `a`, row-major, of which only the lower triangle is read.
    ///
    /// Returns the row at which `a` stops being positive definite (NaN included).
    pub fn of(a: &[f64], n: usize) -> Result<Self, usize> {
        let mut factor = Self::new(n);
        factor.factorise(a)?;
        Ok(factor)
    }

    /// [`Factor::of`] in place.
    pub fn factorise(&mut self, a: &[f64]) -> Result<(), usize> {
        let n = self.n;
        for from in (0..n).step_by(TILE) {
            let mut below = self.rows.chunks_exact_mut(self.width).skip(from / TILE);
            let Some(own) = below.next() else { break };
            // The tile on the diagonal. Beyond the last row the factor is that of one.
            let (known, open) = own.split_at_mut(from);
            let sums = products(known, known);
            for k in 0..TILE {
                for i in k..TILE {
                    let row = from + i;
                    let mut sum = match a.get(row * n + from + k) {
                        Some(x) if row < n => x - sums[i][k],
                        _ if i == k => 1.0,
                        _ => 0.0,
                    };
                    for j in 0..k {
                        sum -= open[j][i] * open[j][k];
                    }
                    open[k][i] = if i == k {
                        root(sum).ok_or(row)?
                    } else {
                        sum / open[k][k]
                    };
                }
            }
            // Those below it.
            let inverse = &mut self.inverses[from / TILE];
            *inverse = lower_inverse(&open[..TILE]);
            for (tile, rows) in below.enumerate() {
                let first = from + TILE * (tile + 1);
                let sums = products(&rows[..from], known);
                let mut left = [[0.0; TILE]; TILE];
                for (i, row) in a.chunks_exact(n).skip(first).take(TILE).enumerate() {
                    for (k, x) in row[from..].iter().take(TILE).enumerate() {
                        left[k][i] = x - sums[i][k];
                    }
                }
                // Times the inverse transposed.
                for (k, to) in rows[from..from + TILE].iter_mut().enumerate() {
                    *to = [0.0; TILE];
                    for j in 0..=k {
                        for (to, left) in to.iter_mut().zip(left[j]) {
                            *to += inverse[j][k] * left;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Number of rows of `A`.
    pub fn dimension(&self) -> usize {
        self.n
    }

    /// Logarithm of the determinant of `A`.
    pub fn ln_determinant(&self) -> f64 {
        // Rows beyond the last one are those of the identity.
        let inverses = self.inverses.iter();
        let diagonal = inverses.flat_map(|tile| (0..TILE).map(move |i| tile[i][i]));
        -2.0 * diagonal.map(libm::log).sum::<f64>()
    }

    /// Solves `L x = b` in place; of a shorter `x` with the first rows of `L`.
    pub fn forward(&self, x: &mut [f64]) {
        // Leading zeros need no computation.
        let Some(first) = x.iter().position(|x| *x != 0.0) else {
            return;
        };
        let first = first / TILE * TILE;
        let tiles = self.rows.chunks_exact(self.width).enumerate();
        for (tile, rows) in tiles.skip(first / TILE) {
            let from = tile * TILE;
            if from >= x.len() {
                break;
            }
            let (known, open) = x.split_at_mut(from);
            let mut sums = [[0.0; TILE]; TILE];
            let columns = rows[first..from].chunks_exact(TILE);
            for (columns, x) in columns.zip(known[first..].chunks_exact(TILE)) {
                for j in 0..TILE {
                    for i in 0..TILE {
                        sums[j][i] += columns[j][i] * x[j];
                    }
                }
            }
            let [s0, s1, s2, s3] = sums;
            let mut left = [0.0; TILE];
            for (i, (left, x)) in left.iter_mut().zip(open.iter()).enumerate() {
                *left = x - ((s0[i] + s1[i]) + (s2[i] + s3[i]));
            }
            let [c0, c1, c2, c3] = self.inverses[tile];
            for (i, x) in open.iter_mut().take(TILE).enumerate() {
                *x = (c0[i] * left[0] + c1[i] * left[1]) + (c2[i] * left[2] + c3[i] * left[3]);
            }
        }
    }

    /// Solves `Lᵀ x = b` in place; of a shorter `x` with the first rows of `L`.
    pub fn backward(&self, x: &mut [f64]) {
        let tiles = x.len().div_ceil(TILE);
        let rows = self.rows.chunks_exact(self.width).enumerate().take(tiles);
        for (tile, rows) in rows.rev() {
            let from = tile * TILE;
            let (open, own) = x.split_at_mut(from);
            let (mut left, mut known) = ([0.0; TILE], [0.0; TILE]);
            for (left, x) in left.iter_mut().zip(own.iter()) {
                *left = *x;
            }
            let columns = self.inverses[tile].iter().zip(&mut known);
            for (x, (column, known)) in own.iter_mut().zip(columns) {
                let [p0, p1, p2, p3] = core::array::from_fn(|i| column[i] * left[i]);
                *x = (p0 + p1) + (p2 + p3);
                *known = *x;
            }
            for (x, column) in open.iter_mut().zip(rows) {
                let [p0, p1, p2, p3] = core::array::from_fn(|i| column[i] * known[i]);
                *x -= (p0 + p1) + (p2 + p3);
            }
        }
    }

    /// Solves `L Lᵀ x = b` in place; of a shorter `x` with the first rows of `L`.
    pub fn solve(&self, x: &mut [f64]) {
        self.forward(x);
        self.backward(x);
    }
}

/// Inverse of a lower triangle, both by columns.
fn lower_inverse(columns: &[[f64; TILE]]) -> Tile {
    let mut inverse = [[0.0; TILE]; TILE];
    for (k, to) in inverse.iter_mut().enumerate() {
        for i in k..TILE {
            let mut sum = if i == k { 1.0 } else { 0.0 };
            for j in k..i {
                sum -= columns[j][i] * to[j];
            }
            to[i] = sum / columns[i][i];
        }
    }
    inverse
}

/// Scalar product in four partial sums, which a processor adds side by side.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
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
pub fn forward(l: &[f64], n: usize, x: &mut [f64]) {
    // Leading zeros need no computation.
    let from = x.iter().position(|x| *x != 0.0).unwrap_or(n);
    for i in from..n {
        let (known, rest) = x.split_at_mut(i);
        let row = &l[i * n + from..i * n + i];
        rest[0] = (rest[0] - dot(row, &known[from..])) / l[i * n + i];
    }
}

/// Solves `L Lᵀ x = b` in place.
pub fn solve(l: &[f64], n: usize, x: &mut [f64]) {
    forward(l, n, x);
    backward(l, n, x);
}

/// Solves `Lᵀ x = b` in place.
pub fn backward(l: &[f64], n: usize, x: &mut [f64]) {
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
pub fn inverse(a: &[f64], n: usize) -> Result<Vec<f64>, usize> {
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
    let factor = Factor::of(&scaled, n)?;
    // Columns of L⁻¹, each from its first entry that is not zero; A⁻¹ = L⁻ᵀ L⁻¹ is their products.
    let mut columns = alloc::vec![0.0; n * n];
    for (i, column) in columns.chunks_exact_mut(n.max(1)).enumerate() {
        column[i] = 1.0;
        factor.forward(column);
    }
    let mut out = scaled;
    for (i, own) in columns.chunks_exact(n.max(1)).enumerate() {
        for (k, other) in columns.chunks_exact(n.max(1)).enumerate().take(i + 1) {
            out[i * n + k] = dot(&own[i..], &other[i..]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::random;

    /// Returns `A = B Bᵀ + 1/10` with random entries of `B`.
    fn positive_definite(n: usize, seed: &mut u64) -> Vec<f64> {
        let b: Vec<f64> = (0..n * n).map(|_| random(seed)).collect();
        let mut a = alloc::vec![0.0; n * n];
        for i in 0..n {
            for k in 0..n {
                a[i * n + k] = dot(&b[i * n..(i + 1) * n], &b[k * n..(k + 1) * n]);
            }
            a[i * n + i] += 0.1;
        }
        a
    }

    fn times(a: &[f64], x: &[f64]) -> Vec<f64> {
        a.chunks_exact(x.len()).map(|row| dot(row, x)).collect()
    }

    #[test]
    fn by_tiles_it_solves_as_row_by_row() {
        let mut seed = 11;
        for n in [1, 2, 3, 4, 5, 8, 13, 31] {
            let a = positive_definite(n, &mut seed);
            let mut lower = a.clone();
            for i in 0..n {
                lower[i * n + i + 1..(i + 1) * n].fill(f64::NAN);
            }
            let mut factor = Factor::of(&lower, n).unwrap();
            // Nothing of a matrix before is left over.
            factor.factorise(&positive_definite(n, &mut seed)).unwrap();
            factor.factorise(&lower).unwrap();
            let mut l = alloc::vec![0.0; n * n];
            factorise(&a, &mut l, n).unwrap();
            for zeros in [0, n / 2, n - 1] {
                let mut x: Vec<f64> = (0..n).map(|_| random(&mut seed)).collect();
                x[..zeros].fill(0.0);
                let (mut is, mut should) = (x.clone(), x.clone());
                factor.forward(&mut is);
                forward(&l, n, &mut should);
                for (is, should) in is.iter().zip(&should) {
                    assert!((is - should).abs() < 1e-9, "{n}: {is} {should}");
                }
                let mut is = x.clone();
                factor.solve(&mut is);
                for (is, should) in times(&a, &is).iter().zip(&x) {
                    assert!((is - should).abs() < 1e-9, "{n}: {is} {should}");
                }
            }
            let inverse = inverse(&a, n).unwrap();
            for (i, row) in inverse.chunks_exact(n).enumerate() {
                for (k, x) in times(&a, row).iter().enumerate() {
                    let one = if i == k { 1.0 } else { 0.0 };
                    assert!((x - one).abs() < 1e-9, "{n}: {x} {one}");
                }
            }
            // With the first rows alone.
            for m in 1..n {
                let rows = a.chunks_exact(n).take(m);
                let part: Vec<f64> = rows.flat_map(|row| &row[..m]).copied().collect();
                let x: Vec<f64> = (0..m).map(|_| random(&mut seed)).collect();
                let mut is = x.clone();
                factor.solve(&mut is);
                for (is, should) in times(&part, &is).iter().zip(&x) {
                    assert!((is - should).abs() < 1e-9, "{m} of {n}: {is} {should}");
                }
            }
        }
    }

    #[test]
    fn indefinite_matrix_error_names_row() {
        let mut seed = 2;
        for (n, bad) in [(3, 1), (9, 8), (9, 0), (12, 6)] {
            for pivot in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                let mut a = positive_definite(n, &mut seed);
                for k in 0..n {
                    (a[bad * n + k], a[k * n + bad]) = (0.0, 0.0);
                }
                a[bad * n + bad] = pivot;
                assert_eq!(Factor::of(&a, n).err(), Some(bad), "{n}, {pivot}");
                let mut l = alloc::vec![0.0; n * n];
                assert_eq!(factorise(&a, &mut l, n), Err(bad));
            }
        }
    }
}
