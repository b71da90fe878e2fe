//! Propagation of the uncertainty of the rope law's fixed parameters to the fitted ones.
//!
//! A parameter that is not identifiable from the records keeps the base rope's value, which has an
//! interval. Each draw therefore uses its own value of it, and a search determines how the others
//! follow: bedding-in under one load depends on the fixed load ratio. Without this, intervals would
//! be those of a rope with certain fixed values. Replicates of a bootstrap follow in the same way;
//! a profile searches over the fixed parameters.

use super::model::Model;
use super::solver::{half_squares, minimum};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::ops::RangeInclusive;

/// Fixed parameter that affects the others.
struct Held {
    index: usize,
    /// Change of the nonlinear parameters at every one of [`ASIDE`], in the unit cube.
    shifts: [Vec<f64>; ASIDE.len()],
    /// Log-likelihood of the records at every one of [`ASIDE`], and its maximum.
    log_likelihood: [f64; ASIDE.len()],
    max_log_likelihood: f64,
}

/// Deviations of a fixed parameter at which the others are fitted again, in standard deviations.
const ASIDE: [f64; 7] = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0];
/// Index of the deviation 0, where the fit is.
const MIDDLE: usize = 3;

/// Indices of the three of [`ASIDE`] nearest to a deviation, and the weight of each in a parabola
/// through them.
fn parabola(z: f64) -> (RangeInclusive<usize>, [f64; 3]) {
    let middle = ((z - ASIDE[0]).round().max(1.0) as usize).min(ASIDE.len() - 2);
    let t = z - ASIDE[middle];
    let shares = [0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)];
    (middle - 1..=middle + 1, shares)
}

/// Dependence of draws on the fixed parameters.
#[derive(Default)]
pub(super) struct HeldDraws(Vec<Held>);

impl HeldDraws {
    /// Fits again at both sides of every fixed parameter that affects the fit.
    pub(super) fn of(model: &Model, centre: &[f64]) -> Self {
        let count = model.held_z.len();
        Self((0..count).filter_map(|i| held(model, centre, i)).collect())
    }

    /// Draws a shifted point, and the deviations of all fixed parameters.
    ///
    /// The searches for one fixed parameter at a time propose a draw, and its own likelihood
    /// accepts it: several that each keep a coefficient above zero need not do so together.
    pub(super) fn draw(
        &self,
        model: &Model,
        unit: &[f64],
        random: &mut impl Rng,
    ) -> (Vec<f64>, Vec<f64>) {
        /// Maximum number of proposals: records that reject all of them contradict the base rope's
        /// interval.
        const MAX_PROPOSALS: usize = 50;
        let log_likelihood = |x: &[f64], z: &[f64]| {
            let point =
                model.solve_values(&model.values_held(x, z), model.noise_at(x), false, None);
            -0.5 * (model.readings as f64 * point.squares.ln() + point.log_det_noise)
        };
        let here = log_likelihood(unit, &model.held_z);
        let mut last = (unit.to_vec(), model.held_z.clone());
        for _ in 0..MAX_PROPOSALS {
            let (moved, z, expected) = self.proposed(unit, model.held_z.len(), random);
            let taken = log_likelihood(&moved, &z) - here - expected;
            last = (moved, z);
            if random.random::<f64>().ln() <= taken {
                break;
            }
        }
        last
    }

    /// Proposes a draw from the searches, with its log-likelihood ratio to the point.
    fn proposed(
        &self,
        unit: &[f64],
        count: usize,
        random: &mut impl Rng,
    ) -> (Vec<f64>, Vec<f64>, f64) {
        let mut z: Vec<f64> = (0..count).map(|_| StandardNormal.sample(random)).collect();
        let mut moved = unit.to_vec();
        let mut expected = 0.0;
        for held in &self.0 {
            let own = held.stds(z[held.index], random);
            let (nearest, shares) = parabola(own);
            for (i, x) in moved.iter_mut().enumerate() {
                let shift = nearest.clone().zip(shares);
                *x += shift
                    .map(|(at, share)| share * held.shifts[at][i])
                    .sum::<f64>();
            }
            expected += held.log_likelihood(own);
            z[held.index] = own;
        }
        moved.iter_mut().for_each(|x| *x = x.clamp(0.0, 1.0));
        (moved, z, expected)
    }
}

