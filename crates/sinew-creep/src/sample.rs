//! Draws from a density known up to a factor, within the unit box: an ensemble whose walkers move
//! along differences of others (differential evolution Monte Carlo: ter Braak, Statistics and
//! Computing 16, 2006), half by half.
//!
//! Of a normal density of one number the 720 points kept by the plan below are worth 620 independent
//! draws; with stretch moves (Goodman and Weare, 2010) they were worth 160, and quantiles of few draws
//! lie too far inside.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use sinew_model::cholesky;

/// Length of the ensemble's run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plan {
    pub(super) burn_in: usize,
    pub(super) rounds: usize,
    /// Every how many rounds the ensemble is kept.
    pub(super) thinning: usize,
}

impl Plan {
    /// A run for so many numbers: an ensemble forgets its start in some ten rounds for each.
    pub(super) fn of(numbers: usize) -> Plan {
        let per = numbers.saturating_sub(3);
        Plan {
            burn_in: 100 + 30 * per,
            rounds: 180 + 60 * per,
            thinning: 6 + per,
        }
    }
}

/// Where walkers start: a normal distribution by the lower Cholesky factor of its precision, row by row.
pub(super) struct Around {
    pub(super) centre: Vec<f64>,
    pub(super) factor: Vec<f64>,
}

impl Around {
    /// A point at so many standard deviations from a centre, within the box.
    fn point(&self, centre: &[f64], z: &[f64]) -> Vec<f64> {
        let mut x = z.to_vec();
        cholesky::backward(&self.factor, z.len(), &mut x);
        let within = |(c, x): (&f64, f64)| (c + x).clamp(1e-6, 1.0 - 1e-6);
        centre.iter().zip(x).map(within).collect()
    }
}

/// Draws, from walkers spread around an optimum and around `others`, in turn.
pub(super) fn ensemble(
    log_density: &dyn Fn(&[f64]) -> f64,
    start: &Around,
    others: &[Vec<f64>],
    plan: Plan,
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    /// Every so many rounds a whole difference, which leads from one optimum to another.
    const LEAP: usize = 10;
    /// Spread of the length, so that few walkers reach more than a lattice.
    const SPREAD: f64 = 0.05;
    let d = start.centre.len();
    if d == 0 {
        return vec![Vec::new()];
    }
    let walkers = (6 * d).max(24).next_multiple_of(2);
    // Most walkers start as the curvature at the optimum says, wider by a half; every sixth
    // anywhere in the box: an optimum on a bound or a second one is then not missed.
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
    /// A walker this far below the best (in the logarithm) is lost where nothing is: the
    /// flattest of its surroundings can't make up for it.
    const LOST: f64 = 20.0;
    for round in 0..plan.burn_in + plan.rounds {
        if round == plan.burn_in / 2 || round == 3 * plan.burn_in / 4 {
            let best = densities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let found: Vec<usize> = (0..walkers)
                .filter(|w| densities[*w] > best - LOST)
                .collect();
            for w in 0..walkers {
                if densities[w] <= best - LOST && !found.is_empty() {
                    let other = found[random.random_range(0..found.len())];
                    points[w] = points[other].clone();
                    densities[w] = densities[other];
                }
            }
        }
        let length = if round % LEAP == LEAP - 1 {
            1.0
        } else {
            // Accepts the share of moves that forgets fastest on a normal density.
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

    /// `Lᵀ x = z` by hand: `x₂ = 2/20`, `x₁ = (1 − 5 x₂)/10`.
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
    fn a_slanted_normal_density_comes_back() {
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
        // Starts a third as wide as it should and without the correlation.
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

    fn around(d: usize, centre: f64, deviation: f64) -> Around {
        let factor = (0..d * d).map(|k| {
            if k % (d + 1) == 0 {
                1.0 / deviation
            } else {
                0.0
            }
        });
        Around {
            centre: vec![centre; d],
            factor: factor.collect(),
        }
    }

    #[test]
    fn a_second_optimum_and_a_plateau_are_found() {
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
            let start = around(4, 0.2, 0.03);
            let others = [vec![0.8; 4]];
            let draws = ensemble(&density, &start, &others, Plan::of(4), &mut random);
            let second = draws.iter().filter(|d| d[0] > 0.5).count();
            share += second as f64 / draws.len() as f64 / SEEDS as f64;
        }
        assert!((share - 0.5).abs() < 0.05, "{share}");
    }
}
