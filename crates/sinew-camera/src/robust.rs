//! Robust weighted least squares with few terms.

/// Maximum number of terms.
pub(crate) const MAX_TERMS: usize = 6;

/// Equation `Σ c_k row_k = value`, with a weight according to its noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Equation {
    pub(crate) row: [f64; MAX_TERMS],
    pub(crate) value: f64,
    pub(crate) weight: f64,
}

/// Fit of the first `terms` terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fit {
    pub(crate) coefficients: [f64; MAX_TERMS],
    /// Standard deviation of the first coefficient, from the scatter of the residuals, for independent equations.
    pub(crate) first_std: f64,
    /// Standard deviation of a residual of weight 1.
    pub(crate) scatter: f64,
}

impl Fit {
    /// Returns the fitted value of an equation.
    pub(crate) fn at(&self, equation: &Equation) -> f64 {
        let terms = self.coefficients.iter().zip(&equation.row);
        terms.map(|(c, r)| c * r).sum()
    }

    /// Returns the residual of an equation.
    pub(crate) fn residual(&self, equation: &Equation) -> f64 {
        equation.value - self.at(equation)
    }
}

/// Tukey's constant for 95 % efficiency with Gaussian residuals.
const TUKEY: f64 = 4.685;
/// Ratio of standard deviation to median absolute deviation of a Gaussian.
const MAD_TO_STD: f64 = 1.4826;
/// Maximum weight relative to the median weight.
const MAX_WEIGHT: f64 = 3.0;
/// Number of reweighting iterations; the weights converge to 1 % within five.
const ITERATIONS: usize = 6;

/// Solves iteratively reweighted least squares with Tukey's biweight. `None` if there are fewer equations than terms or
/// they do not determine the terms.
pub(crate) fn fit(equations: &[Equation], terms: usize) -> Option<Fit> {
    let mut keep = vec![1.0; equations.len()];
    let mut fit = None;
    for _ in 0..ITERATIONS {
        let mut normal = [[0.0; MAX_TERMS + 2]; MAX_TERMS];
        let (mut squares, mut freedom) = (0.0, -(terms as f64));
        for (equation, keep) in equations.iter().zip(&keep) {
            for (normal, left) in normal.iter_mut().zip(&equation.row[..terms]) {
                let left = equation.weight * keep * left;
                for (sum, right) in normal.iter_mut().zip(&equation.row[..terms]) {
                    *sum += left * right;
                }
                normal[MAX_TERMS] += left * equation.value;
            }
            freedom += keep;
        }
        // The second right-hand side is the first unit vector: its solution starts with the variance of the first
        // coefficient.
        normal[0][MAX_TERMS + 1] = 1.0;
        let solution = solve(normal, terms).filter(|_| freedom > 0.0)?;
        let found = fit.insert(Fit {
            coefficients: solution.map(|(coefficient, _)| coefficient),
            first_std: 0.0,
            scatter: 0.0,
        });
        let scaled: Vec<f64> = (equations.iter())
            .map(|e| found.residual(e) * e.weight.sqrt())
            .collect();
        for (r, keep) in scaled.iter().zip(&keep) {
            squares += keep * r * r;
        }
        let variance = squares / freedom;
        found.first_std = (variance * solution[0].1).max(0.0).sqrt();
        found.scatter = variance.sqrt();
        let cut = TUKEY * MAD_TO_STD * median(scaled.iter().map(|r| r.abs()).collect())?;
        if cut <= 0.0 {
            break;
        }
        let tukey = |r: &f64| (1.0 - (r / cut).powi(2)).max(0.0).powi(2);
        keep = scaled.iter().map(tukey).collect();
    }
    fit
}

/// Returns the weights relative to their median, limited to [`MAX_WEIGHT`].
pub(crate) fn capped(weights: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut weights: Vec<f64> = weights.collect();
    let middle = median(weights.clone()).unwrap_or(0.0);
    for weight in &mut weights {
        *weight = (*weight / middle.max(f64::MIN_POSITIVE)).min(MAX_WEIGHT);
    }
    weights
}

/// Wraps to −½ … ½.
pub(crate) fn wrap(cycles: f64) -> f64 {
    cycles - cycles.round()
}

/// Returns the median, the upper one of two.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    let values = (!values.is_empty()).then_some(&mut values)?;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Returns the quantile of a share.
pub(crate) fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let place = (share.clamp(0.0, 1.0) * last as f64).round() as usize;
    Some(*values.select_nth_unstable_by(place, f64::total_cmp).1)
}

/// Solves a symmetric positive system with two right-hand sides by Gaussian elimination.
fn solve(
    mut m: [[f64; MAX_TERMS + 2]; MAX_TERMS],
    terms: usize,
) -> Option<[(f64, f64); MAX_TERMS]> {
    let largest = (0..terms).map(|i| m[i][i]).fold(0.0, f64::max);
    for column in 0..terms {
        let pivot = m[column];
        // Terms are scaled to about 1: such a small pivot means that they are not separable.
        if pivot[column].is_nan() || pivot[column] <= 1e-9 * largest {
            return None;
        }
        for row in (0..terms).filter(|row| *row != column) {
            let factor = m[row][column] / pivot[column];
            for (held, pivot) in m[row].iter_mut().zip(pivot) {
                *held -= factor * pivot;
            }
        }
    }
    let mut out = [(0.0, 0.0); MAX_TERMS];
    for i in 0..terms {
        out[i] = (m[i][MAX_TERMS] / m[i][i], m[i][MAX_TERMS + 1] / m[i][i]);
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn plane(seed: u64, outliers: usize) -> Option<Fit> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let equations: Vec<Equation> = (0..200)
            .map(|i| {
                let u = 2.0 * rng.random::<f64>() - 1.0;
                let v = 2.0 * rng.random::<f64>() - 1.0;
                // The sum of twelve uniform numbers is nearly Gaussian with standard deviation 1.
                let noise: f64 = (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
                let mut value = 0.3 + 0.1 * u - 0.2 * v + 0.01 * noise;
                if i < outliers {
                    value += 0.4;
                }
                Equation {
                    row: [1.0, u, v, 0.0, 0.0, 0.0],
                    value,
                    weight: 1.0,
                }
            })
            .collect();
        fit(&equations, 3)
    }

    #[test]
    fn fit_one_sided_outliers_of_20_percent_are_ignored() {
        for seed in 0..20 {
            let fit = plane(seed, 40).unwrap();
            for (found, want) in fit.coefficients.iter().zip([0.3, 0.1, -0.2]) {
                // 160 equations with 0.01 give 0.0008; slopes have 1.7 times that; limit at four standard deviations.
                assert!((found - want).abs() < 6e-3, "{fit:?}");
            }
        }
    }

    #[test]
    fn fit_reported_std_matches_scatter() {
        let n = 400;
        let square: f64 = (0..n)
            .map(|seed| {
                let fit = plane(seed, 10).unwrap();
                ((fit.coefficients[0] - 0.3) / fit.first_std).powi(2)
            })
            .sum();
        // χ² with 400 degrees of freedom: standard deviation 7 %; Tukey's weights underestimate the scatter by about 5
        // %.
        let ratio = (square / n as f64).sqrt();
        assert!((0.85..1.25).contains(&ratio), "{ratio}");
    }

    #[test]
    fn fit_underdetermined_returns_none() {
        let row = [1.0, 2.0, 0.0, 0.0, 0.0, 0.0];
        let same = Equation {
            row,
            value: 1.0,
            weight: 1.0,
        };
        assert_eq!(fit(&[same; 30], 2), None);
        assert_eq!(fit(&[same; 1], 1), None);
    }
}
