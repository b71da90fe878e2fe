//! Score of a change: how much it would explain at every time, without fitting it.

use super::problem::{Problem, chi};
use crate::cholesky::{self, Factor};
use crate::offset::change::ChangeKind;
use crate::offset::equations::equation::Equations;
use crate::offset::equations::loaded::Content;
use crate::offset::equations::robust::redescending_weight;
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use alloc::vec::Vec;

/// How blocks that don't fit count while changes are looked for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Weighing {
    /// Up to any size, but by their square root: a load is as large as a contact, and only lasts.
    Huber,
    /// Less than a slip's size, not at all beyond: contacts don't count.
    Redescending,
}

impl Weighing {
    fn weight(self, chi: f64) -> f64 {
        match self {
            Self::Huber => (4.0 / libm::sqrt(chi)).min(1.0),
            Self::Redescending => {
                const SCALE: f64 = 25.0;
                redescending_weight(chi, SCALE)
            }
        }
    }
}

/// A weighted fit of the state without any further change.
pub(super) struct Fit {
    /// Information of every equation of every block.
    pub(super) weights: Vec<Vec<f64>>,
    /// Cholesky factor of its information.
    pub(super) factor: Factor,
    /// The step of the state the fit would take.
    pub(super) step: Vec<f64>,
    pub(super) equations: Equations,
}

impl Fit {
    /// The fit around a known estimate.
    pub(super) fn of(
        problem: &Problem<'_>,
        known: &MapEstimate,
        weighing: Weighing,
    ) -> Result<Self, MapError> {
        let mut equations = Equations::new(problem.layout(), &known.changes);
        let mut normal = problem.prior_equations(known);
        let mut weights = Vec::with_capacity(problem.blocks.len());
        for b in 0..problem.blocks.len() {
            problem.equations(known, b, Content::Rows, &mut equations);
            let whole = weighing.weight(chi(&equations, known));
            let information = |e: &_| whole * problem.information_of(e, known, b);
            normal.add_gradient(&equations, information);
            normal.add_information(&equations, information);
            weights.push(equations.list.iter().map(information).collect());
        }
        normal.solve()?;
        Ok(Self {
            weights,
            factor: normal.factor,
            step: normal.gradient,
            equations,
        })
    }
}

/// What the blocks after a time say of one kind of change.
pub(super) struct ScoreSum {
    columns: usize,
    total: usize,
    /// Gradient, `columns`.
    gradient: Vec<f64>,
    /// Own information, `columns × columns`.
    own: Vec<f64>,
    /// Information shared with the state, `columns × total`.
    shared: Vec<f64>,
    /// `L⁻¹` times that, of the fit's factor `L`; scratch.
    through: Vec<f64>,
    /// Cholesky factor of what was left of the information when that was last computed, and how many
    /// times ago that was.
    left: Option<(Vec<f64>, usize)>,
}

impl ScoreSum {
    pub(super) fn new(columns: usize, total: usize) -> Self {
        Self {
            columns,
            total,
            gradient: alloc::vec![0.0; columns],
            own: alloc::vec![0.0; columns * columns],
            shared: alloc::vec![0.0; columns * total],
            through: alloc::vec![0.0; columns * total],
            left: None,
        }
    }

    pub(super) fn add(&mut self, equations: &Equations, kind: ChangeKind, weights: &[f64]) {
        for (e, weight) in equations.list.iter().zip(weights) {
            if !e.moves_with(kind) {
                continue;
            }
            for (c, shared) in self.shared.chunks_exact_mut(self.total).enumerate() {
                let own = weight * equations.entry(e, kind, c);
                self.gradient[c] += own * e.residual;
                equations.add_to(e, own, shared);
                for k in 0..self.columns {
                    self.own[c * self.columns + k] += own * equations.entry(e, kind, k);
                }
            }
        }
    }

    /// `−L⁻¹ shared size`: what the state takes up of a change of this size, but for `L⁻ᵀ`.
    pub(super) fn taken_up(&self, size: &[f64]) -> Vec<f64> {
        let mut out = alloc::vec![0.0; self.total];
        for (size, through) in size.iter().zip(self.through.chunks_exact(self.total)) {
            for (to, x) in out.iter_mut().zip(through) {
                *to -= size * x;
            }
        }
        out
    }

