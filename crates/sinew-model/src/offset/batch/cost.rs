//! Cost of an estimate: its deviation from the prior and from the blocks.

use super::problem::{Problem, chi, noise_of};
use super::schedule::Sampling;
use super::solution::Solution;
use crate::offset::equations::equation::{Equations, Side};
use crate::offset::equations::loaded::Content;
use crate::offset::estimate::MapEstimate;
use alloc::vec::Vec;

/// The scale that decides.
const SCALE: f64 = 3.0;

/// Cost of `at` if the noise were that of `noise`.
pub(super) fn cost_at(problem: &Problem<'_>, at: &MapEstimate, noise: &MapEstimate) -> f64 {
    cost_over(problem, at, noise, 1)
}

/// [`cost_at`] from one block in `every`.
pub(super) fn cost_over(
    problem: &Problem<'_>,
    at: &MapEstimate,
    noise: &MapEstimate,
    every: usize,
) -> f64 {
    let mut equations = Equations::new(problem.layout(), &at.changes);
    let blocks = (0..problem.blocks.len()).step_by(every).map(|b| {
        problem.equations(at, b, Content::Residuals, &mut equations);
        let count = (equations.list.len() * every) as f64;
        robust_cost(chi(&equations, noise), count) / problem.inflation[b]
    });
    prior_cost(problem, at) + blocks.sum::<f64>()
}

/// Returns the contribution of every block to the cost of `at`.
pub(super) fn cost_by_block(problem: &Problem<'_>, at: &MapEstimate) -> Vec<f64> {
    let mut equations = Equations::new(problem.layout(), &at.changes);
    let mut cost = |b: usize| {
        problem.equations(at, b, Content::Residuals, &mut equations);
        robust_cost(chi(&equations, at), equations.list.len() as f64) / problem.inflation[b]
    };
    (0..problem.blocks.len()).map(&mut cost).collect()
}

/// Returns the contribution of the prior to the cost.
fn prior_cost(problem: &Problem<'_>, at: &MapEstimate) -> f64 {
    let gradient = problem.prior_gradient(at);
    let origin = problem.origin(at.state.len());
    let from = at.state.iter().zip(origin).map(|(x, o)| x - o);
    -0.5 * from.zip(gradient).map(|(x, g)| x * g).sum::<f64>()
}

/// Cost of `count` equations at full weight whose mean square is `chi`.
fn robust_cost(chi: f64, count: f64) -> f64 {
    0.5 * count * SCALE * SCALE * chi / (SCALE * SCALE + chi)
}

/// An estimate's residuals in thinned blocks, to compare many candidates with.
pub(super) struct ThinnedResiduals {
    prior: f64,
    /// Number of equations, and their weight.
    blocks: Vec<(usize, f64)>,
    /// Joint, side, residual and deviation added to the noise.
    residuals: Vec<(usize, Side, f64, f64)>,
}

impl ThinnedResiduals {
    pub(super) fn of(problem: &Problem<'_>, at: &MapEstimate) -> Self {
        let every = Sampling::Thinned.every(problem.blocks.len());
        let mut equations = Equations::new(problem.layout(), &at.changes);
        let (mut blocks, mut residuals) = (Vec::new(), Vec::new());
        for b in (0..problem.blocks.len()).step_by(every) {
            problem.equations(at, b, Content::Residuals, &mut equations);
            blocks.push((equations.list.len(), every as f64 / problem.inflation[b]));
            let squares = equations.list.iter();
            residuals.extend(squares.map(|e| (e.joint, e.side, e.residual, e.added_std)));
        }
        Self {
            prior: prior_cost(problem, at),
            blocks,
            residuals,
        }
    }

    /// Returns the decrease of the cost by `other`, which uses a thinned schedule.
    pub(super) fn gain(&self, other: &Solution) -> f64 {
        let mut rest = self.residuals.as_slice();
        let blocks = self.blocks.iter().map(|(count, weight)| {
            let (own, others) = rest.split_at(*count);
            rest = others;
            let squares = own.iter().map(|(joint, side, residual, added)| {
                let noise = noise_of(*joint, *side, &other.estimate);
                residual * residual / (noise * noise + added * added)
            });
            let chi = squares.sum::<f64>() / own.len().max(1) as f64;
            robust_cost(chi, *count as f64) * weight
        });
        self.prior + blocks.sum::<f64>() - other.cost()
    }
}
