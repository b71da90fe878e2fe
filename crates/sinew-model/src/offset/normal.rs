//! Normal equations, residuals and what correlates them.

use super::block::Block;
use super::equation::{Equation, Equations, Side};
use super::layout::Layout;
use super::map::MapError;
use super::prior::PER_JOINT;
use crate::cholesky;
use alloc::vec::Vec;

/// Normal equations under construction, the lower half.
pub(super) struct Normal {
    layout: Layout,
    total: usize,
    pub(super) information: Vec<f64>,
    pub(super) factor: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Link and motor row of the joint at work, over the changes that have happened.
    changes: Vec<(usize, [f64; 2])>,
}

impl Normal {
    pub(super) fn new(total: usize, layout: Layout) -> Self {
        Self {
            layout,
            total,
            information: alloc::vec![0.0; total * total],
            factor: alloc::vec![0.0; total * total],
            gradient: alloc::vec![0.0; total],
            changes: Vec::new(),
        }
    }

    /// What the prior says, and nothing else: its information, and what it pulls with.
    pub(super) fn start(&mut self, prior: &[f64], pull: &[f64]) {
        self.information.copy_from_slice(prior);
        self.gradient.copy_from_slice(pull);
    }

    /// Adds what the equations of a block say, each with the information it carries.
    pub(super) fn add_information(
        &mut self,
        equations: &Equations,
        information: impl Fn(&Equation) -> f64,
    ) {
        let mut rest = equations.list.as_slice();
        while let Some((link, others)) = rest.split_first() {
            let motor = others.first().filter(|e| e.joint == link.joint);
            rest = &others[usize::from(motor.is_some())..];
            let weights = [information(link), motor.map_or(0.0, &information)];
            // Without a motor's equation the link's comes twice, once without weight.
            self.add_joint(equations, [link, motor.unwrap_or(link)], weights);
        }
    }

    /// Adds what the equations of a block pull at the state with.
    pub(super) fn add_gradient(
        &mut self,
        equations: &Equations,
        information: impl Fn(&Equation) -> f64,
    ) {
        for e in &equations.list {
            equations.add_to(e, information(e) * e.residual, &mut self.gradient);
        }
    }

    /// Both equations of a joint at once: over bodies and load they are the same row, times a factor.
    fn add_joint(
        &mut self,
        equations: &Equations,
        [link, motor]: [&Equation; 2],
        [w0, w1]: [f64; 2],
    ) {
        let mine = self.layout.own(link.joint);
        let (rows, worth) = ([&link.own, &motor.own], [link.worth, motor.worth]);
        let carried = equations.carried(link.joint);
        let shared = self.layout.carried();
        // Bodies further in say nothing of this joint.
        let first = carried.iter().position(|x| *x != 0.0);
        let first = first.unwrap_or(carried.len());
        self.changes.clear();
        for ((i, a), (_, b)) in equations.changes(link).zip(equations.changes(motor)) {
            self.changes.push((i, [a, b]));
        }

        let total = self.total;
        let line = |i: usize| i * total..i * total + i + 1;
        for i in 0..PER_JOINT {
            let factors = [w0 * link.own[i], w1 * motor.own[i]];
            let to = &mut self.information[line(mine.start + i)][mine.start..];
            // Most entries are in one of the rows only.
            match factors {
                [0.0, 0.0] => {}
                [factor, 0.0] => add_row(to, factor, &link.own),
                [0.0, factor] => add_row(to, factor, &motor.own),
                factors => add_rows(to, factors, rows),
            }
        }
        // What an entry of the joint shares with a body, over what the joint carries of it.
        let mut own = [0.0; PER_JOINT];
        add_rows(&mut own, [w0 * worth[0], w1 * worth[1]], rows);
        let squared = w0 * worth[0] * worth[0] + w1 * worth[1] * worth[1];
        for (k, value) in carried.iter().enumerate().skip(first) {
            if *value != 0.0 {
                let to = &mut self.information[line(shared.start + k)];
                add_row(&mut to[mine.clone()], *value, &own);
                add_row(
                    &mut to[shared.start + first..],
                    squared * value,
                    &carried[first..],
                );
            }
        }
        for (i, [a, b]) in &self.changes {
            let factors = [w0 * a, w1 * b];
            let to = &mut self.information[line(*i)];
            add_rows(&mut to[mine.clone()], factors, rows);
            let along = factors[0] * worth[0] + factors[1] * worth[1];
            add_row(&mut to[shared.clone()], along, carried);
            for (k, [c, d]) in self.changes.iter().take_while(|(k, _)| k <= i) {
                to[*k] += factors[0] * c + factors[1] * d;
            }
        }
    }

