//! Hierarchical model of groups of tendons, for few and for many tendons per group.
//!
//! Each tendon `i` of robot `r` has a logarithm `z` with the measurement variance `v`:
//!
//! `z_i = x_iᵀ β + Σ_f u_f(i) + b_r + e_i + N(0, v_i)`
//!
//! \| term \| meaning \| prior \|
//! |---|---|---|
//! | `β` | kinds of tendon, covariates | normal, wide |
//! \| `u_0` \| compared groups \| normal, `τ_0`; one in ten is outlying, so that a bad group is not shrunk towards the good ones \|
//! \| `u_f` \| other factors: batches, sites \| as groups for batches, normal for sites, `τ_f` \|
//! | `b_r` | robots | normal, `τ_robot` |
//! \| `e_i` \| tendons \| normal, `τ_tendon` times the spread of their kind; the caller clips outliers \|
//! \| `τ` \| standard deviations \| half-Cauchy; of groups and factors with density 0 at 0, as no two are identical \|
//!
//! All results are based on draws of the joint posterior ([`sample`]), which includes the uncertainty of the `τ`: a factor with four
//! levels contains little information about its `τ`.

mod chain;
mod gram;

use chain::Chain;
use rayon::prelude::*;
use sinew_model::statistics::quantile;

/// Number of chains with dispersed starting points.
const CHAINS: u64 = 4;
/// Numbers of warm-up draws and of kept draws per chain.
const WARM_UP: usize = 400;
const KEPT: usize = 1000;

/// Observation of a tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Logarithm of its creep.
    pub value: f64,
    /// Variance of its measurement.
    pub variance: f64,
    /// Factor of `τ_tendon` for the kind of the tendon.
    pub spread: f64,
    /// Index of the robot; tendons of one robot are consecutive.
    pub robot: usize,
    /// Nonzero entries of its row of the design matrix: column and value.
    pub columns: Vec<(usize, f64)>,
}

/// Factor whose levels have a common distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// First column of the factor.
    pub first: usize,
    /// Number of levels, one column each.
    pub levels: usize,
    /// Scale of the prior of its standard deviation.
    pub scale: f64,
    /// Whether its levels are heavy-tailed.
    pub heavy: bool,
}

/// Hierarchical model: tendons, fixed columns and factors.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Hierarchy {
    /// Tendons, ordered by robot.
    pub units: Vec<Unit>,
    /// Standard deviation of the prior of each fixed column, from column 0.
    pub fixed: Vec<f64>,
    /// Factors, whose columns follow the fixed ones.
    pub factors: Vec<Factor>,
}

impl Hierarchy {
    /// Returns the number of columns.
    pub fn columns(&self) -> usize {
        self.fixed.len() + self.factors.iter().map(|f| f.levels).sum::<usize>()
    }
}

/// Draws of the posterior.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Draws {
    /// Coefficients of all columns, for each draw.
    pub coefficients: Vec<Vec<f64>>,
    /// Values of `τ` of tendons, of robots and of each factor, for each draw.
    pub stds: Vec<Vec<f64>>,
    /// Largest ratio of between-chain to within-chain estimates over all coefficients and `τ`; 1 at convergence.
    pub disagreement: f64,
}

impl Draws {
    /// Whether the chains have converged; otherwise no verdict is allowed.
    pub fn have_converged(&self) -> bool {
        /// Maximum ratio of converged chains.
        const MAX_RATIO: f64 = 1.1;
        self.disagreement <= MAX_RATIO
    }
}

/// Draws from the posterior: four chains, 4,000 draws; equal seeds give equal draws.
///
/// Returns `None` if a value or a variance is not finite or a variance is not positive.
pub fn sample(hierarchy: &Hierarchy, seed: u64) -> Option<Draws> {
    let chains: Vec<Draws> = (0..CHAINS)
        .into_par_iter()
        .map(|i| Chain::new(hierarchy, seed.wrapping_add(i)).run(WARM_UP, KEPT))
        .collect::<Option<_>>()?;
    let coefficient = |i: usize| {
        let of = |chain: &Draws| chain.coefficients.iter().map(|draw| draw[i]).collect();
        split_ratio(&chains.iter().map(of).collect::<Vec<_>>())
    };
    // Standard deviations are compared by their logarithms; some are near 0.
    let std = |i: usize| {
        let of = |chain: &Draws| chain.stds.iter().map(|draw| draw[i].ln()).collect();
        split_ratio(&chains.iter().map(of).collect::<Vec<_>>())
    };
    let ratios = (0..hierarchy.columns()).map(coefficient);
    let ratios = ratios.chain((0..2 + hierarchy.factors.len()).map(std));
    let mut out = Draws {
        disagreement: ratios.fold(1.0, f64::max),
        ..Draws::default()
    };
    for chain in chains {
        out.coefficients.extend(chain.coefficients);
        out.stds.extend(chain.stds);
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
