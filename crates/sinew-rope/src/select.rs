//! Selection of a rope from the catalogue for a duty, with the reasons for each rejection.
//!
//! Ropes are ranked by the change of length that they keep with a probability of 95 %, the quantile of the magnitude of
//! the elongation `e` over the draws:
//!
//! `c = min { x : P(|e| ≤ x) ≥ 0.95 }`
//!
//! It contains size and uncertainty of the change, of either sign: for `e ~ N(μ, σ²)` it is `1.96 σ` if `μ = 0`, and
//! `|μ| + 1.64 σ` if `|μ|` is much larger than `σ`.
//!
//! A published value violates a constraint or does not. A predicted value violates it in a share of the draws: up to
//! [`MAY_BREAK_SHARE`] the constraint is met, above `1 − MAY_BREAK_SHARE` the rope is rejected (the 95 % interval lies
//! beyond the limit), and in between the rope is a candidate with a [`PossibleViolation`], ranked behind those that meet
//! it. A rope that breaks in more than [`BREAK_SHARE`] of the draws is rejected.

use super::caution::Caution;
use super::drawn::{Drawn, drawn};
use super::draws::{Draws, bounded};
pub use super::life::MAY_BREAK_SHARE;
use super::life::{BreakCause, LIFE_MOST_S};
use super::predict::{self, PredictError, Prediction};
use super::{Catalogue, CatalogueRope};
use crate::law::RopeLoad;
use serde::{Deserialize, Serialize};
use sinew_files::{JsonDocument, interrupt};
use sinew_model::Bounded;
use sinew_model::statistics::quantile;

/// Probability with which a rope keeps its [`Candidate::change_m`], the level of all intervals.
pub const CHANGE_PROBABILITY: f64 = 0.95;
/// Share of draws above which a rope that breaks is rejected: its break is more likely than not. Between this share and
/// [`MAY_BREAK_SHARE`] the uncertainty of the lifetime, a factor of 10 if it is assumed, decides.
pub const BREAK_SHARE: f64 = 0.5;

/// Constraints on the rope. `None`: no constraint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Constraints {
    /// Largest diameter, mm.
    pub diameter_max_mm: Option<f64>,
    /// Smallest diameter, mm.
    pub diameter_min_mm: Option<f64>,
    /// Smallest ratio of pulley diameter to rope diameter.
    pub bend_ratio_min: Option<f64>,
    /// Diameter of the smallest pulley in the machine, mm; needed for [`Constraints::bend_ratio_min`].
    pub pulley_diameter_mm: Option<f64>,
    /// Smallest ratio of breaking load to largest tension.
    pub safety_factor_min: Option<f64>,
    /// Largest elongation or shortening after pretensioning at the last requested time, mm; compared with every draw.
    pub elongation_max_mm: Option<f64>,
    /// Smallest stiffness of the strand at the duty's mean load, N/mm; compared with every draw.
    pub stiffness_min_n_per_mm: Option<f64>,
    /// Largest weight per length, g/m.
    pub weight_max_g_per_m: Option<f64>,
}

/// Rope that violates no constraint in nearly all draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Name of the rope in the catalogue.
    pub rope: String,
    /// Published diameter of the rope, m.
    pub diameter_m: Option<f64>,
    /// Published weight per length, kg/m.
    pub weight_kg_per_m: Option<f64>,
    /// Ratio of published breaking load to largest tension.
    pub safety_factor_ratio: Option<f64>,
    /// Stiffness of the strand at the duty's mean load, N/m.
    pub stiffness_n_per_m: Bounded,
    /// Elongation after pretensioning at the last requested time, m; without the draws in which the rope is broken. Its
    /// value is that at the catalogue values, or the median of the draws if the rope breaks at the catalogue values.
    pub elongation_m: Bounded,
    /// Magnitude of the elongation that is not exceeded in 95 % of these draws, m.
    pub change_m: f64,
    /// Time of the break, s; `None` beyond 300 years.
    pub life_s: Option<Bounded>,
    /// Share of the draws in which the rope breaks within the last requested time, 0 to 1.
    pub broken_share: f64,
    /// Share of the draws in which its length changes least of all candidates, 0 to 1.
    pub min_share: f64,
    /// Whether no other candidate of known diameter is at most as thick, changes its length at most as much
    /// ([`Candidate::change_m`]) and lasts at least as long at the catalogue values.
    pub pareto: bool,
    /// Number of creep law parameters that are assumed, not measured.
    pub assumed_parameters: usize,
    /// Number of creep law parameters.
    pub parameters: usize,
    /// Constraints that are violated in some of the draws.
    pub possible_violations: Vec<PossibleViolation>,
    /// Warnings about the prediction.
    pub cautions: Vec<Caution>,
}