/// Fixed parameters that affect the fit: the squares, or a coefficient that compensates them.
pub(super) fn moving(model: &Model, centre: &[f64]) -> Vec<usize> {
    /// Minimum relative change, beyond rounding errors.
    const MIN_RELATIVE_CHANGE: f64 = 1e-6;
    let numbers = |held_z: &[f64]| -> Vec<f64> {
        let values = model.values_held(centre, held_z);
        let point = model.solve_values(&values, model.noise_at(centre), false, None);
        let betas = point.solutions.iter().flat_map(|s| s.beta.iter().copied());
        betas.chain([point.squares]).collect()
    };
    let here = numbers(&model.held_z);
    let moves = |index: &usize| {
        let mut held_z = model.held_z.clone();
        held_z[*index] += 1.0;
        let aside = numbers(&held_z);
        (here.iter().zip(&aside))
            .any(|(a, b)| (a - b).abs() > MIN_RELATIVE_CHANGE * a.abs().max(b.abs()))
    };
    (0..model.held_z.len()).filter(moves).collect()
}

fn held(model: &Model, centre: &[f64], index: usize) -> Option<Held> {
    /// Minimum change of the squares at the optimum, over their variance, caused by one standard
    /// deviation.
    const MIN_EFFECT: f64 = 0.01;
    let cost = |model: &Model, x: &[f64]| half_squares(&model.residuals(x));
    let least = cost(model, centre);
    let n = model.readings as f64;
    let mut aside = model.clone();
    let mut moves = |z: f64| {
        aside.held_z[index] = z;
        n * (cost(&aside, centre) / least).ln().abs() > MIN_EFFECT
    };
    // Without an effect no search is needed.
    if !(moves(1.0) || moves(-1.0)) {
        return None;
    }
    let mut shifts: [Vec<f64>; ASIDE.len()] = std::array::from_fn(|_| vec![0.0; centre.len()]);
    let mut squares = [least; ASIDE.len()];
    // Each search starts from the end of the previous one.
    let sides: [Vec<usize>; 2] = [
        (MIDDLE + 1..ASIDE.len()).collect(),
        (0..MIDDLE).rev().collect(),
    ];
    for side in sides {
        let mut from = centre.to_vec();
        for at in side {
            aside.held_z[index] = ASIDE[at];
            let found = minimum(&|x| aside.residuals(x), &from, 40);
            shifts[at] = found.x.iter().zip(centre).map(|(x, c)| x - c).collect();
            squares[at] = found.cost;
            from = found.x;
        }
    }
    let log_likelihood = squares.map(|s| -0.5 * n * (s / least).ln());
    Some(Held {
        index,
        shifts,
        max_log_likelihood: log_likelihood.into_iter().fold(f64::MIN, f64::max),
        log_likelihood,
    })
}

impl Held {
    /// Log-likelihood at a deviation of `z` standard deviations.
    fn log_likelihood(&self, z: f64) -> f64 {
        let (nearest, shares) = parabola(z);
        (nearest.zip(shares))
            .map(|(at, share)| share * self.log_likelihood[at])
            .sum()
    }

    /// Draws a deviation from the base rope's interval (`first` is a draw of it), accepted by the
    /// likelihood of the records.
    fn stds(&self, first: f64, random: &mut impl Rng) -> f64 {
        /// Maximum number of draws: records that reject all of them contradict the base rope's
        /// interval; the most probable remains.
        const MAX_DRAWS: usize = 10_000;
        let mut z = first;
        for _ in 0..MAX_DRAWS {
            if random.random::<f64>().ln() <= self.log_likelihood(z) - self.max_log_likelihood {
                return z;
            }
            z = StandardNormal.sample(random);
        }
        let best = (0..ASIDE.len())
            .max_by(|a, b| self.log_likelihood[*a].total_cmp(&self.log_likelihood[*b]));
        ASIDE[best.unwrap_or(MIDDLE)]
    }
}
