//! One chain of draws: how far everything differs by Metropolis' rule with the coefficients integrated out, then these exactly,
//! then which groups stray.

use super::gram::{Gram, Posterior};
use super::{Draws, Hierarchy, Unit};
use nalgebra::DVector;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Gamma, StandardNormal};

/// Share of groups that stray, where single ones may, and scale of how far these do: Cauchy's distribution.
const STRAY_SHARE: f64 = 0.1;
const STRAY_SCALE: f64 = 0.3;
/// Scale of the half-Cauchy priors of what tendons and robots differ by.
const TENDON_SCALE: f64 = 0.5;
const ROBOT_SCALE: f64 = 0.2;
/// A `τ` is no smaller than this: below it is 0 for every purpose.
const LEAST: f64 = 1e-3;
/// Share of proposals that are taken, aimed at while warming up.
const TAKEN: f64 = 0.35;

pub(super) struct Chain<'a> {
    model: &'a Hierarchy,
    rng: ChaCha8Rng,
    /// `τ` of tendons, robots, and factors.
    deviations: Vec<f64>,
    /// Of each column what its variance is beyond that of its factor: 0 where it doesn't stray.
    strayed: Vec<f64>,
    /// What that variance is where it strays.
    if_strayed: Vec<f64>,
    /// Widths of the proposals, over ln τ.
    steps: Vec<f64>,
    /// Sums for the present `τ` of tendons and robots, from the step before.
    gram: Option<Gram>,
}

impl<'a> Chain<'a> {
    pub(super) fn new(model: &'a Hierarchy, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let count = 2 + model.factors.len();
        // Chains start apart, so that it shows whether they come together.
        let deviations = (0..count)
            .map(|_| 0.5 * rng.random::<f64>() + 0.02)
            .collect();
        Self {
            model,
            rng,
            deviations,
            strayed: vec![0.0; model.columns()],
            if_strayed: vec![STRAY_SCALE * STRAY_SCALE; model.columns()],
            steps: vec![0.3; count],
            gram: None,
        }
    }

    /// The draws that are kept. `None`: the equations have no solution.
    pub(super) fn run(mut self, warm_up: usize, kept: usize) -> Option<Draws> {
        let mut out = Draws::default();
        for i in 0..warm_up + kept {
            let adapt = (i < warm_up).then(|| 2.0 / (i as f64 + 4.0).sqrt());
            let drawn = self.step(adapt)?;
            if i >= warm_up {
                out.coefficients.push(drawn);
                out.deviations.push(self.deviations.clone());
            }
        }
        Some(out)
    }