/// Constraint that a candidate violates in more than 2.5 %, and at most 97.5 %, of the draws.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum PossibleViolation {
    /// Elongation or shortening above the largest permitted one.
    Elongation {
        /// Largest permitted elongation, m.
        limit_m: f64,
        /// Share of the draws that exceed it, 0 to 1.
        share: f64,
    },
    /// Stiffness of the strand below the smallest permitted one.
    Stiffness {
        /// Smallest permitted stiffness, N/m.
        limit_n_per_m: f64,
        /// Share of the draws that are below it, 0 to 1.
        share: f64,
    },
}

/// Class of a candidate, ranked before its change of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Rank {
    /// Lasts, within the manufacturers' advice on load and pulleys.
    Sound,
    /// Loaded or bent more than manufacturers advise.
    BeyondAdvice,
    /// Has a [`PossibleViolation`].
    MayViolate,
    /// Breaks within the time in more than [`MAY_BREAK_SHARE`] of the draws, or exceeds the manufacturer's
    /// discard strain.
    MayBreak,
}

impl Candidate {
    /// Class of the candidate by lifetime, constraints and manufacturers' advice.
    #[must_use]
    pub fn rank(&self) -> Rank {
        let advice =
            |c: &Caution| matches!(c, Caution::TightBend { .. } | Caution::LoadShare { .. });
        let replaced = |c: &Caution| matches!(c, Caution::Replace { .. });
        if self.broken_share > MAY_BREAK_SHARE || self.cautions.iter().any(replaced) {
            Rank::MayBreak
        } else if !self.possible_violations.is_empty() {
            Rank::MayViolate
        } else if self.cautions.iter().any(advice) {
            Rank::BeyondAdvice
        } else {
            Rank::Sound
        }
    }

    /// Objectives besides the size, the smaller the better: change of length, m, and negative lifetime, s.
    #[must_use]
    pub fn objectives(&self) -> [f64; 2] {
        let life_s = self.life_s.map_or(LIFE_MOST_S, |l| l.value);
        [self.change_m, -life_s]
    }
}

