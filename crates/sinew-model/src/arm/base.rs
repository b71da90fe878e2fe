//! Base parameters: the combinations of mass properties that determine motion and gravity.

use super::{Arm, ArmWorkspace, MomentumRegressor};
use alloc::vec::Vec;

/// The base inertial parameters `z = B π`: the fewest combinations of all bodies' parameters `π` that
/// momentum and gravity torque depend on.
///
/// `P π = P_c z` and `A π = A_c z` with the columns `c` of the regressors: the other columns are
/// combinations of these, for every motion.
///
/// # Source
/// M. Gautier, W. Khalil, *Direct calculation of minimum set of inertial parameters of serial
/// robots*, IEEE Transactions on Robotics and Automation 6, 1990; found here by orthogonalising the
/// columns at poses without a pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// Columns of the regressors that are left, ascending.
    pub columns: Vec<usize>,
    /// `B`, row-major `r × 10 n`: a one where a parameter stands for itself.
    pub combination: Vec<f64>,
}

impl BaseParameters {
    /// Number of base parameters, `r`.
    pub fn count(&self) -> usize {
        self.columns.len()
    }

    /// Returns `B π`, length `r`; the missing entries of a shorter `π` count as zero.
    pub fn of(&self, pi: &[f64]) -> Vec<f64> {
        let length = self.combination.len() / self.count().max(1);
        let rows = self.combination.chunks_exact(length.max(1));
        rows.map(|row| row.iter().zip(pi).map(|(b, pi)| b * pi).sum())
            .collect()
    }
}

impl Arm {
    /// The base inertial parameters. Bodies far out keep their own as far as possible. Allocates.
    pub fn base_parameters(&self) -> BaseParameters {
        /// Relative size below which the remainder of a dependent column is rounding error.
        const ROUNDING: f64 = 1e-9;
        let columns = self.regressor_columns();
        let all = columns.len();
        let mut kept: Vec<usize> = Vec::new();
        // An orthonormal basis of the kept columns, and what each column has along it.
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut along: Vec<Vec<f64>> = alloc::vec![Vec::new(); all];
        for (k, column) in columns.iter().enumerate().rev() {
            let mut left = column.clone();
            let mut own = alloc::vec![0.0; basis.len()];
            // Twice: once leaves the rounding of what was large.
            for _ in 0..2 {
                for (axis, own) in basis.iter().zip(&mut own) {
                    let share = crate::cholesky::dot(axis, &left);
                    *own += share;
                    for (x, axis) in left.iter_mut().zip(axis) {
                        *x -= share * axis;
                    }
                }
            }
            let norm = |x: &[f64]| libm::sqrt(crate::cholesky::dot(x, x));
            let size = norm(&left);
            if size > ROUNDING * norm(column) {
                for x in &mut left {
                    *x /= size;
                }
                own.push(size);
                basis.push(left);
                kept.push(k);
            }
            along[k] = own;
        }
        let count = kept.len();
        let mut combination = alloc::vec![0.0; count * all];
        for (k, own) in along.iter().enumerate() {
            // Backwards through the triangle of the kept ones.
            let mut x = own.clone();
            for i in (0..x.len()).rev() {
                let triangle = &along[kept[i]];
                x[i] /= triangle[i];
                for m in 0..i {
                    x[m] -= x[i] * triangle[m];
                }
            }
            for (i, x) in x.iter().enumerate() {
                // Kept from the last column on; columns are ascending.
                combination[(count - 1 - i) * all + k] = *x;
            }
        }
        kept.reverse();
        BaseParameters {
            columns: kept,
            combination,
        }
    }

    /// The columns of both regressors over motions without a pattern.
    fn regressor_columns(&self) -> Vec<Vec<f64>> {
        /// 24 equations a joint for its ten columns.
        const MOTIONS: usize = 12;
        let n = self.dof();
        let mut regressor = MomentumRegressor::new(self);
        let mut ws = ArmWorkspace::new(self);
        let mut columns = alloc::vec![Vec::with_capacity(2 * n * MOTIONS); regressor.columns()];
        let [mut q, mut dq] = [(); 2].map(|()| alloc::vec![0.0; n]);
        for motion in 0..MOTIONS {
            for (i, (q, dq)) in q.iter_mut().zip(&mut dq).enumerate() {
                let k = (motion * n + i) as f64;
                (*q, *dq) = (
                    3.0 * libm::sin(1.0 + 2.7 * k),
                    2.0 * libm::sin(0.3 + 7.1 * k),
                );
            }
            if self
                .momentum_regressor(&mut ws, &q, &dq, &mut regressor)
                .is_err()
            {
                continue;
            }
            for matrix in [&regressor.p, &regressor.a] {
                for row in matrix.chunks_exact(regressor.columns().max(1)) {
                    for (column, x) in columns.iter_mut().zip(row) {
                        column.push(*x);
                    }
                }
            }
        }
        columns
    }
}
