//! Markov chain of the hierarchical model: Metropolis steps of the standard deviations with the coefficients integrated out, then
//! exact draws of the coefficients, then of the outlying groups.

use super::gram::{Gram, Posterior};
use super::{Draws, Hierarchy, Unit};
use nalgebra::DVector;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Gamma, StandardNormal};

/// Prior share of outlying groups of a heavy-tailed factor, and scale of the Cauchy distribution of their deviations.
const OUTLIER_SHARE: f64 = 0.1;
const OUTLIER_SCALE: f64 = 0.3;
/// Scales of the half-Cauchy priors of the standard deviations between tendons and between robots.
const TENDON_SCALE: f64 = 0.5;
const ROBOT_SCALE: f64 = 0.2;
/// Lower bound of a `τ`; smaller values are 0 for every purpose.
const MIN_STD: f64 = 1e-3;
/// Target acceptance rate during warm-up.
const TARGET_ACCEPTANCE: f64 = 0.35;

pub(super) struct Chain<'a> {
    model: &'a Hierarchy,
    rng: ChaCha8Rng,
    /// Standard deviations `τ` of tendons, robots and factors.
    stds: Vec<f64>,
    /// Variance of each column beyond that of its factor; 0 if it is not outlying.
    added_variance: Vec<f64>,
    /// Added variance of a column if it is outlying.
    outlier_variance: Vec<f64>,
    /// Proposal widths of ln τ.
    steps: Vec<f64>,
    /// Sums for the current `τ` of tendons and robots, from the previous step.
    gram: Option<Gram>,
}

impl<'a> Chain<'a> {
    pub(super) fn new(model: &'a Hierarchy, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let count = 2 + model.factors.len();
        // Dispersed starting points reveal a lack of convergence.
        let stds = (0..count)
            .map(|_| 0.5 * rng.random::<f64>() + 0.02)
            .collect();
        Self {
            model,
            rng,
            stds,
            added_variance: vec![0.0; model.columns()],
            outlier_variance: vec![OUTLIER_SCALE * OUTLIER_SCALE; model.columns()],
            steps: vec![0.3; count],
            gram: None,
        }
    }

    /// Returns the draws after warm-up; `None` if the equations are singular.
    pub(super) fn run(mut self, warm_up: usize, kept: usize) -> Option<Draws> {
        let mut out = Draws::default();
        for i in 0..warm_up + kept {
            let adapt = (i < warm_up).then(|| 2.0 / (i as f64 + 4.0).sqrt());
            let drawn = self.step(adapt)?;
            if i >= warm_up {
                out.coefficients.push(drawn);
                out.stds.push(self.stds.clone());
            }
        }
        Some(out)
    }

    fn step(&mut self, adapt: Option<f64>) -> Option<Vec<f64>> {
        let mut gram = self.gram.take().unwrap_or_else(|| self.sums());
        let mut now = self.posterior(&gram)?;
        for which in 0..self.stds.len() {
            let before = self.stds.clone();
            let old = now.log_evidence + self.log_prior();
            let step = self.steps[which] * self.normal();
            self.move_by(which, step);
            // The sums depend on tendons and robots; factors affect the prior only.
            let possible = self.stds.iter().all(|d| *d >= MIN_STD);
            let other = (which < 2 && possible).then(|| self.sums());
            let proposed = match possible {
                true => self.posterior(other.as_ref().unwrap_or(&gram)),
                false => None,
            };
            let odds = proposed.as_ref().map_or(f64::NEG_INFINITY, |p| {
                p.log_evidence + self.log_prior() - old
            });
            let taken = self.rng.random::<f64>().ln() < odds;
            match proposed.filter(|_| taken) {
                Some(proposed) => {
                    now = proposed;
                    gram = other.unwrap_or(gram);
                }
                None => self.stds = before,
            }
            if let Some(rate) = adapt {
                let towards = odds.exp().min(1.0) - TARGET_ACCEPTANCE;
                self.steps[which] = (self.steps[which] * (rate * towards).exp()).clamp(0.02, 3.0);
            }
        }
        let normals = (0..self.model.columns()).map(|_| StandardNormal.sample(&mut self.rng));
        let normals = DVector::from_iterator(self.model.columns(), normals);
        let drawn = now.draw(normals);
        self.draw_outliers(&drawn);
        self.gram = Some(gram);
        Some(drawn)
    }