/// Reason for the rejection of a rope, with its value and the violated limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Rejection {
    /// Diameter above the largest permitted one.
    TooThick {
        /// Diameter of the rope, m.
        diameter_m: f64,
        /// Largest permitted diameter, m.
        limit_m: f64,
    },
    /// Diameter below the smallest permitted one.
    TooThin {
        /// Diameter of the rope, m.
        diameter_m: f64,
        /// Smallest permitted diameter, m.
        limit_m: f64,
    },
    /// Weight per length above the largest permitted one.
    TooHeavy {
        /// Weight per length of the rope, kg/m.
        weight_kg_per_m: f64,
        /// Largest permitted weight per length, kg/m.
        limit_kg_per_m: f64,
    },
    /// Ratio of smallest pulley diameter to rope diameter below the limit.
    BendRatio {
        /// Ratio of pulley diameter to rope diameter.
        ratio: f64,
        /// Smallest permitted ratio of diameters.
        limit_ratio: f64,
    },
    /// Ratio of breaking load to largest tension below the limit.
    SafetyFactor {
        /// Ratio of breaking load to largest tension.
        ratio: f64,
        /// Smallest permitted safety factor.
        limit_ratio: f64,
    },
    /// Elongation or shortening above the limit in more than 97.5 % of the draws.
    Elongation {
        /// Elongation at the last requested time, m.
        elongation_m: Bounded,
        /// Largest permitted elongation, m.
        limit_m: f64,
    },
    /// Stiffness of the strand below the limit in more than 97.5 % of the draws.
    Stiffness {
        /// Stiffness of the strand, N/m.
        stiffness_n_per_m: Bounded,
        /// Smallest permitted stiffness, N/m.
        limit_n_per_m: f64,
    },
    /// The diameter is not published.
    DiameterNotPublished,
    /// The weight is not published.
    WeightNotPublished,
    /// Rope or pulley diameter is not known.
    BendRatioUnknown,
    /// The breaking load is not published.
    BreakingLoadNotPublished,
    /// Break before the last requested time in more than half of the draws.
    Breaks {
        /// Time of the break, s; `None` beyond 300 years at the catalogue values.
        life_s: Option<Bounded>,
        /// Share of the draws in which the rope breaks within the last requested time, 0 to 1.
        broken_share: f64,
        /// Cause of the break.
        cause: BreakCause,
    },
    /// HMPE would be too hot.
    Hot,
    /// Elongation or stiffness that is not finite at the catalogue values or in a draw.
    NotDetermined,
    /// Prediction that is not possible.
    NotPredicted {
        /// Reason for the missing prediction.
        reason: String,
    },
}

/// Rejected rope with its reasons.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected {
    /// Name of the rope in the catalogue.
    pub rope: String,
    /// Reasons of the rejection, one per violated constraint.
    pub reasons: Vec<Rejection>,
}

/// Selection of ropes for a duty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Selection {
    /// The duty in words.
    pub duty: String,
    /// Time the elongation is for, s.
    pub time_s: f64,
    /// Ropes that are not rejected, sorted by [`Candidate::rank`] and then by [`Candidate::change_m`].
    pub candidates: Vec<Candidate>,
    /// Rejected ropes with their reasons.
    pub rejected: Vec<Rejected>,
}

impl JsonDocument for Selection {
    const SCHEMA: &'static str = "sinew/rope-select/2";
}

/// Chooses among all ropes of a catalogue.
///
/// Ropes are ranked by the change of length after pretensioning at the last time of `request`. A constraint on a
/// value that is not published rejects the rope, because it cannot be verified.
///
/// # Errors
/// Returns [`PredictError::Routing`] or [`PredictError::Stroke`]; a rope without a prediction is rejected
/// with the reason.
pub fn select(
    catalogue: &Catalogue,
    request: &predict::Request,
    constraints: &Constraints,
) -> Result<Selection, PredictError> {
    select_with_progress(catalogue, request, constraints, &|_| {})
}

/// [`select`] with a call of `done` after each draw of each rope, with the completed share of the work, 0 to 1; not in
/// order, from several threads.
///
/// # Errors
/// [`PredictError`].
pub fn select_with_progress(
    catalogue: &Catalogue,
    request: &predict::Request,
    constraints: &Constraints,
    done: &(dyn Fn(f64) + Sync),
) -> Result<Selection, PredictError> {
    let mut assessed = Vec::new();
    let mut rejected = Vec::new();
    let all = (catalogue.ropes().len() * request.draws) as f64;
    for (i, rope) in catalogue.ropes().iter().enumerate() {
        interrupt::check();
        let before = i * request.draws;
        let found = drawn(rope, request, &|draws| done((before + draws) as f64 / all));
        match assess(rope, request, constraints, found) {
            Ok(candidate) => assessed.push(candidate),
            Err(Assessment::Reasons(reasons)) => rejected.push(Rejected {
                rope: rope.entry.name.clone(),
                reasons,
            }),
            Err(Assessment::Failed(error)) => return Err(error),
        }
    }
    Ok(Selection {
        duty: request.duty.about.clone(),
        time_s: request.times_s.last().copied().unwrap_or(0.0),
        candidates: ranked(assessed, request.draws),
        rejected,
    })
}

