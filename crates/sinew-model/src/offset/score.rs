//! How much every possible change at every moment would explain.

use super::changes::{Change, EDGE_S, SAME_S, Seek, What};
use super::cost::chi;
use super::course::See;
use super::equation::{Equations, Side};
use super::hands;
use super::linear::Look;
use super::map::{MapError, MapEstimate};
use super::prior::Payload;
use super::solve::Problem;
use crate::cholesky::{self, Factor};
use alloc::vec::Vec;

/// A candidate is tried when half its chi-square exceeds this and one per unknown.
const WORTH_TRYING: f64 = 8.0;
/// Candidates that are put into the estimate per round, of each weighing.
const TRIALS: [usize; 2] = [10, 3];
/// Moments of one in so many blocks are tried: of the change that is kept, those beside it are tried
/// too.
const EVERY: usize = 2;

/// A change that may have happened.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub(super) change: Change,
    pub(super) gain: f64,
    /// 0 for the best moment of its kind.
    pub(super) rank: usize,
    /// Its entries as the score has them.
    pub(super) size: Vec<f64>,
    /// How the rest of the state moves along.
    along: Vec<f64>,
    /// How it moves in the fit of the score without any change.
    step: Vec<f64>,
}

impl Problem<'_> {
    /// `best` with a candidate more, the rest of the state moved along: with the step that the score's
    /// fit would take or without it, whichever costs less. That fit trusts blocks and joints otherwise than
    /// the estimate does: where a slip was taken for noise its step is right, where little is known it leads
    /// far away.
    pub(super) fn with(&self, candidate: &Candidate, best: &MapEstimate) -> MapEstimate {
        let mut with = best.clone();
        with.changes.push(candidate.change);
        for (x, along) in with.state.iter_mut().zip(&candidate.along) {
            *x += along;
        }
        with.state.extend(&candidate.size);
        let mut stepped = with.clone();
        for (x, step) in stepped.state.iter_mut().zip(&candidate.step) {
            *x += step;
        }
        let every = See::Some.every(self.blocks.len());
        if self.cost_over(&stepped, best, every) < self.cost_over(&with, best, every) {
            stepped
        } else {
            with
        }
    }

    /// The most telling changes of every kind, by score.
    pub(super) fn candidates(
        &self,
        known: &MapEstimate,
        seek: Seek,
    ) -> Result<Vec<Candidate>, MapError> {
        let prior = self.estimator.prior();
        let mut offsets = Vec::new();
        if seek.offsets {
            let elastic = (0..prior.joints()).filter(|&i| prior.is_elastic(i));
            offsets.extend(elastic.map(What::Offset));
        }
        let mut loads = offsets.clone();
        // A strand may fail without a slip.
        let softer = offsets.iter().filter_map(|what| match what {
            What::Offset(joint) => Some(What::Compliance(*joint)),
            _ => None,
        });
        let softer: Vec<What> = softer.collect();
        offsets.extend(softer);
        if seek.payload && self.payload != Payload::Empty {
            loads.push(What::Payload);
        }
        // A change that lasts for most of a recording is taken for noise by the median; what good
        // sensors leave is a better guess while changes are looked for.
        const QUIET_RAD: f64 = 0.5e-3;
        let mut quiet = known.clone();
        for noise in &mut quiet.noise_rad {
            *noise = noise.min(QUIET_RAD);
        }
        let known = &quiet;
        let weighings = [(offsets, Weighing::Cut), (loads, Weighing::Huber)];
        let scored = hands::each(self.estimator.hands(), &weighings, |(kinds, weighing)| {
            if kinds.is_empty() {
                return Ok(Vec::new());
            }
            let fit = self.fit(known, *weighing)?;
            Ok(self.score(known, seek, kinds, fit, EVERY))
        });
        let mut out = Vec::new();
        for (scored, trials) in scored.into_iter().zip(TRIALS) {
            // The best of every kind before the second best of any: a failed strand and a
            // slip look alike to the score, and must not crowd each other out.
            let (mut first, mut second): (Vec<_>, Vec<_>) =
                scored?.into_iter().partition(|c| c.rank == 0);
            for some in [&mut first, &mut second] {
                some.sort_by(|a, b| b.gain.total_cmp(&a.gain));
            }
            out.extend(first.into_iter().chain(second).take(trials));
        }
        Ok(out)
    }

    /// The best moments of every kind of change, of one block in `every`.
    pub(super) fn score(
        &self,
        known: &MapEstimate,
        seek: Seek,
        kinds: &[What],
        mut fit: Fit,
        every: usize,
    ) -> Vec<Candidate> {
        let taken = |what: What, at_s: f64| {
            let mut changes = known.changes.iter();
            changes.any(|c| c.what == what && (c.at_s - at_s).abs() < SAME_S)
        };
        let total = known.state.len();
        let deviations: Vec<Vec<f64>> = kinds
            .iter()
            .map(|k| self.estimator.change_deviations(*k, self.payload))
            .collect();
        let mut sums: Vec<Sum> = kinds.iter().map(|k| Sum::new(k.columns(), total)).collect();
        let mut best: Vec<Vec<Candidate>> = alloc::vec![Vec::new(); kinds.len()];
        for b in (0..self.blocks.len()).rev() {
            let weight = fit.weights.pop().unwrap_or_default();
            self.equations(known, b, Look::Rows, &mut fit.equations);
            for (sum, what) in sums.iter_mut().zip(kinds) {
                sum.add(&fit.equations, *what, &weight);
            }
            if b % every != 0 {
                continue;
            }
            let at_s = self.start_of(b);
            for (k, what) in kinds.iter().enumerate() {
                if !self.is_possible(*what, at_s, seek) || taken(*what, at_s) {
                    continue;
                }
                let worth = WORTH_TRYING + what.columns() as f64;
                let worth = worth.max(to_beat(&best[k], at_s));
                let Some((gain, size)) = sums[k].gain(&fit, &deviations[k], worth) else {
                    continue;
                };
                if gain > worth {
                    keep_best(
                        &mut best[k],
                        Candidate {
                            change: Change { what: *what, at_s },
                            gain,
                            rank: 0,
                            along: sums[k].taken_up(&size),
                            step: fit.step.clone(),
                            size,
                        },
                    );
                }
            }
        }
        for kind in &mut best {
            for (rank, candidate) in kind.iter_mut().enumerate() {
                candidate.rank = rank;
                fit.factor.backward(&mut candidate.along);
            }
        }
        best.into_iter().flatten().collect()
    }

    /// When block `b` begins, s.
    pub(super) fn start_of(&self, b: usize) -> f64 {
        self.blocks[b].time_s - 0.5 * self.estimator.block_s()
    }

    /// Whether a change may be told at a moment. A strand may have failed before the recording began,
    /// and what goes on from a belief may have changed with its first block; an offset or a load that is
    /// open anyway may not.
    pub(super) fn is_possible(&self, what: What, at_s: f64, seek: Seek) -> bool {
        let early = seek.continues || matches!(what, What::Compliance(_));
        let from_s = if early { 0.0 } else { EDGE_S };
        let last = self.blocks.len() - 1;
        (self.start_of(0) + from_s..self.start_of(last) - EDGE_S).contains(&at_s)
    }

    /// A weighted fit around a known estimate.
    pub(super) fn fit(&self, known: &MapEstimate, weighing: Weighing) -> Result<Fit, MapError> {
        let mut equations = Equations::new(self.layout(), &known.changes);
        let mut normal = self.prior_equations(known);
        let mut weights = Vec::with_capacity(self.blocks.len());
        for b in 0..self.blocks.len() {
            self.equations(known, b, Look::Rows, &mut equations);
            let whole = weighing.weight(chi(&equations, known));
            let information = |e: &_| whole * self.information_of(e, known, b);
            normal.add_gradient(&equations, information);
            normal.add_information(&equations, information);
            weights.push(equations.list.iter().map(information).collect());
        }
        normal.solve()?;
        Ok(Fit {
            weights,
            factor: normal.factor,
            step: normal.gradient,
            equations,
        })
    }
}