    fn step(&mut self, adapt: Option<f64>) -> Option<Vec<f64>> {
        let mut gram = self.gram.take().unwrap_or_else(|| self.sums());
        let mut now = self.posterior(&gram)?;
        for which in 0..self.deviations.len() {
            let before = self.deviations.clone();
            let old = now.log_evidence + self.log_prior();
            let step = self.steps[which] * self.normal();
            self.move_by(which, step);
            // Tendons and robots are in the sums; factors are in the prior alone.
            let possible = self.deviations.iter().all(|d| *d >= LEAST);
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
                None => self.deviations = before,
            }
            if let Some(rate) = adapt {
                let towards = odds.exp().min(1.0) - TAKEN;
                self.steps[which] = (self.steps[which] * (rate * towards).exp()).clamp(0.02, 3.0);
            }
        }
        let normals = (0..self.model.columns()).map(|_| StandardNormal.sample(&mut self.rng));
        let normals = DVector::from_iterator(self.model.columns(), normals);
        let drawn = now.draw(normals);
        self.stray_groups(&drawn);
        self.gram = Some(gram);
        Some(drawn)
    }

    /// Moves the deviations. Those of tendons and robots are hard to tell apart where robots have few tendons, but their sum of
    /// squares isn't: so both are moved together, and then one against the other with that sum kept. Over their logarithms
    /// neither move stretches anything.
    fn move_by(&mut self, which: usize, step: f64) {
        let [tendon, robot] = [self.deviations[0], self.deviations[1]];
        match which {
            0 => self.deviations[..2]
                .iter_mut()
                .for_each(|d| *d *= step.exp()),
            1 => {
                let total = tendon.hypot(robot);
                let ratio = robot / tendon * step.exp();
                self.deviations[0] = total / ratio.hypot(1.0);
                self.deviations[1] = self.deviations[0] * ratio;
            }
            _ => self.deviations[which] *= step.exp(),
        }
    }

    fn sums(&self) -> Gram {
        let [tendon, robot] = [self.deviations[0], self.deviations[1]];
        let own = |unit: &Unit| unit.variance + (tendon * unit.spread).powi(2);
        Gram::of(self.model, own, robot * robot)
    }

    fn posterior(&self, gram: &Gram) -> Option<Posterior> {
        let fixed = self.model.fixed.iter().map(|d| 1.0 / (d * d));
        let mut precision: Vec<f64> = fixed.collect();
        for (factor, deviation) in self.model.factors.iter().zip(&self.deviations[2..]) {
            let columns = factor.first..factor.first + factor.levels;
            let of = columns.map(|c| 1.0 / (deviation * deviation + self.strayed[c]));
            precision.extend(of);
        }
        gram.posterior(&precision)
    }

    /// Over ln τ. Tendons and robots: half-Cauchy. Factors: `τ / (1 + (τ/scale)²)^1.5`, which ends as that does and begins at 0.
    fn log_prior(&self) -> f64 {
        let half_cauchy = |(d, scale): (&f64, f64)| d.ln() - (d / scale).powi(2).ln_1p();
        let from_zero = |(d, scale): (&f64, f64)| 2.0 * d.ln() - 1.5 * (d / scale).powi(2).ln_1p();
        let (own, factors) = self.deviations.split_at(2);
        let scales = self.model.factors.iter().map(|f| f.scale);
        let own: f64 = own
            .iter()
            .zip([TENDON_SCALE, ROBOT_SCALE])
            .map(half_cauchy)
            .sum();
        own + factors.iter().zip(scales).map(from_zero).sum::<f64>()
    }

    /// Draws which groups stray, and how far those do.
    fn stray_groups(&mut self, drawn: &[f64]) {
        for (factor, deviation) in self.model.factors.iter().zip(&self.deviations[2..]) {
            for c in (factor.first..factor.first + factor.levels).filter(|_| factor.heavy) {
                let usual = deviation * deviation;
                let (strays, beyond) = stray(drawn[c], usual, self.if_strayed[c], &mut self.rng);
                self.strayed[c] = if strays { beyond } else { 0.0 };
                self.if_strayed[c] = beyond;
            }
        }
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }
}

/// Whether a group strays, and the variance that it has beyond others if it does: one after the other from what each is given
/// the rest. Cauchy's distribution is a normal one whose variance is drawn.
///
/// * `effect`: of the group, of variance `usual`, plus `beyond` where it strays.
fn stray(effect: f64, usual: f64, beyond: f64, rng: &mut ChaCha8Rng) -> (bool, f64) {
    let whole = usual + beyond;
    let log_ratio = 0.5 * ((usual / whole).ln() + effect * effect * (1.0 / usual - 1.0 / whole));
    let against = (1.0 - STRAY_SHARE) / STRAY_SHARE * (-log_ratio).exp();
    let strays = rng.random::<f64>() * (1.0 + against) < 1.0;
    let mut shape = 0.5;
    let mut off = 0.0;
    if strays {
        // Of the effect the part by which it strays.
        let share = beyond / whole;
        let normal: f64 = StandardNormal.sample(rng);
        off = (share * effect + (share * usual).sqrt() * normal) / STRAY_SCALE;
        shape += 0.5;
    }
    let gamma = Gamma::new(shape, 2.0 / (1.0 + off * off));
    let drawn = gamma.map_or(1.0, |g| 1.0 / g.sample(rng).max(1e-12));
    (strays, STRAY_SCALE * STRAY_SCALE * drawn)
}