/// Candidates in their order; each with its elongation per draw, m, which is `None` where the rope is broken.
fn ranked(assessed: Vec<(Candidate, Vec<Option<f64>>)>, draws: usize) -> Vec<Candidate> {
    let (mut candidates, growths): (Vec<Candidate>, Vec<Vec<Option<f64>>>) =
        assessed.into_iter().unzip();
    for draw in 0..draws {
        let of = |(i, g): (usize, &Vec<Option<f64>>)| Some((i, g.get(draw).copied()??.abs()));
        let changes = growths.iter().enumerate().filter_map(of);
        if let Some((i, _)) = changes.min_by(|a, b| a.1.total_cmp(&b.1)) {
            candidates[i].min_share += 1.0 / draws as f64;
        }
    }
    let points: Vec<(Option<f64>, [f64; 2])> = candidates
        .iter()
        .map(|c| (c.diameter_m, c.objectives()))
        .collect();
    for (i, candidate) in candidates.iter_mut().enumerate() {
        candidate.pareto = is_pareto(&points, i);
    }
    candidates.sort_by(|a, b| {
        let change = a.change_m.total_cmp(&b.change_m);
        a.rank().cmp(&b.rank()).then(change)
    });
    candidates
}

/// Whether no other point is at most as large in every coordinate and smaller in one.
pub fn is_pareto(points: &[(Option<f64>, [f64; 2])], i: usize) -> bool {
    let (Some(d), y) = points[i] else {
        return false;
    };
    !points.iter().enumerate().any(|(j, (other, z))| {
        let pairs = other.map(|o| [(o, d), (z[0], y[0]), (z[1], y[1])]);
        let beats =
            |p: [(f64, f64); 3]| p.iter().all(|(a, b)| a <= b) && p.iter().any(|(a, b)| a < b);
        j != i && pairs.is_some_and(beats)
    })
}

enum Assessment {
    Reasons(Vec<Rejection>),
    Failed(PredictError),
}

/// Published value of an entry.
fn value(published: &Option<crate::law::entry::Value>) -> Option<f64> {
    published.as_ref().map(|v| v.value)
}

/// Ratio of the smallest pulley's diameter to that of the rope.
fn bend_ratio(rope: &CatalogueRope, constraints: &Constraints) -> Option<f64> {
    let (pulley, rope) = (
        constraints.pulley_diameter_mm,
        value(&rope.entry.diameter_mm),
    );
    pulley.zip(rope).map(|(pulley, rope)| pulley / rope)
}

