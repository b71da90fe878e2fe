//! Draws from a density known up to a factor, within the unit box: adaptive importance sampling.
//!
//! Points are proposed around the optimum and anywhere in the box, then around points that were likely, from a mixture of
//! Student's distributions. All points keep a weight, density over the mixture that made all of them (the balance heuristic:
//! Veach and Guibas, SIGGRAPH 1995; adaptive: Cornuet and others, Scand. J. Statistics 39, 2012), so that none is lost.
//! A density of few numbers costs a thousand evaluations, where a chain needs seven times as many. What such points can't
//! reach is left to the ensemble, which starts from them.

use super::cholesky::cholesky;
use super::sample::{Around, Plan, ensemble};
use rand::{Rng, RngExt};
use rand_distr::{ChiSquared, Distribution, StandardNormal};

/// Points handed out.
const KEPT: usize = 720;
/// Independent draws that the weights must be worth; quantiles then scatter as those of the ensemble.
const WORTH: f64 = 500.0;
/// Evaluations of the first round and of each later one.
const FIRST: usize = 160;
const ROUND: usize = 220;
/// Rounds at most.
const ROUNDS: usize = 8;
/// Likely points that a round's proposals stand around.
const CENTRES: usize = 40;
/// Share of a round that goes anywhere in the box: a broad second optimum is found by it. Narrow ones of several numbers are
/// found by the search alone, which hands them over.
const ANYWHERE: f64 = 0.12;
/// More numbers than this make a mixture miss too often.
const MOST_NUMBERS: usize = 8;

/// Student's distributions of one shape around several centres, with some of it all over the box.
struct Mixture {
    /// Lower Cholesky factor of the shape's covariance, row by row.
    factor: Vec<f64>,
    /// Centres after the factor's inverse.
    white: Vec<Vec<f64>>,
    centres: Vec<Vec<f64>>,
    freedom: f64,
    /// Normalisation of one component over their number, without the box's part.
    norm: f64,
    anywhere: f64,
}

impl Mixture {
    fn new(factor: Vec<f64>, centres: Vec<Vec<f64>>, anywhere: f64) -> Self {
        let d = centres.first().map_or(0, Vec::len);
        let freedom = freedom(d);
        let half = 0.5 * d as f64;
        let log_det: f64 = (0..d).map(|i| factor[i * d + i].ln()).sum();
        let log_norm = libm::lgamma(0.5 * freedom + half)
            - libm::lgamma(0.5 * freedom)
            - half * (freedom * std::f64::consts::PI).ln()
            - log_det;
        Self {
            white: centres.iter().map(|c| whiten(&factor, c)).collect(),
            norm: (1.0 - anywhere) * log_norm.exp() / centres.len().max(1) as f64,
            factor,
            centres,
            freedom,
            anywhere,
        }
    }

    /// Density at a point of the box.
    fn density(&self, x: &[f64]) -> f64 {
        let z = whiten(&self.factor, x);
        let sum: f64 = self
            .white
            .iter()
            .map(|c| {
                let apart: f64 = z.iter().zip(c).map(|(z, c)| (z - c) * (z - c)).sum();
                let r = 1.0 + apart / self.freedom;
                // (ν + d)/2 is 6 for every d.
                let cube = r * r * r;
                1.0 / (cube * cube)
            })
            .sum();
        self.anywhere + self.norm * sum
    }

    /// A point; it may lie outside the box, where nothing is.
    fn point(&self, random: &mut impl Rng) -> Vec<f64> {
        let d = self.centres.first().map_or(0, Vec::len);
        let somewhere: f64 = random.random();
        if somewhere < self.anywhere {
            return (0..d).map(|_| random.random()).collect();
        }
        let centre = &self.centres[random.random_range(0..self.centres.len())];
        let chi = ChiSquared::new(self.freedom).map_or(self.freedom, |chi| chi.sample(random));
        let stretch = (self.freedom / chi.max(f64::MIN_POSITIVE)).sqrt();
        let z: Vec<f64> = (0..d)
            .map(|_| {
                let z: f64 = StandardNormal.sample(random);
                stretch * z
            })
            .collect();
        (0..d)
            .map(|i| {
                let step: f64 = (0..=i).map(|j| self.factor[i * d + j] * z[j]).sum();
                centre[i] + step
            })
            .collect()
    }
}

/// Degrees of freedom that make the exponent `(ν + d)/2` six.
fn freedom(numbers: usize) -> f64 {
    (12.0 - numbers as f64).max(1.0)
}

/// `L⁻¹ x`.
fn whiten(factor: &[f64], x: &[f64]) -> Vec<f64> {
    let d = x.len();
    let mut z = vec![0.0; d];
    for i in 0..d {
        let told: f64 = (0..i).map(|j| factor[i * d + j] * z[j]).sum();
        z[i] = (x[i] - told) / factor[i * d + i];
    }
    z
}

