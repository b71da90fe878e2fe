//! Draws from an unnormalised density within the unit box: an ensemble whose walkers move along
//! differences of others (differential evolution Monte Carlo: ter Braak, Statistics and Computing
//! 16, 2006), in two halves.
//!
//! For a one-dimensional normal density the 720 points kept by the plan below have an effective
//! size of 620 independent draws; with stretch moves (Goodman and Weare, 2010) it was 160, and
//! quantiles of few draws are biased inwards.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use sinew_model::cholesky;

/// Duration of the ensemble's run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    pub(super) burn_in: usize,
    pub(super) rounds: usize,
    /// Number of rounds between kept ensembles.
    pub(super) thinning: usize,
}

impl Plan {
    /// Plans a run for a number of parameters: an ensemble forgets its start in about ten rounds
    /// per parameter.
    pub(super) fn of(numbers: usize) -> Plan {
        let per = numbers.saturating_sub(3);
        Plan {
            burn_in: 100 + 30 * per,
            rounds: 180 + 60 * per,
            thinning: 6 + per,
        }
    }
}

/// Initial normal distribution of the walkers by the lower Cholesky factor of its precision, row by
/// row.
pub(super) struct Around {
    pub(super) centre: Vec<f64>,
    pub(super) factor: Vec<f64>,
}

impl Around {
    /// Point at `z` standard deviations from a centre, within the box.
    fn point(&self, centre: &[f64], z: &[f64]) -> Vec<f64> {
        let mut x = z.to_vec();
        cholesky::backward(&self.factor, z.len(), &mut x);
        let within = |(c, x): (&f64, f64)| (c + x).clamp(1e-6, 1.0 - 1e-6);
        centre.iter().zip(x).map(within).collect()
    }
}

