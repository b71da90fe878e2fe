//! Normal equations, residuals and their correlations.

use crate::cholesky::{self, Factor};
use crate::offset::block::{Block, REST_RAD};
use crate::offset::change::ChangePoint;
use crate::offset::equations::equation::{Equation, Equations, Side};
use crate::offset::equations::gram::Gram;
use crate::offset::error::MapError;
use crate::offset::layout::Layout;
use crate::statistics::DEVIATION_PER_MEDIAN;
use crate::statistics::upper_median;
use alloc::vec::Vec;
use core::ops::Range;

/// Normal equations under construction, the lower half.
pub(super) struct NormalEquations {
    total: usize,
    pub(super) information: Vec<f64>,
    pub(super) factor: Factor,
    pub(super) gradient: Vec<f64>,
    /// Sums of blocks that are not in `information` yet.
    gram: Gram,
    /// Complete row, if the equations contain the parameters of several joints.
    row: Option<Vec<f64>>,
}

impl NormalEquations {
    pub(super) fn new(total: usize, layout: Layout, changes: &[ChangePoint]) -> Self {
        Self {
            total,
            information: alloc::vec![0.0; total * total],
            factor: Factor::new(total),
            gradient: alloc::vec![0.0; total],
            gram: Gram::new(layout, changes),
            row: layout.is_coupled.then(|| alloc::vec![0.0; total]),
        }
    }

    /// Sets the information and the negative gradient to those of the prior.
    pub(super) fn start(&mut self, prior: &[f64], gradient: &[f64]) {
        self.information.copy_from_slice(prior);
        self.gradient.copy_from_slice(gradient);
    }

    /// Sets all sums to zero.
    pub(super) fn clear(&mut self) {
        self.information.fill(0.0);
        self.gradient.fill(0.0);
    }

    /// Adds the equations of `other`.
    pub(super) fn merge(&mut self, other: &mut Self) {
        other.flush();
        let own = self.information.chunks_exact_mut(self.total);
        for (row, (own, more)) in own
            .zip(other.information.chunks_exact(self.total))
            .enumerate()
        {
            for (to, more) in own.iter_mut().zip(more).take(row + 1) {
                *to += more;
            }
        }
        for (to, more) in self.gradient.iter_mut().zip(&other.gradient) {
            *to += more;
        }
    }

    /// Adds the equations of a block, each with its information.
    pub(super) fn add_information(
        &mut self,
        equations: &Equations,
        information: impl Fn(&Equation) -> f64,
    ) {
        if let Some(row) = &mut self.row {
            add_dense(&mut self.information, row, equations, information);
            return;
        }
        if !self.gram.continues(equations) {
            self.flush();
        }
        self.gram.add(equations, information);
    }

    /// All that was added is in the information now.
    pub(super) fn flush(&mut self) {
        self.gram.move_to(&mut self.information, self.total);
    }

    /// Adds the negative gradient of the equations of a block.
    pub(super) fn add_gradient(
        &mut self,
        equations: &Equations,
        information: impl Fn(&Equation) -> f64,
    ) {
        for e in &equations.list {
            equations.add_to(e, information(e) * e.residual, &mut self.gradient);
        }
    }

    /// The negative gradient `g` becomes the step `s = A⁻¹ g`. Returns its length in posterior
    /// standard deviations, `√(gᵀ A⁻¹ g)`, the Newton decrement.
    pub(super) fn solve(&mut self) -> Result<f64, MapError> {
        self.flush();
        (self.factor.factorise(&self.information)).map_err(MapError::Prior)?;
        let gradient = self.gradient.clone();
        self.factor.solve(&mut self.gradient);
        Ok(libm::sqrt(
            cholesky::dot(&gradient, &self.gradient).max(0.0),
        ))
    }
}

