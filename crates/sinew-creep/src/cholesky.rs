//! Cholesky's factor of a covariance, and of a precision.

/// Lower Cholesky factor, row by row, of a covariance given by its lower triangle times a factor; a direction in which
/// nothing spreads gets a ten thousandth of the box.
pub(super) fn cholesky(covariance: &[f64], d: usize, times: f64) -> Vec<f64> {
    const LEAST: f64 = 1e-4;
    let mut l = vec![0.0; d * d];
    for i in 0..d {
        for j in 0..=i {
            let told: f64 = (0..j).map(|k| l[i * d + k] * l[j * d + k]).sum();
            let left = times * covariance[i * d + j] - told;
            l[i * d + j] = if i == j {
                left.max(LEAST * LEAST).sqrt()
            } else {
                left / l[j * d + j]
            };
        }
    }
    l
}

/// Lower triangle of the Cholesky factor of a matrix given by its lower triangle; a pivot that isn't positive is the least number
/// that is.
pub(super) fn lower_factor(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let d = a.len();
    for j in 0..d {
        for k in 0..j {
            for i in j..d {
                a[i][j] -= a[i][k] * a[j][k];
            }
        }
        let pivot = a[j][j].max(f64::MIN_POSITIVE).sqrt();
        for row in a.iter_mut().skip(j) {
            row[j] /= pivot;
        }
    }
    a
}
