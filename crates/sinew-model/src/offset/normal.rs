//! Normal equations, residuals and what correlates them.

use super::block::Block;
use super::equation::{Equation, Equations, Side};
use super::map::MapError;
use super::prior::PER_JOINT;
use crate::cholesky;
use alloc::vec::Vec;

/// Normal equations under construction, the lower half.
pub(super) struct Normal {
    total: usize,
    /// First entry of the bodies in the state.
    bodies: usize,
    pub(super) information: Vec<f64>,
    factor: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Link and motor row of the joint at work, `total` each; zero between joints.
    dense: [Vec<f64>; 2],
}

impl Normal {
    pub(super) fn new(total: usize, bodies: usize) -> Self {
        Self {
            total,
            bodies,
            information: alloc::vec![0.0; total * total],
            factor: alloc::vec![0.0; total * total],
            gradient: alloc::vec![0.0; total],
            dense: [alloc::vec![0.0; total], alloc::vec![0.0; total]],
        }
    }

    pub(super) fn start(&mut self, prior: &[f64], origin: &[f64], x: &[f64]) {
        self.information.copy_from_slice(prior);
        for (g, row) in self.gradient.iter_mut().zip(prior.chunks_exact(self.total)) {
            let terms = row.iter().zip(origin).zip(x);
            *g = terms.map(|((p, origin), x)| p * (origin - x)).sum();
        }
    }

    /// Adds the equations of a block, each with the information it carries.
    pub(super) fn add(&mut self, equations: &Equations, information: impl Fn(&Equation) -> f64) {
        let mut rest = equations.list.as_slice();
        while let Some(first) = rest.first() {
            let both = rest.get(1).is_some_and(|e| e.joint == first.joint);
            let (own, others) = rest.split_at(1 + usize::from(both));
            self.add_joint(&equations.rows, own, &information);
            rest = others;
        }
    }

    /// Link and motor equation of a joint move the same entries: both go in at once, dense over
    /// the joint's own entries and over those from its first body on.
    fn add_joint(
        &mut self,
        rows: &[(usize, f64)],
        own: &[Equation],
        information: &impl Fn(&Equation) -> f64,
    ) {
        let Some(joint) = own.first().map(|e| e.joint) else {
            return;
        };
        let mine = joint * PER_JOINT..(joint + 1) * PER_JOINT;
        let mut shared = self.total;
        let mut weights = [0.0; 2];
        for ((e, dense), weight) in own.iter().zip(&mut self.dense).zip(&mut weights) {
            *weight = information(e);
            for &(i, value) in &rows[e.from..e.to] {
                dense[i] = value;
                self.gradient[i] += *weight * value * e.residual;
                if i >= self.bodies && value != 0.0 {
                    shared = shared.min(i);
                }
            }
        }
        let [link, motor] = &mut self.dense;
        for i in mine.clone().chain(shared..self.total) {
            let factors = [weights[0] * link[i], weights[1] * motor[i]];
            if factors == [0.0; 2] {
                continue;
            }
            let line = &mut self.information[i * self.total..=i * self.total + i];
            let (own, rest) = if i < self.bodies {
                (mine.start..i + 1, 0..0)
            } else {
                (mine.clone(), shared..i + 1)
            };
            add_rows(
                &mut line[own.clone()],
                factors,
                &link[own.clone()],
                &motor[own],
            );
            add_rows(
                &mut line[rest.clone()],
                factors,
                &link[rest.clone()],
                &motor[rest],
            );
        }
        for dense in [link, motor] {
            dense[mine.clone()].fill(0.0);
            dense[shared..].fill(0.0);
        }
    }

    pub(super) fn solve(&mut self) -> Result<(), MapError> {
        cholesky::factorise(&self.information, &mut self.factor, self.total)
            .map_err(MapError::Prior)?;
        cholesky::solve(&self.factor, self.total, &mut self.gradient);
        Ok(())
    }

    /// Factor of the information, and the step.
    pub(super) fn solved(mut self) -> Result<(Vec<f64>, Vec<f64>), MapError> {
        self.solve()?;
        Ok((self.factor, self.gradient))
    }
}

fn add_rows(line: &mut [f64], [a, b]: [f64; 2], link: &[f64], motor: &[f64]) {
    for ((x, link), motor) in line.iter_mut().zip(link).zip(motor) {
        *x += a * link + b * motor;
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
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