/// Adds `w hᵀ h` of every equation to the lower half of `to`; `row` is room for `h`.
fn add_dense(
    to: &mut [f64],
    row: &mut [f64],
    equations: &Equations,
    information: impl Fn(&Equation) -> f64,
) {
    let total = row.len();
    for e in &equations.list {
        row.fill(0.0);
        equations.add_to(e, 1.0, row);
        let weight = information(e);
        for (i, h) in row.iter().enumerate().filter(|(_, h)| **h != 0.0) {
            let line = &mut to[i * total..=i * total + i];
            for (to, other) in line.iter_mut().zip(&*row) {
                *to += weight * h * other;
            }
        }
    }
}

/// Residuals of every block, for the robust noise.
pub(super) struct Residuals {
    n: usize,
    /// The first block.
    first: usize,
    link: Vec<f64>,
    motor: Vec<f64>,
    tension: Vec<f64>,
}

impl Residuals {
    pub(super) fn new(n: usize, blocks: Range<usize>) -> Self {
        Self {
            n,
            first: blocks.start,
            link: alloc::vec![f64::NAN; n * blocks.len()],
            motor: alloc::vec![f64::NAN; n * blocks.len()],
            tension: Vec::new(),
        }
    }

    /// Keeps the residuals of block `b` unless the block is rejected: noise is estimated from accepted blocks.
    /// Contacts for a tenth of the time would increase the median by a sixth, and long rest phases provide no
    /// information on noise.
    pub(super) fn keep(&mut self, b: usize, equations: &Equations, counts: bool) {
        /// Maximum share of rest of a drive or joint that still provides information on the noise.
        const STATIONARY: f64 = 0.2;
        for e in &equations.list {
            let k = (b - self.first) * self.n + e.joint;
            let to = match e.side {
                Side::Link => &mut self.link[k],
                Side::Motor => &mut self.motor[k],
                Side::Tension => {
                    self.tension.resize(self.motor.len(), f64::NAN);
                    &mut self.tension[k]
                }
            };
            let counts = counts && e.stationary_share < STATIONARY;
            *to = if counts { e.residual } else { f64::NAN };
        }
    }

    /// Sizes of a joint's.
    fn sizes(&self, i: usize, side: Side) -> impl Iterator<Item = f64> {
        let all = match side {
            Side::Link => &self.link,
            Side::Motor => &self.motor,
            Side::Tension => &self.tension,
        };
        let own = all.iter().skip(i).step_by(self.n);
        own.filter(|r| r.is_finite()).map(|r| r.abs())
    }

    /// Noise by the median size, of all parts; `None` if no block has residuals.
    pub(super) fn noise<'a>(
        parts: impl Iterator<Item = &'a Self>,
        i: usize,
        side: Side,
    ) -> Option<f64> {
        let mut sizes: Vec<f64> = parts.flat_map(|p| p.sizes(i, side)).collect();
        upper_median(&mut sizes).map(|median| DEVIATION_PER_MEDIAN * median)
    }
}

