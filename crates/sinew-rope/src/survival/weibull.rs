//! Ropes that age by a power of their age.

use super::{HALF_CHI2_95, Lifetime};
use sinew_model::{Interval95, Z95};

/// Range of the shape: below it almost all ropes break immediately, above it all break at the same age.
const SHAPES: [f64; 2] = [0.02, 50.0];
/// Number of bisections, which reduce an interval to 1e-15 of its width.
const HALVINGS: usize = 60;

/// Share of ropes that last longer than an age `t`: `S(t) = exp(−(t/λ)^k)`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Weibull {
    /// `k`: above 1 ropes wear, below 1 weak ropes break first, at 1 the hazard does not depend on age.
    pub shape: f64,
    /// `λ`: the age that 1/e, 37 %, outlast.
    pub scale: f64,
}

impl Weibull {
    /// Share of ropes that last longer than `age`.
    #[must_use]
    pub fn survival(&self, age: f64) -> f64 {
        libm::exp(-libm::pow(age.max(0.0) / self.scale, self.shape))
    }

    /// Age that a share of the ropes does not outlast.
    #[must_use]
    pub fn quantile(&self, share: f64) -> f64 {
        self.quantile_beyond(0.0, share)
    }

    /// Age by which a share of those that have reached `age` has broken:
    /// `λ ((age/λ)^k − ln(1 − share))^(1/k)`.
    #[must_use]
    pub fn quantile_beyond(&self, age: f64, share: f64) -> f64 {
        let reached = libm::pow(age.max(0.0) / self.scale, self.shape);
        self.scale * libm::pow(reached - libm::log1p(-share), 1.0 / self.shape)
    }
}

/// Weibull distribution fitted by maximum likelihood, with likelihood intervals of its parameters.
///
/// ```text
/// ln L = Σ_broke [ln k − k ln λ + (k − 1) ln t] − Σ_all (t/λ)^k
/// ```
///
/// An interval contains the values whose profile log-likelihood is at most 1.92 below the maximum (Wilks).
/// With few broken ropes it is asymmetric; with fewer than ten its coverage is slightly too small.
///
/// # Source
/// W. Q. Meeker, L. A. Escobar, *Statistical Methods for Reliability Data*, 1998, chapter 8.
#[derive(Debug, Clone, PartialEq)]
pub struct WeibullFit {
    /// Distribution of maximum likelihood.
    pub law: Weibull,
    /// Maximum of the log-likelihood.
    pub log_likelihood: f64,
    /// 95 % interval of the shape; `None` at an end: open there.
    pub shape_interval_95: [Option<f64>; 2],
    sums: Sums,
}

/// Sufficient sums of the lifetimes, with ages divided by their geometric mean.
#[derive(Debug, Clone, PartialEq)]
struct Sums {
    /// Logarithms of all ages.
    logs: Vec<f64>,
    /// Logarithm of the unit they are in.
    unit: f64,
    /// Ropes that broke.
    broke: f64,
    /// Sum of the logarithms of their ages.
    log_broke: f64,
}

impl WeibullFit {
    /// Fits the distribution; `None` if fewer than two ropes broke, or all at one age, so that the likelihood
    /// has no maximum.
    #[must_use]
    pub fn new(lives: &[Lifetime]) -> Option<Self> {
        let sums = Sums::new(lives).filter(|sums| sums.broke >= 2.0)?;
        let shape = root(SHAPES, |k| sums.slope(k))?;
        let scale = sums.scale(shape);
        let log_likelihood = sums.log_likelihood(shape, scale);
        let floor = log_likelihood - HALF_CHI2_95;
        let profile = |k: f64| sums.log_likelihood(k, sums.scale(k)) - floor;
        let shape_interval_95 = [
            root([SHAPES[0], shape], profile),
            root([shape, SHAPES[1]], profile),
        ];
        Some(Self {
            law: Weibull {
                shape,
                scale: libm::exp(scale + sums.unit),
            },
            log_likelihood: log_likelihood - sums.broke * sums.unit,
            shape_interval_95,
            sums,
        })
    }

    /// 95 % interval of the age that a share of the ropes does not outlast; of the scale for `1 − 1/e`.
    /// `None`: the interval is unbounded at that end.
    #[must_use]
    pub fn quantile_interval_95(&self, share: f64) -> [Option<f64>; 2] {
        let hazard = -libm::log1p(-share);
        let best = libm::log(self.law.quantile(share)) - self.sums.unit;
        let profile = |log_age: f64| self.profile(log_age, hazard);
        let inner = |outer: f64| {
            let end = root_of([best, outer], profile)?;
            Some(libm::exp(end + self.sums.unit))
        };
        [inner(best - REACH), inner(best + REACH)]
    }

