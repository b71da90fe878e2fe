//! Groups that differ, tendons within them that differ more: what can be told of each group, with few tendons and many.
//!
//! Of each tendon `i` of robot `r` a logarithm `z` is known to a variance `v`:
//!
//! `z_i = x_iᵀ β + Σ_f u_f(i) + b_r + e_i + N(0, v_i)`
//!
//! | term | what | a priori |
//! |---|---|---|
//! | `β` | kinds of tendon, covariates | normal, wide |
//! | `u_0` | the groups that are compared | normal, `τ_0`; one in ten strays beyond: a bad one among good ones isn't drawn in |
//! | `u_f` | what else differs: batches, sites | as groups for batches, normal for sites, `τ_f` |
//! | `b_r` | robots | normal, `τ_robot` |
//! | `e_i` | tendons | normal, `τ_tendon` times what is usual for their kind; who gives the values draws in those that stray |
//! | `τ` | how far each differ | half-Cauchy; of groups and factors it begins at 0, as no two are quite alike |
//!
//! All that is said comes from draws of the joint posterior ([`sample`]), so it holds what isn't known of the `τ` too: a factor
//! with four levels tells little of its `τ`.

mod chain;
mod gram;

use chain::Chain;
use rayon::prelude::*;
use sinew_model::statistics::quantile;

/// Chains that start apart.
const CHAINS: u64 = 4;
/// Draws a chain forgets, and draws it keeps.
const WARM_UP: usize = 400;
const KEPT: usize = 1000;

/// What is known of a tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Logarithm.
    pub value: f64,
    /// Its variance.
    pub variance: f64,
    /// What `τ_tendon` is multiplied by for tendons of its kind: some kinds differ more than others.
    pub spread: f64,
    /// Robot; those of one robot follow each other.
    pub robot: usize,
    /// Columns it has part in, and by how much.
    pub columns: Vec<(usize, f64)>,
}

/// A factor whose levels are drawn from one distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// Its first column.
    pub first: usize,
    /// Its levels, a column each.
    pub levels: usize,
    /// Scale of the prior of how far they differ.
    pub scale: f64,
    /// Whether single ones may stray.
    pub heavy: bool,
}

/// Tendons and what they have in common.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Hierarchy {
    /// Tendons, by robot.
    pub units: Vec<Unit>,
    /// Of each fixed column, from 0 on, the deviation of its prior.
    pub fixed: Vec<f64>,
    /// Factors; their columns follow the fixed ones.
    pub factors: Vec<Factor>,
}

impl Hierarchy {
    /// All columns.
    pub fn columns(&self) -> usize {
        self.fixed.len() + self.factors.iter().map(|f| f.levels).sum::<usize>()
    }
}

/// Draws of the posterior.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Draws {
    /// Of each draw all columns' coefficients.
    pub coefficients: Vec<Vec<f64>>,
    /// Of each draw `τ` of tendons, of robots, and of each factor.
    pub deviations: Vec<Vec<f64>>,
    /// The largest ratio of what chains that started apart say to what each says, over all coefficients and `τ`:
    /// 1 where they agree.
    pub disagreement: f64,
}

impl Draws {
    /// Whether the chains say the same. Of draws that don't, nothing may be claimed.
    pub fn have_come_together(&self) -> bool {
        /// Chains that differ by more have not come together.
        const MOST: f64 = 1.1;
        self.disagreement <= MOST
    }
}

/// Draws from the posterior: four chains, 4,000 draws; a seed gives the same ones again.
///
/// `None`: the equations have no solution, as a value or a variance isn't finite or above zero.
pub fn sample(hierarchy: &Hierarchy, seed: u64) -> Option<Draws> {
    let chains: Vec<Draws> = (0..CHAINS)
        .into_par_iter()
        .map(|i| Chain::new(hierarchy, seed.wrapping_add(i)).run(WARM_UP, KEPT))
        .collect::<Option<_>>()?;
    let coefficient = |i: usize| {
        let of = |chain: &Draws| chain.coefficients.iter().map(|draw| draw[i]).collect();
        split_ratio(&chains.iter().map(of).collect::<Vec<_>>())
    };
    // A deviation is compared by its logarithm: some are near 0.
    let deviation = |i: usize| {
        let of = |chain: &Draws| chain.deviations.iter().map(|draw| draw[i].ln()).collect();
        split_ratio(&chains.iter().map(of).collect::<Vec<_>>())
    };
    let ratios = (0..hierarchy.columns()).map(coefficient);
    let ratios = ratios.chain((0..2 + hierarchy.factors.len()).map(deviation));
    let mut out = Draws {
        disagreement: ratios.fold(1.0, f64::max),
        ..Draws::default()
    };
    for chain in chains {
        out.coefficients.extend(chain.coefficients);
        out.deviations.extend(chain.deviations);
    }
    Some(out)
}

/// Gelman and Rubin's ratio over halves of the chains.
///
/// # Source
/// A. Gelman et al., *Bayesian Data Analysis*, 3rd edition, section 11.4.
fn split_ratio(chains: &[Vec<f64>]) -> f64 {
    let halves: Vec<&[f64]> = (chains.iter())
        .flat_map(|c| {
            let (a, b) = c.split_at(c.len() / 2);
            [a, b]
        })
        .collect();
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let variance = |x: &[f64]| {
        let middle = mean(x);
        x.iter().map(|v| (v - middle).powi(2)).sum::<f64>() / (x.len() as f64 - 1.0)
    };
    let n = halves.first().map_or(0, |h| h.len()) as f64;
    let means: Vec<f64> = halves.iter().map(|h| mean(h)).collect();
    let within = halves.iter().map(|h| variance(h)).sum::<f64>() / halves.len() as f64;
    match within > 0.0 {
        true => ((n - 1.0) / n + variance(&means) / within).sqrt(),
        false => 1.0,
    }
}

/// Median and 95 % interval of draws.
pub fn median_and_95(mut draws: Vec<f64>) -> [f64; 3] {
    draws.sort_by(f64::total_cmp);
    [0.5, 0.025, 0.975].map(|share| quantile(&draws, share))
}

#[cfg(test)]
mod tests;
