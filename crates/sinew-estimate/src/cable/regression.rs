//! Linear Gaussian regression with correlated errors: posterior and evidence.

use sinew_model::cholesky::{backward, dot, factorise, forward, inverse};

/// Cholesky factor of a covariance or precision.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lower {
    n: usize,
    l: Vec<f64>,
}

impl Lower {
    /// Factorises a matrix `n × n`, row-major; `None` if it is not positive definite.
    pub(super) fn of(a: &[f64], n: usize) -> Option<Self> {
        let mut l = vec![0.0; n * n];
        factorise(a, &mut l, n).ok()?;
        Some(Self { n, l })
    }

    /// Solution of `L x = b`: errors of covariance `L Lᵀ` become independent with variance one. Entry `i` depends on
    /// the entries up to `i` only.
    pub(super) fn whiten(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        forward(&self.l, self.n, &mut x);
        x
    }

    /// Solution of `L Lᵀ x = b`, from the solution of `L x = b`.
    pub(super) fn unwhiten(&self, whitened: &[f64]) -> Vec<f64> {
        let mut x = whitened.to_vec();
        backward(&self.l, self.n, &mut x);
        x
    }

    /// Logarithm of the determinant of `L Lᵀ`.
    fn ln_determinant(&self) -> f64 {
        2.0 * (0..self.n)
            .map(|i| self.l[i * self.n + i].ln())
            .sum::<f64>()
    }
}

/// Information on standardised parameters with the prior `N(0, I)`, from independent groups of measurements
/// `y = Φ u + e`, `e ~ N(0, C)`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Information {
    parameters: usize,
    /// `I + Σ Φᵀ C⁻¹ Φ`, row-major.
    precision: Vec<f64>,
    /// `Σ Φᵀ C⁻¹ y`.
    shift: Vec<f64>,
    /// `Σ (yᵀ C⁻¹ y + ln det 2πC)`.
    deviance: f64,
}

/// Posterior of standardised parameters.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Posterior {
    pub(super) mean: Vec<f64>,
    /// Covariance of the parameters, row-major.
    pub(super) covariance: Vec<f64>,
}

impl Information {
    pub(super) fn new(parameters: usize) -> Self {
        let mut precision = vec![0.0; parameters * parameters];
        for i in 0..parameters {
            precision[i * parameters + i] = 1.0;
        }
        Self {
            parameters,
            precision,
            shift: vec![0.0; parameters],
            deviance: 0.0,
        }
    }

    /// Adds a group of measurements: `columns` of `Φ`, the covariance `C` (row-major) and `y`.
    ///
    /// Returns `None` if the covariance is not positive definite.
    pub(super) fn add(
        &mut self,
        columns: &[Vec<f64>],
        covariance: &[f64],
        y: &[f64],
    ) -> Option<()> {
        let n = y.len();
        let factor = Lower::of(covariance, n)?;
        let y = factor.whiten(y);
        let columns: Vec<Vec<f64>> = columns.iter().map(|c| factor.whiten(c)).collect();
        for (i, own) in columns.iter().enumerate() {
            for (k, other) in columns.iter().enumerate().take(i + 1) {
                let sum = dot(own, other);
                self.precision[i * self.parameters + k] += sum;
                if i != k {
                    self.precision[k * self.parameters + i] += sum;
                }
            }
            self.shift[i] += dot(own, &y);
        }
        let constant = n as f64 * std::f64::consts::TAU.ln();
        self.deviance += dot(&y, &y) + factor.ln_determinant() + constant;
        Some(())
    }

    /// Logarithm of the evidence, the probability density of all measurements.
    pub(super) fn ln_evidence(&self) -> Option<f64> {
        let n = self.parameters;
        let factor = Lower::of(&self.precision, n)?;
        let shift = factor.whiten(&self.shift);
        Some(-0.5 * (self.deviance + factor.ln_determinant() - dot(&shift, &shift)))
    }

    /// Posterior of the parameters.
    pub(super) fn posterior(&self) -> Option<Posterior> {
        let n = self.parameters;
        let covariance = inverse(&self.precision, n).ok()?;
        let mean = covariance.chunks_exact(n).map(|row| dot(row, &self.shift));
        Some(Posterior {
            mean: mean.collect(),
            covariance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // One parameter with the column 2, prior N(0, 1) and two independent measurements with the variance 1/4: the posterior
    // precision is 1 + 2·4·4 = 33, its shift 4·2·(y₁ + y₂). The evidence is N(y; 0, 4·11ᵀ + I/4).
    #[test]
    fn posterior_and_evidence_equal_closed_form() {
        let y = [1.0, 0.5];
        let mut information = Information::new(1);
        let covariance = [0.25, 0.0, 0.0, 0.25];
        information
            .add(&[vec![2.0, 2.0]], &covariance, &y)
            .expect("positive definite");
        let posterior = information.posterior().expect("positive definite");
        assert!((posterior.mean[0] - 8.0 * 1.5 / 33.0).abs() < 1e-12);
        assert!((posterior.covariance[0] - 1.0 / 33.0).abs() < 1e-12);
        let (a, b) = (4.25_f64, 4.0_f64);
        let determinant = a * a - b * b;
        let square = (a * (y[0] * y[0] + y[1] * y[1]) - 2.0 * b * y[0] * y[1]) / determinant;
        let expected = -0.5 * (square + determinant.ln()) - std::f64::consts::TAU.ln();
        let evidence = information.ln_evidence().expect("positive definite");
        assert!((evidence - expected).abs() < 1e-12, "{evidence} {expected}");
    }

    #[test]
    fn groups_add_as_one_with_block_diagonal_covariance() {
        let columns = [[1.0, 0.5, -1.0, 2.0], [0.0, 1.0, 1.0, 0.3]];
        let y = [0.3, -0.2, 0.8, 0.1];
        let part = [1.0, 0.4, 0.4, 2.0];
        let mut apart = Information::new(2);
        for k in 0..2 {
            let own = columns.map(|c| c[2 * k..2 * k + 2].to_vec());
            apart.add(&own, &part, &y[2 * k..2 * k + 2]).expect("added");
        }
        let mut whole = vec![0.0; 16];
        for k in 0..2 {
            for (i, x) in part.iter().enumerate() {
                whole[(2 * k + i / 2) * 4 + 2 * k + i % 2] = *x;
            }
        }
        let mut together = Information::new(2);
        together
            .add(&columns.map(|c| c.to_vec()), &whole, &y)
            .expect("added");
        let evidences = [apart, together].map(|i| i.ln_evidence().expect("evidence"));
        assert!((evidences[0] - evidences[1]).abs() < 1e-12, "{evidences:?}");
    }
}
