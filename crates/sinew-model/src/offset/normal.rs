//! Normal equations, residuals and what correlates them.

use super::block::Block;
use super::equation::{Equation, Equations, Side};
use super::map::MapError;
use super::prior::PER_JOINT;
use crate::cholesky;
use alloc::vec::Vec;
use core::ops::Range;

/// Normal equations under construction, the lower half.
pub(super) struct Normal {
    total: usize,
    /// Entries of bodies and load in the state; changes come after them.
    bodies: Range<usize>,
    pub(super) information: Vec<f64>,
    factor: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Link and motor row of the joint at work, `total` each; zero between joints.
    dense: [Vec<f64>; 2],
    /// What the joint's own entries share with the link row's bodies.
    own: [f64; PER_JOINT],
}

impl Normal {
    pub(super) fn new(total: usize, bodies: Range<usize>) -> Self {
        Self {
            total,
            bodies,
            information: alloc::vec![0.0; total * total],
            factor: alloc::vec![0.0; total * total],
            gradient: alloc::vec![0.0; total],
            dense: [alloc::vec![0.0; total], alloc::vec![0.0; total]],
            own: [0.0; PER_JOINT],
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

    /// Both equations of a joint at once, dense over the joint's own entries, over bodies and load
    /// from the first that matters on, and over the changes. Over bodies and load the motor's row
    /// is the link's, times a factor.
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
        let mut first = self.bodies.end;
        let mut weights = [0.0; 2];
        for ((e, dense), weight) in own.iter().zip(&mut self.dense).zip(&mut weights) {
            *weight = information(e);
            for &(i, value) in &rows[e.from..e.to] {
                dense[i] = value;
                self.gradient[i] += *weight * value * e.residual;
                if self.bodies.contains(&i) && value != 0.0 {
                    first = first.min(i);
                }
            }
        }
        let shared = first..self.bodies.end;
        let factor = match own {
            [link, motor, ..] if link.worth != 0.0 => motor.worth / link.worth,
            _ => 0.0,
        };
        let [link, motor] = &mut self.dense;
        // What an entry shares with a body, over the link row's value of that body.
        let with_body = |i: usize| weights[0] * link[i] + weights[1] * factor * motor[i];
        for (to, i) in self.own.iter_mut().zip(mine.clone()) {
            *to = with_body(i);
        }
        let squared = weights[0] + weights[1] * factor * factor;
        let line = |i: usize| i * self.total..i * self.total + i + 1;
        for i in mine.clone() {
            let factors = [weights[0] * link[i], weights[1] * motor[i]];
            if factors != [0.0; 2] {
                let own = mine.start..i + 1;
                let to = &mut self.information[line(i)][own.clone()];
                add_rows(to, factors, &link[own.clone()], &motor[own]);
            }
        }
        for i in shared.clone() {
            let value = link[i];
            if value != 0.0 {
                let to = &mut self.information[line(i)];
                add_row(&mut to[mine.clone()], value, &self.own);
                add_row(&mut to[first..], squared * value, &link[first..=i]);
            }
        }
        for i in self.bodies.end..self.total {
            let factors = [weights[0] * link[i], weights[1] * motor[i]];
            if factors != [0.0; 2] {
                let to = &mut self.information[line(i)];
                for own in [mine.clone(), shared.end..i + 1] {
                    add_rows(
                        &mut to[own.clone()],
                        factors,
                        &link[own.clone()],
                        &motor[own],
                    );
                }
                add_row(&mut to[shared.clone()], with_body(i), &link[shared.clone()]);
            }
        }
        for dense in [link, motor] {
            dense[mine.clone()].fill(0.0);
            dense[first..].fill(0.0);
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

fn add_row(line: &mut [f64], factor: f64, row: &[f64]) {
    for (x, value) in line.iter_mut().zip(row) {
        *x += factor * value;
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

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    /// Numbers in −1..1, the same on every machine.
    fn random(seed: &mut u64) -> f64 {
        *seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    #[test]
    fn it_is_the_sum_of_the_rows_squared() {
        const JOINTS: usize = 2;
        let bodies = JOINTS * PER_JOINT..JOINTS * PER_JOINT + 15;
        let total = bodies.end + 3;
        let mut seed = 1;
        let mut equations = Equations {
            rows: vec![],
            list: vec![],
        };
        for joint in 0..JOINTS {
            // The second joint carries no body but the last.
            let carried = bodies.start + 10 * joint..bodies.end;
            let phi: Vec<f64> = carried.clone().map(|_| random(&mut seed)).collect();
            for (side, worth) in [(Side::Link, 0.02), (Side::Motor, 1.1)] {
                let from = equations.rows.len();
                let own = joint * PER_JOINT..(joint + 1) * PER_JOINT;
                for i in own.chain(bodies.end..total) {
                    equations.rows.push((i, random(&mut seed)));
                }
                for (i, phi) in carried.clone().zip(&phi) {
                    equations.rows.push((i, worth * phi));
                }
                equations.list.push(Equation {
                    joint,
                    side,
                    from,
                    to: equations.rows.len(),
                    residual: random(&mut seed),
                    unsure: 0.0,
                    stood: 0.0,
                    worth,
                });
            }
        }
        let information = |e: &Equation| if e.side == Side::Link { 3.0 } else { 0.7 };
        let mut normal = Normal::new(total, bodies);
        // Twice, because nothing of the first may be left over.
        for _ in 0..2 {
            normal.add(&equations, information);
        }
        let (mut square, mut gradient) = (vec![0.0; total * total], vec![0.0; total]);
        for e in &equations.list {
            for &(i, a) in equations.row(e) {
                gradient[i] += 2.0 * information(e) * a * e.residual;
                for &(k, b) in equations.row(e) {
                    square[i * total + k] += 2.0 * information(e) * a * b;
                }
            }
        }
        for i in 0..total {
            assert!((normal.gradient[i] - gradient[i]).abs() < 1e-12);
            for k in 0..=i {
                let (is, should) = (normal.information[i * total + k], square[i * total + k]);
                assert!((is - should).abs() < 1e-12, "{i}, {k}: {is}, {should}");
            }
        }
    }
}
