//! Normal equations, residuals and what correlates them.

use super::equation::{Equation, Equations, Side};
use super::features::Block;
use super::map::MapError;
use crate::cholesky;
use alloc::vec::Vec;

/// Normal equations under construction, the lower half.
pub(super) struct Normal {
    pub(super) total: usize,
    pub(super) information: Vec<f64>,
    pub(super) factor: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    pub(super) equations: Equations,
}

impl Normal {
    pub(super) fn new(total: usize) -> Self {
        Self {
            total,
            information: alloc::vec![0.0; total * total],
            factor: alloc::vec![0.0; total * total],
            gradient: alloc::vec![0.0; total],
            equations: Equations::default(),
        }
    }

    pub(super) fn start(&mut self, prior: &[f64], origin: &[f64], x: &[f64]) {
        let total = self.total;
        self.information.copy_from_slice(prior);
        for i in 0..total {
            self.gradient[i] = (0..total)
                .map(|k| prior[i * total + k] * (origin[k] - x[k]))
                .sum();
        }
    }

    pub(super) fn add(&mut self, e: &Equation, information: f64) {
        let row = &mut self.equations.rows[e.from..e.to];
        row.sort_unstable_by_key(|(place, _)| *place);
        for (at, &(i, vi)) in row.iter().enumerate() {
            let scaled = information * vi;
            self.gradient[i] += scaled * e.residual;
            let line = &mut self.information[i * self.total..(i + 1) * self.total];
            for &(k, vk) in &row[..=at] {
                line[k] += scaled * vk;
            }
        }
    }

    pub(super) fn solve(&mut self) -> Result<(), MapError> {
        cholesky::factorise(&self.information, &mut self.factor, self.total)
            .map_err(MapError::Prior)?;
        cholesky::solve(&self.factor, self.total, &mut self.gradient);
        Ok(())
    }

    /// Copies the lower half to the upper.
    pub(super) fn mirror(&mut self) {
        for i in 0..self.total {
            for k in 0..i {
                self.information[k * self.total + i] = self.information[i * self.total + k];
            }
        }
    }
}

/// Residuals of every block, for the robust noise.
pub(super) struct Residuals {
    n: usize,
    link: Vec<f64>,
    motor: Vec<f64>,
}

impl Residuals {
    pub(super) fn new(n: usize, blocks: usize) -> Self {
        Self {
            n,
            link: alloc::vec![f64::NAN; n * blocks],
            motor: alloc::vec![f64::NAN; n * blocks],
        }
    }

    pub(super) fn keep(&mut self, b: usize, equations: &Equations) {
        /// A drive that stood longer says nothing about the noise of one that moves.
        const STOOD: f64 = 0.2;
        for e in &equations.list {
            let k = b * self.n + e.joint;
            match e.side {
                Side::Link => self.link[k] = e.residual,
                Side::Motor => {
                    self.motor[k] = if e.stood < STOOD {
                        e.residual
                    } else {
                        f64::NAN
                    };
                }
            }
        }
    }

    /// 1.4826 times the median size.
    pub(super) fn noise(&self, i: usize, side: Side) -> f64 {
        let all = match side {
            Side::Link => &self.link,
            Side::Motor => &self.motor,
        };
        let sizes: Vec<f64> = all
            .iter()
            .skip(i)
            .step_by(self.n)
            .filter(|r| r.is_finite())
            .map(|r| r.abs())
            .collect();
        1.4826 * median(sizes)
    }
}

/// For each block, how many blocks the arm stood at the same pose around it.
///
/// What is wrong at a pose (quantisation, stuck friction, an encoder's error) is the same for as
/// long as the arm stands there: a stand counts as one block, however long.
pub(super) fn pose_runs(blocks: &[Block]) -> Vec<f64> {
    /// Motion below this is a stand, rad: well above an encoder's step and friction's stroke.
    const STAND_RAD: f64 = 0.01;
    let mut runs = alloc::vec![1.0; blocks.len()];
    let mut from = 0;
    for b in 0..=blocks.len() {
        let moved = match (blocks.get(from), blocks.get(b)) {
            (Some(first), Some(now)) => first
                .q
                .iter()
                .zip(&now.q)
                .any(|(a, b)| (a - b).abs() > STAND_RAD),
            _ => true,
        };
        if moved {
            let length = (b - from) as f64;
            for run in &mut runs[from..b] {
                *run = length;
            }
            from = b;
        }
    }
    runs
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