/// Points with the logarithm of their density and the density of each round's mixture.
#[derive(Default)]
struct Cloud {
    points: Vec<Vec<f64>>,
    log_density: Vec<f64>,
    mixtures: Vec<(Mixture, usize)>,
    /// Sum over rounds of evaluations times density, for every point.
    proposed: Vec<f64>,
}

impl Cloud {
    /// Proposes and evaluates; points outside the box cost nothing but their place in the count.
    fn extend(
        &mut self,
        mixture: Mixture,
        count: usize,
        log_density: &dyn Fn(&[f64]) -> f64,
        random: &mut impl Rng,
    ) {
        let weight = count as f64;
        for (point, proposed) in self.points.iter().zip(&mut self.proposed) {
            *proposed += weight * mixture.density(point);
        }
        for _ in 0..count {
            let x = mixture.point(random);
            if x.iter().any(|x| !(0.0..=1.0).contains(x)) {
                continue;
            }
            let before: f64 = self
                .mixtures
                .iter()
                .map(|(m, n)| *n as f64 * m.density(&x))
                .sum();
            self.proposed.push(before + weight * mixture.density(&x));
            self.log_density.push(log_density(&x));
            self.points.push(x);
        }
        self.mixtures.push((mixture, count));
    }

    /// Weights that sum to one; none where no point is possible.
    fn weights(&self) -> Option<Vec<f64>> {
        let logs: Vec<f64> = (self.log_density.iter().zip(&self.proposed))
            .map(|(log, proposed)| log - proposed.ln())
            .collect();
        let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if !top.is_finite() {
            return None;
        }
        let raw: Vec<f64> = logs.iter().map(|log| (log - top).exp()).collect();
        let sum: f64 = raw.iter().sum();
        Some(raw.iter().map(|w| w / sum).collect())
    }

    /// So many points by their weights, evenly through the list.
    fn resampled(&self, weights: &[f64], count: usize, random: &mut impl Rng) -> Vec<Vec<f64>> {
        let offset: f64 = random.random();
        let mut out = Vec::with_capacity(count);
        let mut sum = 0.0;
        for (point, weight) in self.points.iter().zip(weights) {
            sum += weight * count as f64;
            while (out.len() as f64) + offset < sum && out.len() < count {
                out.push(point.clone());
            }
        }
        out
    }

    /// Proposals around likely points, as wide as what they leave open.
    fn mixture(&self, weights: &[f64], random: &mut impl Rng) -> Option<Mixture> {
        let centres = self.resampled(weights, CENTRES, random);
        let d = centres.first()?.len();
        let mut mean = vec![0.0; d];
        for (point, weight) in self.points.iter().zip(weights) {
            for (m, x) in mean.iter_mut().zip(point) {
                *m += weight * x;
            }
        }
        let mut covariance = vec![0.0; d * d];
        for (point, weight) in self.points.iter().zip(weights) {
            for i in 0..d {
                for j in 0..=i {
                    covariance[i * d + j] += weight * (point[i] - mean[i]) * (point[j] - mean[j]);
                }
            }
        }
        // Silverman's width for a normal density of d numbers, a fifth wider for the tails.
        let width = (4.0 / ((d as f64 + 2.0) * CENTRES as f64)).powf(1.0 / (d as f64 + 4.0));
        let factor = cholesky(&covariance, d, (1.2 * width).powi(2));
        Some(Mixture::new(factor, centres, ANYWHERE))
    }
}

/// Independent draws that weights are worth.
fn worth(weights: &[f64]) -> f64 {
    1.0 / weights.iter().map(|w| w * w).sum::<f64>()
}