/// How blocks that don't fit count while changes are looked for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Weighing {
    /// Up to any size, but by their square root: a load is as large as a contact, and only lasts.
    Huber,
    /// Less than a slip's size, not at all beyond: contacts don't count.
    Cut,
}

impl Weighing {
    fn weight(self, chi: f64) -> f64 {
        match self {
            Self::Huber => (4.0 / libm::sqrt(chi)).min(1.0),
            Self::Cut => {
                const SCALE: f64 = 25.0;
                let w = SCALE * SCALE / (SCALE * SCALE + chi);
                w * w
            }
        }
    }
}

/// Moments closer than this are the same one, s.
const APART_S: f64 = 5.0;
/// So many are kept of a kind.
const TWO: usize = 2;

/// What a change at a moment must be worth to be kept among the best.
fn to_beat(best: &[Candidate], at_s: f64) -> f64 {
    let near = best.iter().find(|c| (c.change.at_s - at_s).abs() < APART_S);
    let worst = best.get(TWO - 1);
    near.or(worst).map_or(0.0, |c| c.gain)
}

/// Keeps the two best moments that are not the same one.
fn keep_best(best: &mut Vec<Candidate>, new: Candidate) {
    let near = |c: &Candidate| (c.change.at_s - new.change.at_s).abs() < APART_S;
    if let Some(k) = best.iter().position(near) {
        if best[k].gain >= new.gain {
            return;
        }
        best.retain(|c| !near(c));
    }
    best.push(new);
    best.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    best.truncate(TWO);
}