    /// 95 % interval of the share that lasts longer than an age.
    #[must_use]
    pub fn survival_interval_95(&self, age: f64) -> Interval95 {
        let log_age = libm::log(age) - self.sums.unit;
        let best = libm::log(-libm::log(
            self.law.survival(age).clamp(1e-300, 1.0 - 1e-16),
        ));
        let profile = |log_hazard: f64| self.profile(log_age, libm::exp(log_hazard));
        let at = |outer: f64, open: f64| {
            root_of([best, outer], profile).map_or(open, |h| libm::exp(-libm::exp(h)))
        };
        Interval95::new(at(best + REACH, 0.0), at(best - REACH, 1.0))
    }

    /// Remainder of the decrease of 1.92 in ln L at which the hazard reaches `hazard` at an age, with the
    /// shape free.
    fn profile(&self, log_age: f64, hazard: f64) -> f64 {
        // λ = age / hazard^(1/k)
        let scale = |k: f64| log_age - libm::log(hazard) / k;
        let slope = |k: f64| self.sums.slope_through(k, log_age, hazard);
        let shape = root(SHAPES, slope).unwrap_or(match slope(SHAPES[0]) > 0.0 {
            true => SHAPES[1],
            false => SHAPES[0],
        });
        let best = self.log_likelihood + self.sums.broke * self.sums.unit;
        self.sums.log_likelihood(shape, scale(shape)) - best + HALF_CHI2_95
    }
}

/// Posterior of the Weibull shape, with the scale integrated out.
///
/// ```text
/// p(ln k) ∝ N(ln k; 0, σ²) k^(d−1) Π_broke t^(k−1) / (Σ t^k)^d,    p(ln λ) constant
/// ```
///
/// The prior prefers neither wear nor early failure: its median is 1, and [`SHAPE_PRIOR_95`] is its 95 % interval. If all
/// `d` ropes broke at one age, the probability of wear, `k > 1`, is `Φ((d − 1) σ)`: 0.79 for two, 0.95 for three.
///
/// # Source
/// The interval is an assumption. It contains the classes of R. B. Abernethy, *The New Weibull Handbook*, 2006: infant
/// mortality below 1, early wear-out from 1 to 4, and rapid wear-out above 4.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapePosterior {
    sums: Sums,
    /// Shapes at equal steps of their logarithm, and their probabilities.
    nodes: Vec<(f64, f64)>,
}

/// 95 % interval of the prior of the Weibull shape (log-normal, median 1).
pub const SHAPE_PRIOR_95: [f64; 2] = [0.2, 5.0];

impl ShapePosterior {
    /// Computes the posterior; `None` if no rope broke.
    #[must_use]
    pub fn new(lives: &[Lifetime]) -> Option<Self> {
        /// Number of shapes; an even number, so that 1 lies between two of them.
        const NODES: usize = 1000;
        let sums = Sums::new(lives)?;
        let [first, last] = SHAPES.map(libm::log);
        let step = (last - first) / NODES as f64;
        let std = libm::log(SHAPE_PRIOR_95[1]) / Z95;
        let logs: Vec<(f64, f64)> = (0..NODES)
            .map(|i| {
                let log = first + step * (i as f64 + 0.5);
                let z = log / std;
                let shape = libm::exp(log);
                (shape, sums.log_shape_likelihood(shape) - 0.5 * z * z)
            })
            .collect();
        let most = logs.iter().fold(f64::NEG_INFINITY, |m, (_, l)| m.max(*l));
        let weight = |log: f64| libm::exp(log - most);
        let total: f64 = logs.iter().map(|(_, log)| weight(*log)).sum();
        let nodes = logs
            .into_iter()
            .map(|(shape, log)| (shape, weight(log) / total));
        Some(Self {
            nodes: nodes.collect(),
            sums,
        })
    }

    /// Shapes, and their probabilities.
    #[must_use]
    pub fn nodes(&self) -> &[(f64, f64)] {
        &self.nodes
    }

    /// Probability that the hazard increases with age: shape above 1.
    #[must_use]
    pub fn wear_probability(&self) -> f64 {
        let above = self.nodes.iter().filter(|(shape, _)| *shape > 1.0);
        above.map(|(_, p)| p).sum()
    }

    /// Approximate number of further failures after which the sign of `ln k` is certain to `z` standard deviations, if
    /// its posterior mean `m` stays as it is; `None`: more than a thousand.
    ///
    /// ```text
    /// 1/v + n π²/6 = (z/m)²
    /// ```
    ///
    /// `v` is the present posterior variance of `ln k`, and `π²/6` the Fisher information about it of one failure if the
    /// scale is unknown.
    #[must_use]
    pub fn further_failures(&self, z: f64) -> Option<usize> {
        const MAX_FAILURES: f64 = 1000.0;
        let moment = |power: i32| -> f64 {
            let each = self.nodes.iter();
            each.map(|(k, p)| p * libm::pow(libm::log(*k), f64::from(power)))
                .sum()
        };
        let mean = moment(1);
        let variance = moment(2) - mean * mean;
        let information = core::f64::consts::PI * core::f64::consts::PI / 6.0;
        let more = ((z / mean) * (z / mean) - 1.0 / variance) / information;
        let more = libm::ceil(more.max(1.0));
        (more <= MAX_FAILURES).then_some(more as usize)
    }