/// Returns for each block the number of blocks around it in which the arm was at rest at the same pose.
///
/// Errors at a pose (quantisation, stiction, encoder error) are constant for as long as the arm is at rest
/// there: a rest phase counts as one block, independent of its duration.
pub(super) fn pose_runs(blocks: &[Block]) -> Vec<f64> {
    let mut runs = alloc::vec![1.0; blocks.len()];
    let mut from = 0;
    for b in 0..=blocks.len() {
        let moved = match (blocks.get(from), blocks.get(b)) {
            (Some(first), Some(now)) => first
                .q
                .iter()
                .zip(&now.q)
                .any(|(a, b)| (a - b).abs() > REST_RAD),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::change::Appearance;
    use crate::offset::change::ChangeKind;
    use crate::offset::effects::{FORCE, JointParameter, PAYLOAD};
    use crate::offset::fixtures::{own, random};
    use alloc::vec;

    #[test]
    fn normal_equations_equal_sum_of_squared_rows() {
        const JOINTS: usize = 2;
        let layout = Layout::diagonal(JOINTS, 11);
        // A load picked up before, a slip of the first joint, creep of the second, and a force on both.
        let changes = [
            ChangePoint {
                kind: ChangeKind::Payload,
                at_s: 0.0,
            },
            ChangePoint {
                kind: ChangeKind::Offset(0),
                at_s: 0.0,
            },
            ChangePoint {
                kind: ChangeKind::Compliance(1),
                at_s: 9.0,
            },
            ChangePoint {
                kind: ChangeKind::Creep(1),
                at_s: -3.0,
            },
            ChangePoint {
                kind: ChangeKind::Force,
                at_s: -3.0,
            },
        ];
        let total = layout.dimension() + PAYLOAD + 3 + FORCE;
        let creep = total - FORCE - 1;
        let mut seed = 1;
        let mut equations = Equations::new(layout, &changes);
        equations.activate(&changes, 1.0, Appearance::AT_ONCE);
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
            let load = core::array::from_fn(|_| random(&mut seed));
            let force = core::array::from_fn(|_| random(&mut seed));
            equations.carry(joint, &phi, &load, Some(&force));
            for (side, torque_gain) in [(Side::Link, 0.02), (Side::Motor, 1.1)] {
                equations.push(Equation {
                    joint,
                    side,
                    own: own(side, &mut seed),
                    torque_gain,
                    residual: random(&mut seed),
                    added_std: 0.0,
                    stationary_share: 0.0,
                });
            }
        }
        let information = |e: &Equation| if e.side == Side::Link { 3.0 } else { 0.7 };
        let mut normal = NormalEquations::new(total, layout, &changes);
        let (mut square, mut gradient) = (vec![0.0; total * total], vec![0.0; total]);
        // Blocks from before the changes and since, more than are held back at once.
        for (time_s, times) in [(-1.0, 3), (1.0, 19)] {
            equations.activate(&changes, time_s, Appearance::AT_ONCE);
            for _ in 0..times {
                normal.add_gradient(&equations, information);
                normal.add_information(&equations, information);
            }
            for e in &equations.list {
                // As the state is laid out: joints, bodies, load, changes.
                let mut row = vec![0.0; total];
                row[layout.own(e.joint)].copy_from_slice(&e.own);
                for (to, value) in row[layout.carried()]
                    .iter_mut()
                    .zip(equations.carried(e.joint))
                {
                    *to = e.torque_gain * value;
                }
                // It creeps since −3 s, in steps of two seconds.
                if e.joint == 1 {
                    let steps_s = if time_s > 0.0 { 5.0 } else { 3.0 };
                    row[creep] = steps_s * row[layout.place(1, JointParameter::Offset)];
                }
                let force = &equations.row(e.joint)[layout.carried().len()..];
                for (to, value) in row[creep + 1..].iter_mut().zip(force) {
                    *to = e.torque_gain * value;
                }
                if time_s > 0.0 {
                    let load = layout.payload_place();
                    row.copy_within(load..load + PAYLOAD, layout.dimension());
                    row[layout.dimension() + PAYLOAD] =
                        row[layout.place(0, JointParameter::Offset)];
                }
                let column: Vec<f64> = (0..total).map(|_| random(&mut seed)).collect();
                let product: f64 = row.iter().zip(&column).map(|(a, b)| a * b).sum();
                assert!((equations.dot(e, &column) - product).abs() < 1e-12);
                let mut sum = column.clone();
                equations.add_to(e, -0.3, &mut sum);
                for ((sum, x), row) in sum.iter().zip(&column).zip(&row) {
                    assert!((sum - (x - 0.3 * row)).abs() < 1e-12);
                }
                let information = f64::from(times) * information(e);
                for (i, a) in row.iter().enumerate() {
                    gradient[i] += information * a * e.residual;
                    for (k, b) in row.iter().enumerate() {
                        square[i * total + k] += information * a * b;
                    }
                }
            }
        }
        normal.flush();
        for i in 0..total {
            assert!((normal.gradient[i] - gradient[i]).abs() < 1e-12);
            for k in 0..=i {
                let (is, should) = (normal.information[i * total + k], square[i * total + k]);
                assert!((is - should).abs() < 1e-12, "{i}, {k}: {is}, {should}");
            }
        }
    }
}
