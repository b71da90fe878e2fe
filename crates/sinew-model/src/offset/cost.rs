//! What an estimate costs: how far it is from the prior, and from the blocks.

use super::course::See;
use super::equation::{Equation, Equations, Side};
use super::linear::Look;
use super::map::MapEstimate;
use super::solution::Solution;
use super::solve::Problem;
use alloc::vec::Vec;

/// The scale that decides.
const SCALE: f64 = 3.0;

impl Problem<'_> {
    /// Cost of `at` if the noise were that of `noise`.
    pub(super) fn cost_at(&self, at: &MapEstimate, noise: &MapEstimate) -> f64 {
        self.cost_over(at, noise, 1)
    }

    /// [`Problem::cost_at`] from one block in `every`.
    pub(super) fn cost_over(&self, at: &MapEstimate, noise: &MapEstimate, every: usize) -> f64 {
        let mut equations = Equations::new(self.layout(), &at.changes);
        let blocks = (0..self.blocks.len()).step_by(every).map(|b| {
            self.equations(at, b, Look::Residuals, &mut equations);
            let count = (equations.list.len() * every) as f64;
            robust_cost(chi(&equations, noise), count) / self.inflation[b]
        });
        self.prior_cost(at) + blocks.sum::<f64>()
    }

    /// What every block adds to the cost of `at`.
    pub(super) fn cost_by_block(&self, at: &MapEstimate) -> Vec<f64> {
        let mut equations = Equations::new(self.layout(), &at.changes);
        let mut cost = |b: usize| {
            self.equations(at, b, Look::Residuals, &mut equations);
            robust_cost(chi(&equations, at), equations.list.len() as f64) / self.inflation[b]
        };
        (0..self.blocks.len()).map(&mut cost).collect()
    }

    /// What the prior adds to it.
    fn prior_cost(&self, at: &MapEstimate) -> f64 {
        let pull = self.prior_pull(at);
        let origin = self.origin(at.state.len());
        let from = at.state.iter().zip(origin).map(|(x, o)| x - o);
        -0.5 * from.zip(pull).map(|(x, g)| x * g).sum::<f64>()
    }

    /// `at` as a glance sees it, to compare many with.
    pub(super) fn seen(&self, at: &MapEstimate) -> Seen {
        let every = See::Some.every(self.blocks.len());
        let mut equations = Equations::new(self.layout(), &at.changes);
        let (mut blocks, mut residuals) = (Vec::new(), Vec::new());
        for b in (0..self.blocks.len()).step_by(every) {
            self.equations(at, b, Look::Residuals, &mut equations);
            blocks.push((equations.list.len(), every as f64 / self.inflation[b]));
            let squares = equations.list.iter();
            residuals.extend(squares.map(|e| (e.joint, e.side, e.residual, e.unsure)));
        }
        Seen {
            prior: self.prior_cost(at),
            blocks,
            residuals,
        }
    }
}

/// An estimate's residuals in the blocks that are looked at.
pub(super) struct Seen {
    prior: f64,
    /// Number of equations, and how much they count.
    blocks: Vec<(usize, f64)>,
    /// Joint, side, residual and what is unsure beside the noise.
    residuals: Vec<(usize, Side, f64, f64)>,
}

impl Seen {
    /// What `other`, a glance or look, takes off the cost.
    pub(super) fn gain(&self, other: &Solution) -> f64 {
        let mut rest = self.residuals.as_slice();
        let blocks = self.blocks.iter().map(|(count, counts)| {
            let (own, others) = rest.split_at(*count);
            rest = others;
            let squares = own.iter().map(|(joint, side, residual, unsure)| {
                let noise = noise_of(*joint, *side, &other.estimate);
                residual * residual / (noise * noise + unsure * unsure)
            });
            let chi = squares.sum::<f64>() / own.len().max(1) as f64;
            robust_cost(chi, *count as f64) * counts
        });
        self.prior + blocks.sum::<f64>() - other.estimate.cost
    }
}

/// Cost of `count` equations at full weight whose mean square is `chi`.
fn robust_cost(chi: f64, count: f64) -> f64 {
    0.5 * count * SCALE * SCALE * chi / (SCALE * SCALE + chi)
}

/// Mean square of a block's residuals over what they may be.
pub(super) fn chi(equations: &Equations, at: &MapEstimate) -> f64 {
    let squares = equations
        .list
        .iter()
        .map(|e| e.residual * e.residual / variance(e, at));
    squares.sum::<f64>() / equations.list.len().max(1) as f64
}

/// Variance of an equation's residual.
pub(super) fn variance(e: &Equation, at: &MapEstimate) -> f64 {
    let noise = noise_of(e.joint, e.side, at);
    noise * noise + e.unsure * e.unsure
}

fn noise_of(joint: usize, side: Side, at: &MapEstimate) -> f64 {
    match side {
        Side::Link => at.noise_rad[joint],
        Side::Motor => at.motor_noise_nm[joint],
    }
}