    /// Logarithm of the likelihood of a shape up to a constant, with the scale integrated out.
    ///
    /// `λ^−k` given `k` has a gamma distribution of shape `d` (ropes that broke) and rate `Σ t^k`
    /// ([`ShapePosterior::rate`]); the remaining factor is `k^(d−1) Π_broke t^(k−1) / (Σ t^k)^d`, per logarithm of `k`.
    #[must_use]
    pub fn log_likelihood(&self, shape: f64) -> f64 {
        self.sums.log_shape_likelihood(shape)
    }

    /// Logarithm of `Σ t^k`, and how many ropes broke: the distribution of `λ^−k` given `k`.
    #[must_use]
    pub fn rate(&self, shape: f64) -> (f64, f64) {
        let log = self.sums.log_powers(shape) + shape * self.sums.unit;
        (log, self.sums.broke)
    }
}

/// Search range around the estimate of an age or a hazard, e-folds.
const REACH: f64 = 60.0;

impl Sums {
    fn new(lives: &[Lifetime]) -> Option<Self> {
        let lives = lives.iter().filter(|l| l.is_possible());
        let mut logs: Vec<f64> = lives.clone().map(|l| libm::log(l.age)).collect();
        let unit = logs.iter().sum::<f64>() / logs.len().max(1) as f64;
        logs.iter_mut().for_each(|x| *x -= unit);
        let broken = lives.filter(|l| l.broke).map(|l| libm::log(l.age) - unit);
        let broke = broken.clone().count();
        (broke >= 1).then(|| Self {
            logs,
            unit,
            broke: broke as f64,
            log_broke: broken.sum(),
        })
    }

    /// Logarithm of the likelihood of a shape, the scale integrated out, per logarithm of the shape.
    fn log_shape_likelihood(&self, k: f64) -> f64 {
        (self.broke - 1.0) * libm::log(k) + k * self.log_broke - self.broke * self.log_powers(k)
    }

    /// `ln Σ t^k`, without overflow.
    fn log_powers(&self, k: f64) -> f64 {
        let most = self.logs.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
        let sum: f64 = self.logs.iter().map(|x| libm::exp(k * (x - most))).sum();
        k * most + libm::log(sum)
    }

    /// Logarithm of the maximum-likelihood scale of a shape: `λ^k = Σ t^k / d`.
    fn scale(&self, k: f64) -> f64 {
        (self.log_powers(k) - libm::log(self.broke)) / k
    }

    fn log_likelihood(&self, k: f64, log_scale: f64) -> f64 {
        let hazard: f64 = (self.logs.iter())
            .map(|x| libm::exp(k * (x - log_scale)))
            .sum();
        self.broke * (libm::log(k) - k * log_scale) + (k - 1.0) * self.log_broke - hazard
    }

    /// Slope of the likelihood over the shape, the scale at its best: falls with `k`.
    fn slope(&self, k: f64) -> f64 {
        let most = self.logs.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
        let (mut sum, mut weighted) = (0.0, 0.0);
        for x in &self.logs {
            let power = libm::exp(k * (x - most));
            sum += power;
            weighted += power * x;
        }
        self.broke / k + self.log_broke - self.broke * weighted / sum
    }

    /// Score function with the hazard fixed at an age: `d/k + Σ_broke ln(t/t₀) − h Σ (t/t₀)^k ln(t/t₀)`.
    fn slope_through(&self, k: f64, log_age: f64, hazard: f64) -> f64 {
        let sum: f64 = (self.logs.iter())
            .map(|x| libm::exp(k * (x - log_age)) * (x - log_age))
            .sum();
        self.broke / k + self.log_broke - self.broke * log_age - hazard * sum
    }
}

/// Root of a function of a logarithmic scale between two ends above 0; `None`: it has one sign at both.
fn root(ends: [f64; 2], f: impl Fn(f64) -> f64) -> Option<f64> {
    let logs = ends.map(libm::log);
    root_of(logs, |x| f(libm::exp(x))).map(libm::exp)
}

/// Root of a function between two ends, by bisection; `None`: it has one sign at both.
fn root_of(ends: [f64; 2], f: impl Fn(f64) -> f64) -> Option<f64> {
    let [mut a, mut b] = ends;
    let at_a = f(a);
    // An infinite slope has a sign, too.
    if at_a.is_nan() || (at_a > 0.0) == (f(b) > 0.0) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if (f(middle) > 0.0) == (at_a > 0.0) {
            a = middle;
        } else {
            b = middle;
        }
    }
    Some(0.5 * (a + b))
}
