//! Products of four columns with four, whose sums stay in registers.

/// Columns and rows of a tile.
pub(crate) const TILE: usize = 4;

/// Sums of products of four columns with four.
pub(crate) type Tile = [[f64; TILE]; TILE];

/// `Σ aᵀ b` over rows of four columns.
#[inline]
pub(crate) fn products(a: &[[f64; TILE]], b: &[[f64; TILE]]) -> Tile {
    let mut sum = [[0.0; TILE]; TILE];
    for (a, b) in a.iter().zip(b) {
        for i in 0..TILE {
            for k in 0..TILE {
                sum[i][k] += a[i] * b[k];
            }
        }
    }
    sum
}

/// Place of tile `i`, `k` in the lower half of a square of tiles.
pub(crate) fn lower(i: usize, k: usize) -> usize {
    i * (i + 1) / 2 + k
}