    /// Half the chi-square a change here would take off, and its size: `½ gᵀ A⁻¹ g` with gradient
    /// and information less what the state would take up, `A = own − (L⁻¹ shared)ᵀ (L⁻¹ shared)`.
    /// `None` where that is far from `least`: `A` is most of the work, and nearly what it was at the
    /// time before.
    pub(super) fn gain(
        &mut self,
        fit: &Fit,
        deviations: &[f64],
        least: f64,
    ) -> Option<(f64, Vec<f64>)> {
        /// It is computed for one in so many times at least …
        const AGE: usize = 4;
        /// … and where the last one says that a change is worth this share of what it must be.
        const NEAR: f64 = 0.5;
        let (m, total) = (self.columns, self.total);
        let mut g = self.gradient.clone();
        for (g, shared) in g.iter_mut().zip(self.shared.chunks_exact(total)) {
            *g -= cholesky::dot(shared, &fit.step);
        }
        let solved = |l: &[f64]| {
            let mut x = g.clone();
            cholesky::solve(l, m, &mut x);
            (0.5 * cholesky::dot(&g, &x), x)
        };
        if let Some((l, age)) = &mut self.left {
            *age += 1;
            if *age < AGE && solved(l).0 < NEAR * least {
                return None;
            }
        }
        let mut a = self.own.clone();
        self.through.copy_from_slice(&self.shared);
        for c in 0..m {
            let (before, rest) = self.through.split_at_mut(c * total);
            let through = &mut rest[..total];
            fit.factor.forward(through);
            for (k, other) in before.chunks_exact(total).enumerate() {
                a[c * m + k] -= cholesky::dot(other, through);
            }
            a[c * m + c] -= cholesky::dot(through, through);
            a[c * m + c] += 1.0 / (deviations[c] * deviations[c]);
        }
        let mut l = alloc::vec![0.0; m * m];
        if cholesky::factorise(&a, &mut l, m).is_err() {
            self.left = None;
            return None;
        }
        let solution = solved(&l);
        self.left = Some((l, 0));
        Some(solution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::normal::NormalEquations;
    use crate::offset::change::Appearance;
    use crate::offset::change::ChangePoint;
    use crate::offset::effects::JointParameter;
    use crate::offset::equations::equation::{Equation, Side};
    use crate::offset::fixtures::{own, random};
    use crate::offset::layout::Layout;

    /// Of a load, whose four entries go together: what the score says without fitting it against fits with and without it.
    #[test]
    fn a_load_would_explain_what_fits_with_and_without_it_differ_by() {
        const BLOCKS: usize = 60;
        const PICKED_UP: usize = 25;
        const DEVIATIONS: [f64; 4] = [2.0, 0.7, 0.5, 1.1];
        let layout = Layout {
            joints: 2,
            bodies: 5,
            arms: 0,
            is_coupled: false,
        };
        let kind = ChangeKind::Payload;
        let change = [ChangePoint { kind, at_s: 1.0 }];
        let d = layout.dimension();
        let total = d + DEVIATIONS.len();
        let mut prior = alloc::vec![0.0; total * total];
        for k in 0..total {
            let deviation = k.checked_sub(d).map_or(1.0, |k| DEVIATIONS[k]);
            prior[k * (total + 1)] = 1.0 / (deviation * deviation);
        }
        let prior_without: Vec<f64> = prior
            .chunks_exact(total)
            .take(d)
            .flat_map(|row| &row[..d])
            .copied()
            .collect();
        let mut seed = 21;
        let mut with = NormalEquations::new(total, layout, &change);
        with.start(&prior, &alloc::vec![0.0; total]);
        let mut without = NormalEquations::new(d, layout, &[]);
        without.start(&prior_without, &alloc::vec![0.0; d]);
        let mut sum = ScoreSum::new(DEVIATIONS.len(), d);
        for b in 0..BLOCKS {
            let mut equations = Equations::new(layout, &change);
            for joint in 0..layout.joints {
                let phi: Vec<f64> = (0..layout.bodies).map(|_| random(&mut seed)).collect();
                let load: [f64; 4] = core::array::from_fn(|_| random(&mut seed));
                equations.carry(joint, &phi, &load, None);
                let held = if b >= PICKED_UP { 3.0 } else { 0.0 };
                let torque_gain = 0.5 + 0.4 * random(&mut seed);
                equations.push(Equation {
                    joint,
                    side: Side::Link,
                    own: own(Side::Link, &mut seed),
                    torque_gain,
                    residual: torque_gain * held * load[0] + 0.3 * random(&mut seed),
                    added_deviation: 0.0,
                    stationary_share: 0.0,
                });
            }
            let information = |e: &Equation| 4.0 + e.joint as f64;
            without.add_gradient(&equations, information);
            without.add_information(&equations, information);
            if b >= PICKED_UP {
                let weights: Vec<f64> = equations.list.iter().map(information).collect();
                sum.add(&equations, kind, &weights);
                equations.activate(&change, 2.0, Appearance::AT_ONCE);
            }
            with.add_gradient(&equations, information);
            with.add_information(&equations, information);
        }
        // Half the square of its length is what a step takes off the cost.
        let explained = |length: f64| 0.5 * length * length;
        let expected = explained(with.solve().unwrap()) - explained(without.solve().unwrap());
        let fit = Fit {
            weights: Vec::new(),
            factor: without.factor,
            step: without.gradient,
            equations: Equations::new(layout, &[]),
        };
        let (gain, size) = sum.gain(&fit, &DEVIATIONS, 0.0).unwrap();
        assert!(gain > 10.0, "{gain}");
        assert!((gain / expected - 1.0).abs() < 1e-9, "{gain} {expected}");
        // The load itself, and where it moves the state.
        let mut along = sum.taken_up(&size);
        fit.factor.backward(&mut along);
        let state = fit
            .step
            .iter()
            .zip(&along)
            .map(|(step, along)| step + along);
        for (is, should) in state.chain(size).zip(&with.gradient) {
            assert!((is - should).abs() < 1e-9, "{is} {should}");
        }
    }

    /// A slip of one joint among many blocks, by a score that computes everything at every time.
    #[test]
    fn a_time_that_is_passed_over_would_explain_little() {
        const BLOCKS: usize = 300;
        const NOISE: f64 = 0.3;
        const LEAST: f64 = 9.0;
        const DEVIATIONS: [f64; 1] = [10.0];
        let layout = Layout {
            joints: 1,
            bodies: 7,
            arms: 0,
            is_coupled: false,
        };
        let total = layout.dimension();
        let mut passed = 0;
        for slip in [0.0, 0.2, 1.0] {
            let mut seed = 11;
            let blocks: Vec<Equations> = (0..BLOCKS)
                .map(|b| {
                    let mut equations = Equations::new(layout, &[]);
                    let phi: Vec<f64> = (0..layout.bodies).map(|_| random(&mut seed)).collect();
                    let load = core::array::from_fn(|_| random(&mut seed));
                    equations.carry(0, &phi, &load, None);
                    let mut own = own(Side::Link, &mut seed);
                    own[JointParameter::Offset as usize] = 1.0;
                    own[JointParameter::Zero as usize] = 1.0;
                    let slipped = if b >= 180 { slip } else { 0.0 };
                    equations.push(Equation {
                        joint: 0,
                        side: Side::Link,
                        own,
                        torque_gain: 1.0,
                        residual: slipped + NOISE * random(&mut seed),
                        added_deviation: 0.0,
                        stationary_share: 0.0,
                    });
                    equations
                })
                .collect();
            let mut normal = NormalEquations::new(total, layout, &[]);
            let mut prior = alloc::vec![0.0; total * total];
            for k in 0..total {
                prior[k * (total + 1)] = 1.0;
            }
            normal.start(&prior, &alloc::vec![0.0; total]);
            let information = 1.0 / (NOISE * NOISE);
            for equations in &blocks {
                normal.add_gradient(equations, |_| information);
                normal.add_information(equations, |_| information);
            }
            normal.solve().unwrap();
            let fit = Fit {
                weights: Vec::new(),
                factor: normal.factor,
                step: normal.gradient,
                equations: Equations::new(layout, &[]),
            };
            let kind = ChangeKind::Offset(0);
            let mut sums = [ScoreSum::new(1, total), ScoreSum::new(1, total)];
            let mut telling = 0;
            for equations in blocks.iter().rev() {
                for sum in &mut sums {
                    sum.add(equations, kind, &[information]);
                }
                let [every, some] = &mut sums;
                let (gain, size) = every.gain(&fit, &DEVIATIONS, 0.0).unwrap();
                let found = some.gain(&fit, &DEVIATIONS, LEAST);
                if gain > LEAST {
                    telling += 1;
                    assert_eq!(found, Some((gain, size)));
                } else if found.is_none() {
                    passed += 1;
                }
            }
            assert_eq!(telling > 0, slip > 0.0, "slip {slip}: {telling}");
        }
        assert!(passed > BLOCKS / 2, "{passed}");
    }
}