/// Violated constraints on published values.
fn published(
    rope: &CatalogueRope,
    constraints: &Constraints,
    tension_max_n: f64,
) -> Vec<Rejection> {
    let entry = &rope.entry;
    let (diameter_mm, weight_g_per_m) = (value(&entry.diameter_mm), value(&entry.weight_g_per_m));
    let safety_factor = value(&entry.breaking_load_n).map(|n| n / tension_max_n);
    let bend_ratio = bend_ratio(rope, constraints);
    [
        missed(
            diameter_mm,
            f64::gt,
            constraints.diameter_max_mm,
            Rejection::DiameterNotPublished,
            |v, limit| Rejection::TooThick {
                diameter_m: 1e-3 * v,
                limit_m: 1e-3 * limit,
            },
        ),
        missed(
            weight_g_per_m,
            f64::gt,
            constraints.weight_max_g_per_m,
            Rejection::WeightNotPublished,
            |v, limit| Rejection::TooHeavy {
                weight_kg_per_m: 1e-3 * v,
                limit_kg_per_m: 1e-3 * limit,
            },
        ),
        missed(
            diameter_mm,
            f64::lt,
            constraints.diameter_min_mm,
            Rejection::DiameterNotPublished,
            |v, limit| Rejection::TooThin {
                diameter_m: 1e-3 * v,
                limit_m: 1e-3 * limit,
            },
        ),
        missed(
            bend_ratio,
            f64::lt,
            constraints.bend_ratio_min,
            Rejection::BendRatioUnknown,
            |ratio, limit_ratio| Rejection::BendRatio { ratio, limit_ratio },
        ),
        missed(
            safety_factor,
            f64::lt,
            constraints.safety_factor_min,
            Rejection::BreakingLoadNotPublished,
            |ratio, limit_ratio| Rejection::SafetyFactor { ratio, limit_ratio },
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Assesses a rope: a candidate with its elongation per draw, or the reasons of its rejection.
fn assess(
    rope: &CatalogueRope,
    request: &predict::Request,
    constraints: &Constraints,
    found: Result<Drawn, PredictError>,
) -> Result<(Candidate, Vec<Option<f64>>), Assessment> {
    let tension_max_n = request.duty.summary().tension_max_n;
    let mut reasons = published(rope, constraints, tension_max_n);
    // The law is evaluated only within its validity.
    let found = match found {
        Ok(found) => found,
        Err(e @ (PredictError::Routing(_) | PredictError::Stroke { .. })) => {
            return Err(Assessment::Failed(e));
        }
        Err(e) => {
            reasons.push(Rejection::NotPredicted {
                reason: e.to_string(),
            });
            return Err(Assessment::Reasons(reasons));
        }
    };
    let Prediction {
        rope: name,
        mut cautions,
        readings,
        lifetime: life,
        ..
    } = found.prediction(rope, request);
    let min_ratio = found.endurance().bend_ratio_least;
    let bends = |c: &Caution| matches!(c, Caution::TightBend { .. });
    if let Some(bend_ratio) = bend_ratio(rope, constraints)
        && bend_ratio < min_ratio
        && !cautions.iter().any(bends)
    {
        cautions.push(Caution::TightBend {
            bend_ratio,
            min_ratio,
        });
    }
    if cautions.contains(&Caution::Hot) {
        reasons.push(Rejection::Hot);
    }
    let breaks = found.breaks_after_s.is_some();
    if life.broken_share > BREAK_SHARE || (request.draws == 0 && breaks) {
        reasons.push(Rejection::Breaks {
            life_s: life.breaks_after_s,
            broken_share: life.broken_share,
            cause: life.cause,
        });
        return Err(Assessment::Reasons(reasons));
    }
    let growth_m = found.growth_m(request);
    let nominal = readings.last().filter(|_| !breaks);
    let change = change(nominal.map(|r| r.since_tensioned_m.value), &growth_m);
    let stiffness = stiffnesses(&found.draws, request);
    let (Some((elongation_m, change_m)), Some((stiffness_n_per_m, stiffnesses))) =
        (change, stiffness)
    else {
        reasons.push(Rejection::NotDetermined);
        return Err(Assessment::Reasons(reasons));
    };
    let mut possible_violations = Vec::new();
    if let Some(limit_m) = constraints.elongation_max_mm.map(|mm| 1e-3 * mm) {
        let beyond = |m: f64| m.abs() > limit_m;
        match share(
            elongation_m.value,
            growth_m.iter().copied().flatten(),
            beyond,
        ) {
            share if share > 1.0 - MAY_BREAK_SHARE => reasons.push(Rejection::Elongation {
                elongation_m,
                limit_m,
            }),
            share if share > MAY_BREAK_SHARE => {
                possible_violations.push(PossibleViolation::Elongation { limit_m, share });
            }
            _ => {}
        }
    }
    if let Some(limit_n_per_m) = constraints.stiffness_min_n_per_mm.map(|n| 1e3 * n) {
        let beyond = |n_per_m: f64| n_per_m < limit_n_per_m;
        match share(stiffness_n_per_m.value, stiffnesses.into_iter(), beyond) {
            share if share > 1.0 - MAY_BREAK_SHARE => reasons.push(Rejection::Stiffness {
                stiffness_n_per_m,
                limit_n_per_m,
            }),
            share if share > MAY_BREAK_SHARE => {
                possible_violations.push(PossibleViolation::Stiffness {
                    limit_n_per_m,
                    share,
                });
            }
            _ => {}
        }
    }
    if !reasons.is_empty() {
        return Err(Assessment::Reasons(reasons));
    }
    let entry = &rope.entry;
    let candidate = Candidate {
        rope: name,
        diameter_m: value(&entry.diameter_mm).map(|mm| 1e-3 * mm),
        weight_kg_per_m: value(&entry.weight_g_per_m).map(|g| 1e-3 * g),
        safety_factor_ratio: value(&entry.breaking_load_n).map(|n| n / tension_max_n),
        stiffness_n_per_m,
        elongation_m,
        change_m,
        life_s: life.breaks_after_s,
        broken_share: life.broken_share,
        min_share: 0.0,
        pareto: false,
        assumed_parameters: entry.assumed(),
        parameters: entry.law.len(),
        possible_violations,
        cautions,
    };
    Ok((candidate, growth_m))
}

/// Elongation with its interval, and the magnitude that it keeps with [`CHANGE_PROBABILITY`]; `None` if one of the
/// values is not finite, or without any value.
///
/// * `nominal`: value at the catalogue values; without one, the median of the draws.
/// * `draws`: `None` where the rope is broken.
fn change(nominal: Option<f64>, draws: &[Option<f64>]) -> Option<(Bounded, f64)> {
    let mut intact: Vec<f64> = draws.iter().copied().flatten().collect();
    if !nominal.iter().chain(&intact).all(|v| v.is_finite()) {
        return None;
    }
    intact.sort_unstable_by(f64::total_cmp);
    let value = match (nominal, intact.as_slice()) {
        (Some(nominal), _) => nominal,
        (None, []) => return None,
        (None, sorted) => quantile(sorted, 0.5),
    };
    let mut magnitudes: Vec<f64> = intact.iter().map(|v| v.abs()).collect();
    magnitudes.sort_unstable_by(f64::total_cmp);
    let change = match magnitudes.as_slice() {
        [] => value.abs(),
        sorted => quantile(sorted, CHANGE_PROBABILITY),
    };
    Some((bounded(value, &intact), change))
}

/// Share of the draws that violate a limit; without draws, 1 or 0 by the catalogue values.
fn share(nominal: f64, draws: impl Iterator<Item = f64>, beyond: impl Fn(f64) -> bool) -> f64 {
    let (mut all, mut violated) = (0_usize, 0_usize);
    for draw in draws {
        all += 1;
        violated += usize::from(beyond(draw));
    }
    match all {
        0 => f64::from(u8::from(beyond(nominal))),
        _ => violated as f64 / all as f64,
    }
}

/// Rejection of a value that does not verify its limit; `beyond` compares the value with the limit.
fn missed(
    found: Option<f64>,
    beyond: fn(&f64, &f64) -> bool,
    limit: Option<f64>,
    unknown: Rejection,
    rejection: impl Fn(f64, f64) -> Rejection,
) -> Option<Rejection> {
    let limit = limit?;
    found.map_or(Some(unknown), |v| {
        beyond(&v, &limit).then(|| rejection(v, limit))
    })
}

/// Stiffness of the strand for small quick changes at the duty's mean load, N/m, with the draws in which the rope
/// carries this load; `None` if one of the values is not finite.
fn stiffnesses(draws: &Draws, request: &predict::Request) -> Option<(Bounded, Vec<f64>)> {
    let summary = request.duty.summary();
    let load = RopeLoad::celsius(summary.tension_mean_n, summary.temperature_mean_c);
    let m_per_percent = 0.01 * request.route.length_m;
    let (nominal, drawn) = draws.map(|law| {
        let compliance = law.compliance_percent_per_n(load).ok()?;
        Some(1.0 / (compliance * m_per_percent))
    });
    let (nominal, drawn): (f64, Vec<f64>) = (nominal?, drawn.into_iter().flatten().collect());
    let is_finite = drawn.iter().chain([&nominal]).all(|v| v.is_finite());
    is_finite.then(|| (bounded(nominal, &drawn), drawn))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Duty;
    use crate::predict::{Request, Route};

    fn request() -> Request {
        Request {
            duty: Duty::constant(60.0, 23.0),
            route: Route::straight(0.7),
            times_s: vec![predict::MONTH_S],
            read_at: None,
            draws: 100,
            seed: 1,
        }
    }

    #[test]
    fn selection_lists_each_rope_once() {
        let catalogue = Catalogue::paper().expect("shipped");
        let limits = Constraints {
            diameter_max_mm: Some(1.9),
            safety_factor_min: Some(40.0),
            ..Constraints::default()
        };
        let found = select(&catalogue, &request(), &limits).expect("a selection");
        assert_eq!(found.candidates.len() + found.rejected.len(), 9);
        let of = |name: &str| found.rejected.iter().find(|r| r.rope == name);
        let ultra = of("gottifredi-maffioli-sk99-ultra").expect("too thick");
        assert!(
            matches!(ultra.reasons[0], Rejection::TooThick { .. }),
            "{ultra:?}"
        );
        let technora = of("tu-chemnitz-technora-black").expect("nothing published");
        assert!(
            matches!(technora.reasons[0], Rejection::BreakingLoadNotPublished),
            "{technora:?}"
        );
        let climax = of("ockert-climax-combat").expect("too weak");
        let weak = Rejection::SafetyFactor {
            ratio: 35.0,
            limit_ratio: 40.0,
        };
        assert_eq!(climax.reasons[0], weak);
        let names: Vec<&str> = found.candidates.iter().map(|c| c.rope.as_str()).collect();
        assert!(names.contains(&"liros-dc000-0301"), "{names:?}");
        let sum: f64 = found.candidates.iter().map(|c| c.min_share).sum();
        assert!(
            (sum - 1.0).abs() < 1e-9,
            "one is the least in every draw: {sum}"
        );
        let sorted = found
            .candidates
            .is_sorted_by_key(|c| (c.rank(), c.change_m));
        assert!(sorted && found.candidates[0].pareto);
    }

    const DRAWS: usize = 4000;

    /// Candidate with the elongations `mean ± 1.96 std`, mm, at the quantiles of 4000 normal draws.
    fn normal(name: &str, mean: f64, std: f64) -> (Candidate, Vec<Option<f64>>) {
        let draws: Vec<Option<f64>> = (0..DRAWS)
            .map(|i| 1e-3 * (mean + std * normal_quantile((i as f64 + 0.5) / DRAWS as f64)))
            .map(Some)
            .collect();
        let (elongation_m, change_m) = change(Some(1e-3 * mean), &draws).expect("finite");
        let candidate = Candidate {
            rope: name.into(),
            diameter_m: Some(1e-3),
            weight_kg_per_m: None,
            safety_factor_ratio: None,
            stiffness_n_per_m: Bounded::even(1e5, 0.0),
            elongation_m,
            change_m,
            life_s: None,
            broken_share: 0.0,
            min_share: 0.0,
            pareto: false,
            assumed_parameters: 0,
            parameters: 1,
            possible_violations: Vec::new(),
            cautions: Vec::new(),
        };
        (candidate, draws)
    }

    /// Quantile of the standard normal distribution by bisection of its distribution function.
    fn normal_quantile(p: f64) -> f64 {
        let (mut low, mut high) = (-10.0, 10.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            let below = 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2);
            *(if below < p { &mut low } else { &mut high }) = middle;
        }
        low
    }

    /// A change of −0.1 ± 5 mm is neither small nor certain, for either sign.
    #[test]
    fn rank_is_by_size_and_certainty_of_change() {
        let z = 1.959_964;
        let ropes = |sign: f64| {
            let all = [
                normal("uncertain", -0.1 * sign, 5.0 / z),
                normal("small", 0.5 * sign, 0.1 / z),
                normal("large", -3.0 * sign, 0.1 / z),
            ];
            ranked(all.to_vec(), DRAWS)
        };
        let names = |c: &[Candidate]| c.iter().map(|c| c.rope.clone()).collect::<Vec<_>>();
        let (one, other) = (ropes(1.0), ropes(-1.0));
        assert_eq!(names(&one), ["small", "large", "uncertain"]);
        assert_eq!(names(&one), names(&other));
        // Root x of n.cdf(x) - n.cdf(-x) = 0.95 in python3, with n = statistics.NormalDist(0.1, 5/1.959964) and
        // (0.5, 0.1/1.959964). Draws lie 0.1 % of it apart there.
        for (c, expected) in [(&one[2], 5.003_84), (&one[0], 0.583_92)] {
            assert!((1e3 * c.change_m / expected - 1.0).abs() < 2e-3, "{c:?}");
        }
        for (a, b) in one.iter().zip(&other) {
            assert!((a.change_m - b.change_m).abs() < 1e-12, "{a:?} {b:?}");
            assert!((a.min_share - b.min_share).abs() < 1e-12, "{a:?} {b:?}");
            assert_eq!(a.pareto, b.pareto);
        }
        assert!(one[0].pareto && !one[1].pareto && one[0].min_share > 0.8);
    }

    #[test]
    fn change_that_is_not_finite_is_not_determined() {
        let draws = [Some(1.0), None, Some(-2.0)];
        let (elongation, largest) = change(None, &draws).expect("finite");
        assert_eq!((elongation.value, largest), (-0.5, 1.95));
        assert!(change(Some(f64::NAN), &draws).is_none());
        assert!(change(Some(1.0), &[Some(f64::INFINITY), Some(1.0)]).is_none());
        assert!(change(Some(1.0), &[Some(f64::NAN), Some(1.0)]).is_none());
        assert!(change(None, &[None]).is_none());
    }

    #[test]
    fn selection_thick_rope_needs_large_pulley() {
        let catalogue = Catalogue::paper().expect("shipped");
        // 20 mm over ropes of 0.9 to 2 mm: D/d is 10 on the thickest and 13 at 1.5 mm.
        let limits = Constraints {
            pulley_diameter_mm: Some(20.0),
            bend_ratio_min: Some(12.0),
            ..Constraints::default()
        };
        let found = select(&catalogue, &request(), &limits).expect("a selection");
        let thick = "gottifredi-maffioli-sk99-ultra";
        let reasons: Vec<&Rejection> = found
            .rejected
            .iter()
            .filter(|r| r.rope == thick)
            .flat_map(|r| &r.reasons)
            .collect();
        let sharp = Rejection::BendRatio {
            ratio: 10.0,
            limit_ratio: 12.0,
        };
        assert!(reasons.contains(&&sharp), "{:?}", found.rejected);
        let thin = found
            .candidates
            .iter()
            .any(|c| c.rope == "liros-dc000-0301");
        assert!(thin, "{:?}", found.rejected);
    }

    #[test]
    fn heat_rejects_hmpe_and_keeps_aramid() {
        let catalogue = Catalogue::paper().expect("shipped");
        let hot = Request {
            duty: Duty::constant(60.0, 80.0),
            ..request()
        };
        let found = select(&catalogue, &hot, &Constraints::default()).expect("a selection");
        assert_eq!(found.candidates.len(), 3);
        assert!(
            found
                .rejected
                .iter()
                .all(|r| r.reasons[0] == Rejection::Hot)
        );
    }
}
