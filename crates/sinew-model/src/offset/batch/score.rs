//! Score of a change: the expected decrease of the cost at every time, without fitting the change.

use super::problem::{Problem, chi};
use crate::cholesky::{self, Factor};
use crate::offset::change::ChangeKind;
use crate::offset::equations::equation::Equations;
use crate::offset::equations::loaded::Content;
use crate::offset::equations::robust::redescending_weight;
use crate::offset::error::MapError;
use crate::offset::estimate::MapEstimate;
use alloc::vec::Vec;

/// Weighting of outlying blocks during the search for changes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Weighing {
    /// Up to any size, but by their square root: a load is as large as a contact, and only lasts.
    Huber,
    /// Redescending weight, which reaches zero at the size of a slip, so that contacts are ignored.
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
    /// Computes the fit around an estimate.
    pub(super) fn of(
        problem: &Problem<'_>,
        estimate: &MapEstimate,
        weighing: Weighing,
    ) -> Result<Self, MapError> {
        let mut equations = Equations::new(problem.layout(), &estimate.changes);
        let mut normal = problem.prior_equations(estimate);
        let mut weights = Vec::with_capacity(problem.blocks.len());
        for b in 0..problem.blocks.len() {
            problem.equations(estimate, b, Content::Rows, &mut equations);
            let whole = weighing.weight(chi(&equations, estimate));
            let information = |e: &_| whole * problem.information_of(e, estimate, b);
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

/// Score sums of the blocks after a time for one kind of change.
pub(super) struct ScoreSum {
    columns: usize,
    total: usize,
    /// Gradient of the cost, `columns`.
    gradient: Vec<f64>,
    /// Own information, `columns × columns`.
    own: Vec<f64>,
    /// Information shared with the state, `columns × total`.
    shared: Vec<f64>,
    /// `L⁻¹` times that, of the fit's factor `L`; scratch.
    through: Vec<f64>,
    /// Latest Cholesky factor of the remaining information, and the number of tested times since its computation.
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
            if !equations.moves_with(e, kind) {
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

    /// Computes `−L⁻¹ shared size`: the part of a change of this size that the state explains, without the factor
    /// `L⁻ᵀ`.
    pub(super) fn taken_up(&self, size: &[f64]) -> Vec<f64> {
        let mut out = alloc::vec![0.0; self.total];
        for (size, through) in size.iter().zip(self.through.chunks_exact(self.total)) {
            for (to, x) in out.iter_mut().zip(through) {
                *to -= size * x;
            }
        }
        out
    }

    /// Returns half the chi-square decrease by a change here, and its size: `½ gᵀ A⁻¹ g` with gradient and information
    /// less the part explained by the state, `A = own − (L⁻¹ shared)ᵀ (L⁻¹ shared)`. `None` if the result is far from
    /// `least`: `A` is most of the computation, and nearly equal to that of the previous time.
    pub(super) fn gain(&mut self, fit: &Fit, stds: &[f64], least: f64) -> Option<(f64, Vec<f64>)> {
        /// Maximum number of times between two computations …
        const MAX_AGE: usize = 4;
        /// … and share of the minimum gain above which it is always computed.
        const NEAR_SHARE: f64 = 0.5;
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
            if *age < MAX_AGE && solved(l).0 < NEAR_SHARE * least {
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
            a[c * m + c] += 1.0 / (stds[c] * stds[c]);
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

    /// For a load with four coupled entries, compares the score with the difference of fits with and without it.
    #[test]
    fn load_score_equals_difference_of_fits() {
        const BLOCKS: usize = 60;
        const PICKED_UP: usize = 25;
        const DEVIATIONS: [f64; 4] = [2.0, 0.7, 0.5, 1.1];
        let layout = Layout::diagonal(2, 5);
        let kind = ChangeKind::Payload;
        let change = [ChangePoint { kind, at_s: 1.0 }];
        let d = layout.dimension();
        let total = d + DEVIATIONS.len();
        let mut prior = alloc::vec![0.0; total * total];
        for k in 0..total {
            let std = k.checked_sub(d).map_or(1.0, |k| DEVIATIONS[k]);
            prior[k * (total + 1)] = 1.0 / (std * std);
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
                    added_std: 0.0,
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
        // Half the square of its length is the decrease of the cost by a step.
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

    /// A slip of one joint among many blocks, compared with a score that is computed completely at every time.
    #[test]
    fn skipped_time_has_small_gain() {
        const BLOCKS: usize = 300;
        const NOISE: f64 = 0.3;
        const MIN_GAIN: f64 = 9.0;
        const DEVIATIONS: [f64; 1] = [10.0];
        let layout = Layout::diagonal(1, 7);
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
                        added_std: 0.0,
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
                let found = some.gain(&fit, &DEVIATIONS, MIN_GAIN);
                if gain > MIN_GAIN {
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