/// Draws from walkers spread around an optimum and around `others`, in turn.
pub(super) fn ensemble(
    log_density: &dyn Fn(&[f64]) -> f64,
    start: &Around,
    others: &[Vec<f64>],
    plan: Plan,
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    /// Number of rounds between full differences, which lead from one optimum to another.
    const LEAP_INTERVAL: usize = 10;
    /// Spread of the length, so that few walkers reach more than a lattice.
    const SPREAD: f64 = 0.05;
    let d = start.centre.len();
    if d == 0 {
        return vec![Vec::new()];
    }
    let walkers = (6 * d).max(24).next_multiple_of(2);
    // Most walkers start from the curvature at the optimum, widened by one half; every sixth
    // anywhere in the box, so that an optimum on a bound or a second one is not missed.
    let mut points: Vec<Vec<f64>> = (0..walkers)
        .map(|w| {
            if w % 6 == 5 {
                return (0..d).map(|_| random.random()).collect();
            }
            let mut normal = || -> f64 { StandardNormal.sample(random) };
            let centre = match w % (others.len() + 1) {
                0 => &start.centre,
                other => &others[other - 1],
            };
            start.point(centre, &(0..d).map(|_| 1.5 * normal()).collect::<Vec<_>>())
        })
        .collect();
    let mut densities: Vec<f64> = points.iter().map(|p| log_density(p)).collect();
    let mut kept = Vec::new();
    let mut trial = vec![0.0; d];
    /// Log-density difference to the best walker above which a walker is lost: its surroundings
    /// cannot compensate the difference.
    const MAX_LOG_DENSITY_DIFFERENCE: f64 = 20.0;
    for round in 0..plan.burn_in + plan.rounds {
        if round == plan.burn_in / 2 || round == 3 * plan.burn_in / 4 {
            let best = densities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let found: Vec<usize> = (0..walkers)
                .filter(|w| densities[*w] > best - MAX_LOG_DENSITY_DIFFERENCE)
                .collect();
            for w in 0..walkers {
                if densities[w] <= best - MAX_LOG_DENSITY_DIFFERENCE && !found.is_empty() {
                    let other = found[random.random_range(0..found.len())];
                    points[w] = points[other].clone();
                    densities[w] = densities[other];
                }
            }
        }
        let length = if round % LEAP_INTERVAL == LEAP_INTERVAL - 1 {
            1.0
        } else {
            // Scale with the fastest convergence on a normal density.
            2.38 / (2.0 * d as f64).sqrt()
        };
        for half in 0..2 {
            for k in 0..walkers / 2 {
                let walker = 2 * k + half;
                let first = random.random_range(0..walkers / 2);
                let second = (first + random.random_range(1..walkers / 2)) % (walkers / 2);
                let of_others = |k: usize| 2 * k + 1 - half;
                let (first, second) = (of_others(first), of_others(second));
                let z: f64 = StandardNormal.sample(random);
                let length = length * (1.0 + SPREAD * z);
                for j in 0..d {
                    let step = points[first][j] - points[second][j];
                    trial[j] = points[walker][j] + length * step;
                }
                let density = log_density(&trial);
                let gain = density - densities[walker];
                let accept: f64 = random.random();
                if accept.ln() < gain {
                    points[walker].copy_from_slice(&trial);
                    densities[walker] = density;
                }
            }
        }
        if round >= plan.burn_in && (round - plan.burn_in).is_multiple_of(plan.thinning) {
            kept.extend(points.iter().cloned());
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    // Analytic value of `Lᵀ x = z`: `x₂ = 2/20`, `x₁ = (1 − 5 x₂)/10`.
    #[test]
    fn points_are_slanted_as_the_density_is_and_stay_in_the_box() {
        let around = Around {
            centre: vec![0.5, 0.5],
            factor: vec![10.0, 0.0, 5.0, 20.0],
        };
        let near = |z: [f64; 2], wanted: [f64; 2]| {
            let point = around.point(&around.centre, &z);
            let apart = point.iter().zip(wanted).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-12, "{point:?} {wanted:?}");
        };
        near([1.0, 2.0], [0.55, 0.6]);
        near([0.0, -40.0], [1.0 - 1e-6, 1e-6]);
    }

    #[test]
    fn correlated_normal_density_is_recovered() {
        // x, y with standard deviations 0.1 and correlation 0.9 around 0.5.
        let density = |p: &[f64]| {
            let (x, y) = ((p[0] - 0.5) / 0.1, (p[1] - 0.5) / 0.1);
            if p.iter().any(|p| !(0.0..=1.0).contains(p)) {
                return f64::NEG_INFINITY;
            }
            -0.5 * (x * x - 1.8 * x * y + y * y) / (1.0 - 0.81)
        };
        let plan = Plan {
            burn_in: 200,
            rounds: 6000,
            thinning: 3,
        };
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        // Starts with a third of the width and without the correlation.
        let start = Around {
            centre: vec![0.5, 0.5],
            factor: vec![30.0, 0.0, 0.0, 30.0],
        };
        let draws = ensemble(&density, &start, &[], plan, &mut random);
        let n = draws.len() as f64;
        let mean = draws.iter().map(|d| d[0]).sum::<f64>() / n;
        let variance = draws.iter().map(|d| (d[0] - mean).powi(2)).sum::<f64>() / n;
        let cross = draws
            .iter()
            .map(|d| (d[0] - mean) * (d[1] - 0.5))
            .sum::<f64>()
            / n;
        // 32 000 draws with an autocorrelation of about ten rounds: errors of 2 % of a deviation.
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        assert!((variance.sqrt() - 0.1).abs() < 0.006, "{variance}");
        assert!((cross / variance - 0.9).abs() < 0.03, "{cross}");
    }

    fn around(d: usize, centre: f64, std: f64) -> Around {
        let factor = (0..d * d).map(|k| if k % (d + 1) == 0 { 1.0 / std } else { 0.0 });
        Around {
            centre: vec![centre; d],
            factor: factor.collect(),
        }
    }

    #[test]
    fn second_optimum_and_plateau_are_found() {
        // Two thirds at 0.2, one third at 0.8 of the first number; the second is anything.
        let density = |p: &[f64]| {
            if p.iter().any(|p| !(0.0..=1.0).contains(p)) {
                return f64::NEG_INFINITY;
            }
            let at = |c: f64| (-0.5 * ((p[0] - c) / 0.03).powi(2)).exp();
            (2.0 * at(0.2) + at(0.8)).ln()
        };
        let mut share = 0.0;
        let mut middle = 0.0;
        const SEEDS: u64 = 40;
        for seed in 0..SEEDS {
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let mut start = around(2, 0.2, 0.05);
            start.centre[1] = 0.5;
            let draws = ensemble(&density, &start, &[], Plan::of(2), &mut random);
            let n = draws.len() as f64 * SEEDS as f64;
            share += draws.iter().filter(|d| d[0] > 0.5).count() as f64 / n;
            middle += draws.iter().map(|d| d[1]).sum::<f64>() / n;
        }
        // 20 000 draws; the optima are distinguished by the points close to each.
        assert!((share - 1.0 / 3.0).abs() < 0.03, "{share}");
        assert!((middle - 0.5).abs() < 0.02, "{middle}");
    }

    // Narrow optima in four dimensions: points anywhere in the box never reach them, and no weight
    // indicates a missing one.
    #[test]
    fn narrow_second_optimum_has_correct_share() {
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
            let start = around(4, 0.2, 0.03);
            let others = [vec![0.8; 4]];
            let draws = ensemble(&density, &start, &others, Plan::of(4), &mut random);
            let second = draws.iter().filter(|d| d[0] > 0.5).count();
            share += second as f64 / draws.len() as f64 / SEEDS as f64;
        }
        assert!((share - 0.5).abs() < 0.05, "{share}");
    }
}