/// A weighted fit.
pub(super) struct Fit {
    /// Information of every equation of every block.
    weights: Vec<Vec<f64>>,
    /// Cholesky factor of its information.
    factor: Factor,
    /// The step of the state the fit would take.
    step: Vec<f64>,
    equations: Equations,
}

/// What the blocks after a moment say of one kind of change.
struct Sum {
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
    /// moments ago that was.
    left: Option<(Vec<f64>, usize)>,
}

impl Sum {
    fn new(columns: usize, total: usize) -> Self {
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

    fn add(&mut self, equations: &Equations, what: What, weights: &[f64]) {
        for (e, weight) in equations.list.iter().zip(weights) {
            let concerned = match what {
                What::Offset(joint) | What::Compliance(joint) => {
                    e.side == Side::Link && e.joint == joint
                }
                What::Payload => true,
            };
            if !concerned {
                continue;
            }
            for (c, shared) in self.shared.chunks_exact_mut(self.total).enumerate() {
                let own = weight * equations.entry(e, what, c);
                self.gradient[c] += own * e.residual;
                equations.add_to(e, own, shared);
                for k in 0..self.columns {
                    self.own[c * self.columns + k] += own * equations.entry(e, what, k);
                }
            }
        }
    }

    /// `−L⁻¹ shared size`: what the state takes up of a change of this size, but for `L⁻ᵀ`.
    fn taken_up(&self, size: &[f64]) -> Vec<f64> {
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
    /// `None` where that is far from `worth`: `A` is most of the work, and nearly what it was at the
    /// moment before.
    fn gain(&mut self, fit: &Fit, deviations: &[f64], worth: f64) -> Option<(f64, Vec<f64>)> {
        /// It is computed for one in so many moments at least …
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
            if *age < AGE && solved(l).0 < NEAR * worth {
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
    use crate::offset::drawn::{own, random};
    use crate::offset::equation::Equation;
    use crate::offset::layout::Layout;
    use crate::offset::normal::Normal;
    use crate::offset::prior::JointParameter;

    /// A slip of one joint among many blocks, by a score that computes everything at every moment.
    #[test]
    fn a_moment_that_is_passed_over_is_worth_little() {
        const BLOCKS: usize = 300;
        const NOISE: f64 = 0.3;
        const WORTH: f64 = 9.0;
        const DEVIATIONS: [f64; 1] = [10.0];
        let layout = Layout {
            joints: 1,
            bodies: 7,
        };
        let total = layout.dimension();
        let mut passed = 0;
        for slip in [0.0, 0.2, 1.0] {
            let mut seed = 11;
            let blocks: Vec<Equations> = (0..BLOCKS)
                .map(|b| {
                    let mut equations = Equations::new(layout, &[]);
                    let phi: Vec<f64> = (0..layout.bodies).map(|_| random(&mut seed)).collect();
                    equations.carry(0, &phi, &core::array::from_fn(|_| random(&mut seed)));
                    let mut own = own(Side::Link, &mut seed);
                    own[JointParameter::Offset as usize] = 1.0;
                    own[JointParameter::Zero as usize] = 1.0;
                    let slipped = if b >= 180 { slip } else { 0.0 };
                    equations.push(Equation {
                        joint: 0,
                        side: Side::Link,
                        own,
                        worth: 1.0,
                        residual: slipped + NOISE * random(&mut seed),
                        unsure: 0.0,
                        stood: 0.0,
                    });
                    equations
                })
                .collect();
            let mut normal = Normal::new(total, layout);
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
            let what = What::Offset(0);
            let mut sums = [Sum::new(1, total), Sum::new(1, total)];
            let mut telling = 0;
            for equations in blocks.iter().rev() {
                for sum in &mut sums {
                    sum.add(equations, what, &[information]);
                }
                let [every, some] = &mut sums;
                let (gain, size) = every.gain(&fit, &DEVIATIONS, 0.0).unwrap();
                let found = some.gain(&fit, &DEVIATIONS, WORTH);
                if gain > WORTH {
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