    /// Proposes new standard deviations. Those of tendons and robots are poorly identified separately if robots have few tendons,
    /// but their sum of squares is identified: both are scaled together, and then their ratio is changed at a constant sum. The
    /// Jacobian of both moves in the logarithms is 1.
    fn move_by(&mut self, which: usize, step: f64) {
        let [tendon, robot] = [self.stds[0], self.stds[1]];
        match which {
            0 => self.stds[..2].iter_mut().for_each(|d| *d *= step.exp()),
            1 => {
                let total = tendon.hypot(robot);
                let ratio = robot / tendon * step.exp();
                self.stds[0] = total / ratio.hypot(1.0);
                self.stds[1] = self.stds[0] * ratio;
            }
            _ => self.stds[which] *= step.exp(),
        }
    }

    fn sums(&self) -> Gram {
        let [tendon, robot] = [self.stds[0], self.stds[1]];
        let own = |unit: &Unit| unit.variance + (tendon * unit.spread).powi(2);
        Gram::of(self.model, own, robot * robot)
    }

    fn posterior(&self, gram: &Gram) -> Option<Posterior> {
        let fixed = self.model.fixed.iter().map(|d| 1.0 / (d * d));
        let mut precision: Vec<f64> = fixed.collect();
        for (factor, std) in self.model.factors.iter().zip(&self.stds[2..]) {
            let columns = factor.first..factor.first + factor.levels;
            let of = columns.map(|c| 1.0 / (std * std + self.added_variance[c]));
            precision.extend(of);
        }
        gram.posterior(&precision)
    }

    /// Log prior density of ln τ. Tendons and robots: half-Cauchy. Factors: `τ / (1 + (τ/scale)²)^1.5`, with equal tail and 0 at 0.
    fn log_prior(&self) -> f64 {
        let half_cauchy = |(d, scale): (&f64, f64)| d.ln() - (d / scale).powi(2).ln_1p();
        let from_zero = |(d, scale): (&f64, f64)| 2.0 * d.ln() - 1.5 * (d / scale).powi(2).ln_1p();
        let (own, factors) = self.stds.split_at(2);
        let scales = self.model.factors.iter().map(|f| f.scale);
        let own: f64 = own
            .iter()
            .zip([TENDON_SCALE, ROBOT_SCALE])
            .map(half_cauchy)
            .sum();
        own + factors.iter().zip(scales).map(from_zero).sum::<f64>()
    }

    /// Draws the outlying groups and their variances.
    fn draw_outliers(&mut self, drawn: &[f64]) {
        for (factor, std) in self.model.factors.iter().zip(&self.stds[2..]) {
            for c in (factor.first..factor.first + factor.levels).filter(|_| factor.heavy) {
                let usual = std * std;
                let (is_outlier, beyond) =
                    draw_outlier(drawn[c], usual, self.outlier_variance[c], &mut self.rng);
                self.added_variance[c] = if is_outlier { beyond } else { 0.0 };
                self.outlier_variance[c] = beyond;
            }
        }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }
}

/// Draws whether a group is outlying and its additional variance, by Gibbs steps. The Cauchy distribution is a normal one
/// with a random variance.
///
/// * `effect`: of the group, with variance `usual`, plus `beyond` if it is outlying.
fn draw_outlier(effect: f64, usual: f64, beyond: f64, rng: &mut ChaCha8Rng) -> (bool, f64) {
    let whole = usual + beyond;
    let log_ratio = 0.5 * ((usual / whole).ln() + effect * effect * (1.0 / usual - 1.0 / whole));
    let against = (1.0 - OUTLIER_SHARE) / OUTLIER_SHARE * (-log_ratio).exp();
    let is_outlier = rng.random::<f64>() * (1.0 + against) < 1.0;
    let mut shape = 0.5;
    let mut off = 0.0;
    if is_outlier {
        // Part of the effect due to the additional variance.
        let share = beyond / whole;
        let normal: f64 = StandardNormal.sample(rng);
        off = (share * effect + (share * usual).sqrt() * normal) / OUTLIER_SCALE;
        shape += 0.5;
    }
    let gamma = Gamma::new(shape, 2.0 / (1.0 + off * off));
    let drawn = gamma.map_or(1.0, |g| 1.0 / g.sample(rng).max(1e-12));
    (is_outlier, OUTLIER_SCALE * OUTLIER_SCALE * drawn)
}