    /// The gradient becomes the step.
    pub(super) fn solve(&mut self) -> Result<(), MapError> {
        cholesky::factorise(&self.information, &mut self.factor, self.total)
            .map_err(MapError::Prior)?;
        cholesky::solve(&self.factor, self.total, &mut self.gradient);
        Ok(())
    }
}

fn add_row(line: &mut [f64], factor: f64, row: &[f64]) {
    for (x, value) in line.iter_mut().zip(row) {
        *x += factor * value;
    }
}

fn add_rows(line: &mut [f64], [a, b]: [f64; 2], [link, motor]: [&[f64; PER_JOINT]; 2]) {
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
    use crate::offset::changes::{Change, What};
    use crate::offset::drawn::random;
    use crate::offset::prior::{JointParameter, PAYLOAD};
    use alloc::vec;

    #[test]
    fn it_is_the_sum_of_the_rows_squared() {
        const JOINTS: usize = 2;
        let layout = Layout {
            joints: JOINTS,
            bodies: 11,
        };
        // A load picked up before, and a slip of the first joint.
        let changes = [
            Change {
                what: What::Payload,
                at_s: 0.0,
            },
            Change {
                what: What::Offset(0),
                at_s: 0.0,
            },
            Change {
                what: What::Compliance(1),
                at_s: 9.0,
            },
        ];
        let total = layout.dimension() + PAYLOAD + 2;
        let mut seed = 1;
        let mut equations = Equations::new(layout, &changes);
        equations.activate(&changes, 1.0);
        for joint in 0..JOINTS {
            // The second joint carries no body but the last.
            let phi: Vec<f64> = (0..layout.bodies)
                .map(|k| {
                    if k < 6 * joint {
                        0.0
                    } else {
                        random(&mut seed)
                    }
                })
                .collect();
            equations.carry(joint, &phi, &core::array::from_fn(|_| random(&mut seed)));
            for (side, worth) in [(Side::Link, 0.02), (Side::Motor, 1.1)] {
                equations.push(Equation {
                    joint,
                    side,
                    own: core::array::from_fn(|_| random(&mut seed)),
                    worth,
                    residual: random(&mut seed),
                    unsure: 0.0,
                    stood: 0.0,
                });
            }
        }
        let information = |e: &Equation| if e.side == Side::Link { 3.0 } else { 0.7 };
        let mut normal = Normal::new(total, layout);
        // Twice, because nothing of the first may be left over.
        for _ in 0..2 {
            normal.add_gradient(&equations, information);
            normal.add_information(&equations, information);
        }
        let (mut square, mut gradient) = (vec![0.0; total * total], vec![0.0; total]);
        for e in &equations.list {
            // As the state is laid out: joints, bodies, load, changes.
            let mut row = vec![0.0; total];
            row[layout.own(e.joint)].copy_from_slice(&e.own);
            for (to, value) in row[layout.carried()]
                .iter_mut()
                .zip(equations.carried(e.joint))
            {
                *to = e.worth * value;
            }
            let load = layout.payload_place();
            row.copy_within(load..load + PAYLOAD, layout.dimension());
            row[layout.dimension() + PAYLOAD] = row[layout.place(0, JointParameter::Offset)];
            let column: Vec<f64> = (0..total).map(|_| random(&mut seed)).collect();
            let product: f64 = row.iter().zip(&column).map(|(a, b)| a * b).sum();
            assert!((equations.dot(e, &column) - product).abs() < 1e-12);
            let mut sum = column.clone();
            equations.add_to(e, -0.3, &mut sum);
            for ((sum, x), row) in sum.iter().zip(&column).zip(&row) {
                assert!((sum - (x - 0.3 * row)).abs() < 1e-12);
            }
            for (i, a) in row.iter().enumerate() {
                gradient[i] += 2.0 * information(e) * a * e.residual;
                for (k, b) in row.iter().enumerate() {
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
