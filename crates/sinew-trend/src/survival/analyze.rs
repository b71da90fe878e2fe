//! Survival analysis: from lifetimes to curves, laws and their meaning.

use super::lives::{LifeEnd, Lifetimes, RopeLife};
use super::result::{
    AgeReplacement, FittedPoint, FittedWeibull, LifeQuantile, ReplacementVerdict, SurvivalGroup,
    SurvivalReport,
};
use sinew_rope::survival::{
    Lifetime, SHAPE_PRIOR_95, ShapePosterior, WeibullFit, kaplan_meier, survival_quantile,
};
use std::collections::BTreeSet;

/// Shares of broken ropes whose ages are reported.
const BROKEN: [f64; 3] = [0.05, 0.1, 0.5];
/// Share of broken ropes at the recommended age of replacement.
const REPLACED_RATIO: f64 = 0.1;
/// Probability required for a verdict.
const REQUIRED_PROBABILITY: f64 = 0.95;
/// Standard normal quantile of that probability.
const REQUIRED_Z: f64 = 1.645;
/// Number of points of a law's curve.
const POINTS: usize = 60;

/// Analyses lifetimes: all together, and each group if there are several.
///
/// * `source`: name of the table.
pub fn analyze_lives(lives: &Lifetimes, source: &str) -> SurvivalReport {
    let names: BTreeSet<&str> = (lives.lives.iter())
        .filter_map(|l| l.group.as_deref())
        .collect();
    let mut groups = vec![group(None, &lives.lives)];
    if names.len() > 1 {
        groups.extend(names.into_iter().map(|name| {
            let own = lives
                .lives
                .iter()
                .filter(|l| l.group.as_deref() == Some(name));
            group(Some(name), &own.cloned().collect::<Vec<_>>())
        }));
    }
    SurvivalReport {
        sinew_version: env!("CARGO_PKG_VERSION").into(),
        source: source.into(),
        age_unit: lives.age_unit,
        groups,
        notes: lives.notes.clone(),
    }
}

/// Ages and ends of lifetimes for a fit.
pub(super) fn ages(ropes: &[RopeLife]) -> Vec<Lifetime> {
    let life = |rope: &RopeLife| Lifetime {
        age: rope.age,
        broke: rope.end == LifeEnd::Broke,
    };
    ropes.iter().map(life).collect()
}

fn group(name: Option<&str>, ropes: &[RopeLife]) -> SurvivalGroup {
    let lives = ages(ropes);
    let curve = kaplan_meier(&lives);
    let [age_low, age, age_high] = survival_quantile(&curve, 0.5);
    let fit = WeibullFit::new(&lives);
    let oldest = lives.iter().map(|l| l.age).fold(0.0, f64::max);
    let weibull = fit.as_ref().map(|fit| FittedWeibull {
        shape: fit.law.shape,
        shape_interval_95: fit.shape_interval_95,
        scale: fit.law.scale,
        scale_interval_95: fit.quantile_interval_95(1.0 - (-1.0_f64).exp()),
        log_likelihood: fit.log_likelihood,
        broken_by: BROKEN.map(|share| broken_by(fit, share)).to_vec(),
        curve: (1..=POINTS)
            .map(|i| fitted(fit, oldest * i as f64 / POINTS as f64))
            .collect(),
        outside_band: (curve.iter())
            .filter(|p| !p.interval_95.contains(fit.law.survival(p.age)))
            .count(),
    });
    SurvivalGroup {
        name: name.map(str::to_string),
        ropes: ropes.len(),
        broke: lives.iter().filter(|l| l.broke).count(),
        exposure_age: lives.iter().map(|l| l.age).sum(),
        curve,
        median: LifeQuantile {
            broken_ratio: 0.5,
            age,
            age_low,
            age_high,
        },
        replacement: replacement(&lives, fit.as_ref()),
        weibull,
    }
}

fn broken_by(fit: &WeibullFit, share: f64) -> LifeQuantile {
    let [age_low, age_high] = fit.quantile_interval_95(share);
    LifeQuantile {
        broken_ratio: share,
        age: Some(fit.law.quantile(share)),
        age_low,
        age_high,
    }
}

fn fitted(fit: &WeibullFit, age: f64) -> FittedPoint {
    FittedPoint {
        age,
        survival: fit.law.survival(age),
        interval_95: fit.survival_interval_95(age),
    }
}

/// Benefit of age-based replacement: it reduces failures if the hazard increases with age.
pub(super) fn replacement(lives: &[Lifetime], fit: Option<&WeibullFit>) -> AgeReplacement {
    let shape = ShapePosterior::new(lives);
    let wear_probability = shape.as_ref().map(ShapePosterior::wear_probability);
    let verdict = match wear_probability {
        Some(p) if p >= REQUIRED_PROBABILITY => ReplacementVerdict::Helps,
        Some(p) if p <= 1.0 - REQUIRED_PROBABILITY => ReplacementVerdict::DoesNotHelp,
        _ => ReplacementVerdict::Inconclusive,
    };
    let is_open = verdict == ReplacementVerdict::Inconclusive;
    let further = |shape: &ShapePosterior| shape.further_failures(REQUIRED_Z);
    AgeReplacement {
        verdict,
        wear_probability,
        required_probability: REQUIRED_PROBABILITY,
        shape_prior_95: SHAPE_PRIOR_95,
        further_failures: shape.as_ref().filter(|_| is_open).and_then(further),
        age: (fit.filter(|_| verdict == ReplacementVerdict::Helps))
            .map(|fit| broken_by(fit, REPLACED_RATIO)),
    }
}
