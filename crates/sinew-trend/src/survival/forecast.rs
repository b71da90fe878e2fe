//! Age-based replacement of a rope before it breaks.

use super::analyze::{ages, replacement};
use super::lives::Lifetimes;
use super::result::{AgeUnit, LifeForecast, ReplacementVerdict};
use crate::AnalyzeError;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Gamma};
use sinew_model::statistics::quantile;
use sinew_rope::survival::{ShapePosterior, Weibull, WeibullFit};

/// Number of draws of the fitted law.
const DRAWS: usize = 2000;

/// Lifetime prior of a rope from the lifetimes of other ropes.
#[derive(Debug, Clone, PartialEq)]
pub struct LifePrior {
    /// Drawn laws, of equal probability.
    laws: Vec<Weibull>,
    /// Share of broken ropes at which to replace.
    broken_ratio: f64,
    ropes: usize,
    broke: usize,
    source: String,
}

impl LifePrior {
    /// Fits the lifetimes of other ropes.
    ///
    /// Laws are drawn from the posterior of the shape ([`ShapePosterior`]) and of the scale, whose prior
    /// is uniform in its logarithm.
    ///
    /// # Errors
    /// Returns [`AnalyzeError::Lifetimes`] if fewer than two broke, ages are cycles, or the lifetimes do
    /// not show that age-based replacement helps.
    pub fn new(
        lives: &Lifetimes,
        source: &str,
        broken_ratio: f64,
        seed: u64,
    ) -> Result<Self, AnalyzeError> {
        let invalid = |reason: &'static str| AnalyzeError::Lifetimes {
            source_name: source.into(),
            reason,
        };
        if lives.age_unit == AgeUnit::Cycles {
            return Err(invalid(
                "ages are in cycles, but a trend needs ages in days or hours",
            ));
        }
        let own = ages(&lives.lives);
        let fit = WeibullFit::new(&own).ok_or_else(|| {
            invalid(
                "fewer than two ropes broke, or all at nearly one age; no lifetime distribution can be fitted",
            )
        })?;
        match replacement(&own, Some(&fit)).verdict {
            ReplacementVerdict::Helps => {}
            ReplacementVerdict::DoesNotHelp => {
                return Err(invalid(
                    "ropes break early, so that a rope that has lasted is better than a new one: age is no reason for replacement",
                ));
            }
            ReplacementVerdict::Inconclusive => {
                return Err(invalid(
                    "the lifetimes do not show with a probability of 95 % that the failure rate increases with age: no age of replacement without further failures",
                ));
            }
        }
        Ok(Self {
            laws: ShapePosterior::new(&own).map_or(Vec::new(), |shape| draw(&shape, seed)),
            broken_ratio,
            ropes: own.len(),
            broke: own.iter().filter(|l| l.broke).count(),
            source: source.into(),
        })
    }

    /// Forecasts the replacement of a rope with an age, s.
    pub fn forecast(&self, age_s: f64) -> LifeForecast {
        let mut after: Vec<f64> = (self.laws.iter())
            .map(|law| law.quantile(self.broken_ratio) - age_s)
            .collect();
        after.sort_unstable_by(f64::total_cmp);
        let count = after.len().max(1) as f64;
        let broken: f64 = self.laws.iter().map(|law| 1.0 - law.survival(age_s)).sum();
        let [after_low_s, after_s, after_high_s] =
            [0.025, 0.5, 0.975].map(|share| quantile(&after, share));
        LifeForecast {
            broken_ratio: self.broken_ratio,
            age_s,
            broken_by_now_ratio: broken / count,
            passed_probability: after.iter().filter(|a| **a <= 0.0).count() as f64 / count,
            after_s,
            after_low_s,
            after_high_s,
            ropes: self.ropes,
            broke: self.broke,
            source: self.source.clone(),
        }
    }
}

/// Draws laws by their posterior probability: shapes systematically, the scale of each from its
/// gamma distribution.
fn draw(posterior: &ShapePosterior, seed: u64) -> Vec<Weibull> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (mut out, mut reached) = (Vec::with_capacity(DRAWS), 0.0);
    for &(shape, probability) in posterior.nodes() {
        reached += probability;
        let (log_rate, broke) = posterior.rate(shape);
        let Ok(gamma) = Gamma::new(broke, 1.0) else {
            continue;
        };
        while out.len() < DRAWS && (out.len() as f64 + 0.5) / (DRAWS as f64) < reached {
            let log: f64 = gamma.sample(&mut rng);
            let scale = ((log_rate - log.ln()) / shape).exp();
            out.push(Weibull { shape, scale });
        }
    }
    out
}