/// Draws of equal weight around an optimum and the `others` that a search found.
pub(super) fn draws(
    log_density: &dyn Fn(&[f64]) -> f64,
    start: &Around,
    others: &[Vec<f64>],
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    let d = start.centre.len();
    if d == 0 {
        return vec![Vec::new()];
    }
    if d > MOST_NUMBERS {
        return ensemble(log_density, start, others, Plan::of(d), random);
    }
    let mut cloud = Cloud::default();
    // As the curvature at the optimum says, wider by a half; a third anywhere in the box.
    const FIRST_ANYWHERE: f64 = 0.3;
    let mut centres = vec![start.centre.clone()];
    centres.extend_from_slice(others);
    let count = FIRST * centres.len();
    let first = Mixture::new(start.spread(1.5), centres, FIRST_ANYWHERE);
    cloud.extend(first, count, log_density, random);
    for _ in 0..ROUNDS {
        let Some(weights) = cloud.weights() else {
            break;
        };
        if worth(&weights) >= WORTH {
            return cloud.resampled(&weights, KEPT, random);
        }
        let Some(mixture) = cloud.mixture(&weights, random) else {
            break;
        };
        cloud.extend(mixture, ROUND, log_density, random);
    }
    match cloud.weights() {
        // Quantiles scatter a little more; a chain's would not be better for the same evaluations.
        Some(weights) if worth(&weights) >= 0.5 * WORTH => cloud.resampled(&weights, KEPT, random),
        _ => ensemble(log_density, start, others, Plan::of(d), random),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use std::cell::Cell;

    fn around(d: usize, deviation: f64) -> Around {
        Around {
            centre: vec![0.5; d],
            factor: (0..d)
                .map(|i| {
                    (0..d)
                        .map(|j| if i == j { 1.0 / deviation } else { 0.0 })
                        .collect()
                })
                .collect(),
        }
    }

    #[test]
    fn a_slanted_normal_density_comes_back_for_a_seventh_of_the_evaluations() {
        // x, y with standard deviations 0.1 and correlation 0.9 around 0.5.
        let asked = Cell::new(0);
        let density = |p: &[f64]| {
            asked.set(asked.get() + 1);
            let (x, y) = ((p[0] - 0.5) / 0.1, (p[1] - 0.5) / 0.1);
            -0.5 * (x * x - 1.8 * x * y + y * y) / (1.0 - 0.81)
        };
        // Means over many seeds: the scatter of one is that of some 500 draws.
        let (mut mean, mut variance, mut cross) = (0.0, 0.0, 0.0);
        const SEEDS: u64 = 60;
        for seed in 0..SEEDS {
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            // Starts a third as wide as it should and without the correlation.
            let draws = draws(&density, &around(2, 0.1 / 3.0), &[], &mut random);
            let n = draws.len() as f64 * SEEDS as f64;
            for d in &draws {
                mean += (d[0] - 0.5) / n;
                variance += (d[0] - 0.5).powi(2) / n;
                cross += (d[0] - 0.5) * (d[1] - 0.5) / n;
            }
        }
        println!("{} evaluations each", asked.get() / SEEDS as usize);
        assert!(asked.get() < 1200 * SEEDS as usize);
        // 30 000 draws: 0.6 % of a deviation, 0.8 % of a variance.
        assert!(mean.abs() < 0.003, "{mean}");
        assert!((variance.sqrt() - 0.1).abs() < 0.002, "{variance}");
        assert!((cross / variance - 0.9).abs() < 0.01, "{cross}");
    }

    #[test]
    fn a_second_optimum_and_a_plateau_are_found() {
        // Two thirds at 0.2, one third at 0.8 of the first number; the second is anything.
        let density = |p: &[f64]| {
            let at = |c: f64| (-0.5 * ((p[0] - c) / 0.03).powi(2)).exp();
            (2.0 * at(0.2) + at(0.8)).ln()
        };
        let mut share = 0.0;
        let mut middle = 0.0;
        const SEEDS: u64 = 40;
        for seed in 0..SEEDS {
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let mut start = around(2, 0.05);
            start.centre = vec![0.2, 0.5];
            let draws = draws(&density, &start, &[], &mut random);
            let n = draws.len() as f64 * SEEDS as f64;
            share += draws.iter().filter(|d| d[0] > 0.5).count() as f64 / n;
            middle += draws.iter().map(|d| d[1]).sum::<f64>() / n;
        }
        // 20 000 draws; the two optima are told by points that fell there.
        assert!((share - 1.0 / 3.0).abs() < 0.03, "{share}");
        assert!((middle - 0.5).abs() < 0.02, "{middle}");
    }

    /// Narrow optima of four numbers: points anywhere in the box never fall there, and no weight tells that one is missing.
    #[test]
    fn a_narrow_optimum_that_the_search_found_has_its_share() {
        let density = |p: &[f64]| {
            let at = |c: f64| {
                let squares: f64 = p.iter().map(|x| ((x - c) / 0.03).powi(2)).sum();
                (-0.5 * squares).exp()
            };
            (at(0.2) + at(0.8)).ln()
        };
        let mut share = 0.0;
        const SEEDS: u64 = 20;
        for seed in 0..SEEDS {
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let mut start = around(4, 0.03);
            start.centre = vec![0.2; 4];
            let draws = draws(&density, &start, &[vec![0.8; 4]], &mut random);
            let second = draws.iter().filter(|d| d[0] > 0.5).count();
            share += second as f64 / draws.len() as f64 / SEEDS as f64;
        }
        assert!((share - 0.5).abs() < 0.05, "{share}");
    }
}
