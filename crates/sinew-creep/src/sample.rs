//! Draws from a density known up to a factor, within the unit box: an ensemble whose walkers move
//! along differences of others (differential evolution Monte Carlo: ter Braak, Statistics and
//! Computing 16, 2006), half by half.
//!
//! Of a normal density of one number the 720 points kept by the plan below are worth 620 independent
//! draws; with stretch moves (Goodman and Weare, 2010) they were worth 160, and quantiles of few draws
//! lie too far inside.

use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

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

/// Where walkers start: a normal distribution by the lower Cholesky factor of its precision.
pub(super) struct Around {
    pub(super) centre: Vec<f64>,
    pub(super) factor: Vec<Vec<f64>>,
}

impl Around {
    /// Lower Cholesky factor of the covariance, row by row, with deviations so many times as large.
    pub(super) fn spread(&self, times: f64) -> Vec<f64> {
        let d = self.centre.len();
        // Columns of L⁻ᵀ: covariance (L Lᵀ)⁻¹ = L⁻ᵀ L⁻¹.
        let mut inverse = vec![vec![0.0; d]; d];
        for (k, column) in inverse.iter_mut().enumerate() {
            for i in (0..d).rev() {
                let unit = if i == k { 1.0 } else { 0.0 };
                let told: f64 = (i + 1..d).map(|j| self.factor[j][i] * column[j]).sum();
                column[i] = (unit - told) / self.factor[i][i];
            }
        }
        let mut covariance = vec![0.0; d * d];
        for i in 0..d {
            for j in 0..=i {
                covariance[i * d + j] = inverse.iter().map(|column| column[i] * column[j]).sum();
            }
        }
        super::cholesky::cholesky(&covariance, d, times * times)
    }

    /// A point at so many standard deviations from a centre, within the box.
    fn point(&self, centre: &[f64], z: &[f64]) -> Vec<f64> {
        let d = z.len();
        let mut x = z.to_vec();
        for i in (0..d).rev() {
            for k in i + 1..d {
                x[i] -= self.factor[k][i] * x[k];
            }
            x[i] /= self.factor[i][i];
        }
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
            factor: vec![vec![10.0, 0.0], vec![5.0, 20.0]],
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
            factor: vec![vec![30.0, 0.0], vec![0.0, 30.0]],
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
}
