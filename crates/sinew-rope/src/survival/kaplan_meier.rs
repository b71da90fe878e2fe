//! The share of ropes that last, without a law.

use super::Lifetime;
use sinew_model::{Interval95, Z95};

/// Point of the survival function immediately after an age at which ropes broke.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SurvivalPoint {
    /// Age of the ropes, in the unit of the data.
    pub age: f64,
    /// Number of ropes that had reached the age.
    pub at_risk: usize,
    /// Ropes that broke at it.
    pub broke: usize,
    /// Share of ropes that last longer, 0…1.
    pub survival: f64,
    /// 95 % interval of the share.
    pub interval_95: Interval95,
}

/// Computes the share of ropes that last longer than an age, with one point per age at which a rope broke, in
/// the order of ages:
///
/// ```text
/// S(t) = Π (1 − dᵢ/nᵢ) over ages tᵢ ≤ t,    d broken of n that had reached it
/// v = Σ dᵢ/(nᵢ (nᵢ − dᵢ)),                  S^exp(±1.96 √v / ln S)
/// ```
///
/// The interval is Greenwood's on the scale of ln(−ln S): it stays within 0 and 1. Where all that had reached an age
/// broke at it, S is 0 and the interval that of the age before, down to 0. What is censored at an age had reached it.
///
/// Valid if censoring is independent of the remaining lifetime.
///
/// # Source
/// E. L. Kaplan, P. Meier, *Nonparametric estimation from incomplete observations*, 1958; J. D. Kalbfleisch,
/// R. L. Prentice, *The Statistical Analysis of Failure Time Data*, 2002, section 1.4.
#[must_use]
pub fn kaplan_meier(lives: &[Lifetime]) -> Vec<SurvivalPoint> {
    let mut sorted: Vec<Lifetime> = lives
        .iter()
        .copied()
        .filter(Lifetime::is_possible)
        .collect();
    sorted.sort_unstable_by(|a, b| a.age.total_cmp(&b.age));
    let mut out: Vec<SurvivalPoint> = Vec::new();
    let (mut survival, mut variance) = (1.0, 0.0);
    let mut from = 0;
    while let Some(first) = sorted.get(from) {
        let at_risk = sorted.len() - from;
        let tied = sorted[from..].iter().take_while(|l| l.age == first.age);
        let broke = tied.clone().filter(|l| l.broke).count();
        from += tied.count();
        if broke == 0 {
            continue;
        }
        let (n, d) = (at_risk as f64, broke as f64);
        survival *= 1.0 - d / n;
        let interval_95 = if broke == at_risk {
            let before = out.last().map_or(1.0, |p| p.interval_95.high);
            Interval95::new(0.0, before)
        } else {
            variance += d / (n * (n - d));
            let log = libm::log(survival);
            let half = Z95 * libm::sqrt(variance) / -log;
            let at = |exponent: f64| libm::exp(log * libm::exp(exponent));
            Interval95::new(at(half), at(-half))
        };
        out.push(SurvivalPoint {
            age: first.age,
            at_risk,
            broke,
            survival,
            interval_95,
        });
    }
    out
}

/// Computes the age that a share of the ropes does not outlast, and its 95 % interval; `None`: beyond the
/// observed ages.
///
/// The first age at which the curve is at most `1 − share`; the interval ends where the curve's does (Brookmeyer and
/// Crowley on the scale of ln(−ln S)).
#[must_use]
pub fn survival_quantile(points: &[SurvivalPoint], share: f64) -> [Option<f64>; 3] {
    let first = |of: &dyn Fn(&SurvivalPoint) -> f64| {
        let found = points.iter().find(|p| of(p) <= 1.0 - share);
        found.map(|p| p.age)
    };
    [
        first(&|p| p.interval_95.low),
        first(&|p| p.survival),
        first(&|p| p.interval_95.high),
    ]
}
