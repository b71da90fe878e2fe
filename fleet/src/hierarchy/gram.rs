//! Sums over tendons that a posterior of the coefficients needs, with the robots' effects integrated out.

use super::{Hierarchy, Unit};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// `XᵀV⁻¹X`, `XᵀV⁻¹z`, `zᵀV⁻¹z` and `ln |V|` for a block-diagonal `V`: per robot a diagonal plus a common variance.
#[derive(Debug, Clone)]
pub(super) struct Gram {
    /// Matrix in column-major order, lower triangle only.
    xx: Vec<f64>,
    columns: usize,
    xz: DVector<f64>,
    zz: f64,
    log_determinant: f64,
}

impl Gram {
    /// * `variance`: of a unit without its robot's part.
    /// * `robot`: variance between robots.
    pub(super) fn of(model: &Hierarchy, variance: impl Fn(&Unit) -> f64, robot: f64) -> Self {
        let p = model.columns();
        let mut out = Self {
            xx: vec![0.0; p * p],
            columns: p,
            xz: DVector::zeros(p),
            zz: 0.0,
            log_determinant: 0.0,
        };
        // Weighted sum of the rows of a robot; few of its columns are nonzero.
        let mut sum = vec![0.0; p];
        let mut in_use = vec![false; p];
        let mut used: Vec<usize> = Vec::new();
        for together in model.units.chunk_by(|a, b| a.robot == b.robot) {
            let (mut weights, mut sum_z) = (0.0, 0.0);
            for unit in together {
                let w = 1.0 / variance(unit);
                out.add(unit, w);
                weights += w;
                sum_z += w * unit.value;
                for &(column, x) in &unit.columns {
                    if !std::mem::replace(&mut in_use[column], true) {
                        used.push(column);
                    }
                    sum[column] += w * x;
                }
            }
            // Woodbury identity: the common variance of the robot reduces the sums along their common direction.
            let share = robot / (1.0 + robot * weights);
            out.log_determinant += (robot * weights).ln_1p();
            out.zz -= share * sum_z * sum_z;
            for &a in &used {
                out.xz[a] -= share * sum[a] * sum_z;
                let weighed = share * sum[a];
                for &b in used.iter().filter(|b| **b >= a) {
                    out.xx[a * p + b] -= weighed * sum[b];
                }
            }
            for column in used.drain(..) {
                (sum[column], in_use[column]) = (0.0, false);
            }
        }
        out
    }

    fn add(&mut self, unit: &Unit, w: f64) {
        for &(a, x) in &unit.columns {
            self.xz[a] += w * x * unit.value;
            for &(b, y) in unit.columns.iter().filter(|(b, _)| *b >= a) {
                self.xx[a * self.columns + b] += w * x * y;
            }
        }
        self.zz += w * unit.value * unit.value;
        self.log_determinant -= w.ln();
    }

    /// With a prior of the coefficients: mean 0, `precision` each. `None`: not positive definite.
    pub(super) fn posterior(&self, precision: &[f64]) -> Option<Posterior> {
        let mut c = DMatrix::from_column_slice(self.columns, self.columns, &self.xx);
        for (i, p) in precision.iter().enumerate() {
            c[(i, i)] += p;
        }
        let factor = c.cholesky()?;
        let mean = factor.solve(&self.xz);
        let log_c: f64 = factor
            .l_dirty()
            .diagonal()
            .iter()
            .map(|x| 2.0 * x.ln())
            .sum();
        let log_prior: f64 = precision.iter().map(|p| p.ln()).sum();
        let left = self.zz - self.xz.dot(&mean);
        Some(Posterior {
            log_evidence: -0.5 * (self.log_determinant + log_c - log_prior + left),
            mean,
            factor,
        })
    }
}

/// Posterior of the coefficients for given standard deviations.
pub(super) struct Posterior {
    /// Logarithm of the probability of the values, coefficients integrated out, up to a constant.
    pub(super) log_evidence: f64,
    mean: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Posterior {
    /// A draw from standard normal numbers: `C⁻¹ = L⁻ᵀ L⁻¹`.
    pub(super) fn draw(&self, normal: DVector<f64>) -> Vec<f64> {
        let mut out = normal;
        let solved = self
            .factor
            .l_dirty()
            .tr_solve_lower_triangular_mut(&mut out);
        debug_assert!(solved, "a factor has a diagonal above 0");
        (out + &self.mean).iter().copied().collect()
    }
}
