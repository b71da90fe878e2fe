//! Which rope of the catalogue to take for a duty, and why not the others.

use super::caution::Caution;
use super::drawn::drawn;
use super::draws::{Draws, bounded};
pub use super::life::MAY_BREAK_SHARE;
use super::life::{BreakCause, LIFE_MOST_S};
use super::predict::{self, PredictError, Prediction};
use super::{Catalogue, CatalogueRope};
use crate::law::RopeLoad;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Bounded;

/// What a rope must be. `None`: it doesn't matter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Constraints {
    /// Largest diameter, mm.
    pub diameter_max_mm: Option<f64>,
    /// Smallest diameter, mm.
    pub diameter_min_mm: Option<f64>,
    /// Smallest pulley diameter over rope diameter.
    pub bend_ratio_min: Option<f64>,
    /// Smallest pulley in the machine, mm; needed for [`Constraints::bend_ratio_min`].
    pub pulley_diameter_mm: Option<f64>,
    /// Smallest breaking load over largest tension.
    pub safety_factor_min: Option<f64>,
    /// Largest elongation since tensioned at the last time asked for, mm: held against the upper
    /// end of the 95 % interval.
    pub elongation_max_mm: Option<f64>,
    /// Smallest stiffness of the strand at the duty's mean load, N/mm.
    pub stiffness_min_n_per_mm: Option<f64>,
    /// Largest weight, g/m.
    pub weight_max_g_per_m: Option<f64>,
}

/// A rope that meets every constraint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Rope.
    pub rope: String,
    /// Diameter, m, where it is published.
    pub diameter_m: Option<f64>,
    /// Weight, kg/m, where it is published.
    pub weight_kg_per_m: Option<f64>,
    /// Published breaking load over largest tension.
    pub safety_factor_ratio: Option<f64>,
    /// Stiffness of the strand at the duty's mean load, N/m.
    pub stiffness_n_per_m: Bounded,
    /// Elongation since tensioned at the last time asked for, m.
    pub elongation_m: Bounded,
    /// When it breaks, s; `None` beyond 300 years.
    pub life_s: Option<Bounded>,
    /// Share of the draws in which it breaks within the last time asked for, 0 to 1.
    pub broken_share: f64,
    /// In how many of the draws it stretches least of all candidates, 0 to 1.
    pub least_share: f64,
    /// Whether no other candidate of known diameter is as thin or thinner, stretches as little or less
    /// and lasts as long or longer, at the catalogue's values.
    pub pareto: bool,
    /// Parameters of the law that are starting guesses.
    pub starting_guesses: usize,
    /// All parameters of the law.
    pub parameters: usize,
    /// Cautions.
    pub cautions: Vec<Caution>,
}

/// How a candidate stands beside others, before its elongation counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Rank {
    /// It lasts, within what makers advise of load and pulleys.
    Sound,
    /// It is loaded or bent more than makers advise.
    BeyondAdvice,
    /// It breaks within the time in more than [`MAY_BREAK_SHARE`] of the draws, or its maker would have it
    /// replaced.
    MayBreak,
}

impl Candidate {
    /// Whether it lasts, and within what makers advise.
    #[must_use]
    pub fn rank(&self) -> Rank {
        let advice =
            |c: &Caution| matches!(c, Caution::TightBend { .. } | Caution::LoadShare { .. });
        let replaced = |c: &Caution| matches!(c, Caution::Replace { .. });
        if self.broken_share > MAY_BREAK_SHARE || self.cautions.iter().any(replaced) {
            Rank::MayBreak
        } else if self.cautions.iter().any(advice) {
            Rank::BeyondAdvice
        } else {
            Rank::Sound
        }
    }

    /// What counts besides its size, the smaller the better: elongation, m, and life taken from 0, s.
    #[must_use]
    pub fn objectives(&self) -> [f64; 2] {
        let life_s = self.life_s.map_or(LIFE_MOST_S, |l| l.value);
        [self.elongation_m.value, -life_s]
    }
}

/// Why a rope fell out. What was found and the limit it was held against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Rejection {
    /// Diameter above the largest, m.
    TooThick {
        /// Found.
        diameter_m: f64,
        /// Limit.
        limit_m: f64,
    },
    /// Diameter below the smallest, m.
    TooThin {
        /// Found.
        diameter_m: f64,
        /// Limit.
        limit_m: f64,
    },
    /// Weight above the largest, kg/m.
    TooHeavy {
        /// Found.
        weight_kg_per_m: f64,
        /// Limit.
        limit_kg_per_m: f64,
    },
    /// Smallest pulley diameter over rope diameter.
    BendRatio {
        /// Found.
        ratio: f64,
        /// Limit.
        limit_ratio: f64,
    },
    /// Breaking load over largest tension.
    SafetyFactor {
        /// Found.
        ratio: f64,
        /// Limit.
        limit_ratio: f64,
    },
    /// Upper end of the elongation's interval, m.
    Elongation {
        /// Found.
        high_m: f64,
        /// Limit.
        limit_m: f64,
    },
    /// Stiffness of the strand, N/m.
    Stiffness {
        /// Found.
        stiffness_n_per_m: f64,
        /// Limit.
        limit_n_per_m: f64,
    },
    /// The diameter is not published.
    DiameterNotPublished,
    /// The weight is not published.
    WeightNotPublished,
    /// Rope or pulley diameter is not known.
    BendRatioNotKnown,
    /// The breaking load is not published.
    BreakingLoadNotPublished,
    /// It breaks before the last time asked for.
    Breaks {
        /// When, at the catalogue's values, s.
        after_s: f64,
        /// Of what.
        cause: BreakCause,
    },
    /// HMPE would be too hot.
    Hot,
    /// The law gives no prediction.
    NotPredicted {
        /// Why.
        reason: String,
    },
}

/// A rope that fell out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rejected {
    /// Rope.
    pub rope: String,
    /// Every constraint it fails.
    pub reasons: Vec<Rejection>,
}

/// The choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Selection {
    /// The duty in words.
    pub duty: String,
    /// Time the elongation is for, s.
    pub time_s: f64,
    /// Ropes that meet everything, by [`Candidate::rank`] and then by least elongation.
    pub candidates: Vec<Candidate>,
    /// The others.
    pub rejected: Vec<Rejected>,
}

impl JsonDocument for Selection {
    const SCHEMA: &'static str = "sinew/rope-select/1";
}

/// Chooses among all ropes of a catalogue.
///
/// Ropes are ranked by the elongation since tensioned at the last time of `request`. A constraint
/// on something that is not published rejects the rope: it can't be shown to meet it.
///
/// # Errors
/// [`PredictError::Routing`] and [`PredictError::Stroke`]; a rope that can't be predicted is rejected with the reason.
pub fn select(
    catalogue: &Catalogue,
    request: &predict::Request,
    constraints: &Constraints,
) -> Result<Selection, PredictError> {
    let mut candidates = Vec::new();
    let mut rejected = Vec::new();
    let mut growths: Vec<Vec<f64>> = Vec::new();
    for rope in catalogue.ropes() {
        match judge(rope, request, constraints) {
            Ok((candidate, growth)) => {
                candidates.push(candidate);
                growths.push(growth);
            }
            Err(Judged::Reasons(reasons)) => rejected.push(Rejected {
                rope: rope.entry.name.clone(),
                reasons,
            }),
            Err(Judged::Refused(error)) => return Err(error),
        }
    }
    for draw in 0..request.draws {
        let of = |g: &Vec<f64>| g.get(draw).copied().filter(|v| !v.is_nan());
        let least = growths
            .iter()
            .enumerate()
            .filter_map(|(i, g)| of(g).map(|v| (i, v)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, _)) = least {
            candidates[i].least_share += 1.0 / request.draws as f64;
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
        let stretch = a.elongation_m.value.total_cmp(&b.elongation_m.value);
        a.rank().cmp(&b.rank()).then(stretch)
    });
    Ok(Selection {
        duty: request.duty.about.clone(),
        time_s: request.times_s.last().copied().unwrap_or(0.0),
        candidates,
        rejected,
    })
}

/// Whether no other point is as small in everything and smaller in something.
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

enum Judged {
    Reasons(Vec<Rejection>),
    Refused(PredictError),
}

/// A candidate with its elongation in each draw, or why it is none.
fn judge(
    rope: &CatalogueRope,
    request: &predict::Request,
    constraints: &Constraints,
) -> Result<(Candidate, Vec<f64>), Judged> {
    let entry = &rope.entry;
    let value = |v: &Option<crate::law::entry::Value>| v.as_ref().map(|v| v.value);
    let (diameter_mm, weight_g_per_m) = (value(&entry.diameter_mm), value(&entry.weight_g_per_m));
    let summary = request.duty.summary();
    let safety_factor = value(&entry.breaking_load_n).map(|n| n / summary.tension_max_n);
    let bend_ratio = constraints
        .pulley_diameter_mm
        .zip(diameter_mm)
        .map(|(pulley, rope)| pulley / rope);
    let mut reasons: Vec<Rejection> = [
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
            Rejection::BendRatioNotKnown,
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
    .collect();
    // The law is asked only where it can answer.
    let found = match drawn(rope, request, &|_| {}) {
        Ok(found) => found,
        Err(e @ (PredictError::Routing(_) | PredictError::Stroke { .. })) => {
            return Err(Judged::Refused(e));
        }
        Err(e) => {
            reasons.push(Rejection::NotPredicted {
                reason: e.to_string(),
            });
            return Err(Judged::Reasons(reasons));
        }
    };
    let Prediction {
        rope: name,
        mut cautions,
        readings,
        life,
        ..
    } = found.prediction(rope, request);
    let least_ratio = found.endurance().bend_ratio_least;
    let bends = |c: &Caution| matches!(c, Caution::TightBend { .. });
    if let Some(bend_ratio) = bend_ratio
        && bend_ratio < least_ratio
        && !cautions.iter().any(bends)
    {
        cautions.push(Caution::TightBend {
            bend_ratio,
            least_ratio,
        });
    }
    if cautions.contains(&Caution::Hot) {
        reasons.push(Rejection::Hot);
    }
    if let Some(after_s) = found.breaks_after_s {
        reasons.push(Rejection::Breaks {
            after_s,
            cause: life.cause,
        });
        return Err(Judged::Reasons(reasons));
    }
    let unknown = Bounded::even(f64::NAN, 0.0);
    let stiffness = stiffness_n_per_m(&found.draws, request);
    let elongation_m = readings.last().map_or(unknown, |r| r.since_tensioned_m);
    // A value that is not a number keeps no limit.
    if let Some(limit_m) = constraints.elongation_max_mm.map(|mm| 1e-3 * mm)
        && (elongation_m.high.is_nan() || elongation_m.high > limit_m)
    {
        reasons.push(Rejection::Elongation {
            high_m: elongation_m.high,
            limit_m,
        });
    }
    if let Some(limit_n_per_m) = constraints.stiffness_min_n_per_mm.map(|n| 1e3 * n)
        && (stiffness.value.is_nan() || stiffness.value < limit_n_per_m)
    {
        reasons.push(Rejection::Stiffness {
            stiffness_n_per_m: stiffness.value,
            limit_n_per_m,
        });
    }
    if !reasons.is_empty() {
        return Err(Judged::Reasons(reasons));
    }
    let candidate = Candidate {
        rope: name,
        diameter_m: diameter_mm.map(|mm| 1e-3 * mm),
        weight_kg_per_m: weight_g_per_m.map(|g| 1e-3 * g),
        safety_factor_ratio: safety_factor,
        stiffness_n_per_m: stiffness,
        elongation_m,
        life_s: life.breaks_after_s,
        broken_share: life.broken_share,
        least_share: 0.0,
        pareto: false,
        starting_guesses: entry.guesses(),
        parameters: entry.law.len(),
        cautions,
    };
    Ok((candidate, found.growth_m(request)))
}

/// Why a value does not show that it keeps a limit; `beyond` says which way is out.
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

/// Stiffness of the strand for small quick changes at the duty's mean load, N/m.
fn stiffness_n_per_m(draws: &Draws, request: &predict::Request) -> Bounded {
    let summary = request.duty.summary();
    let load = RopeLoad::celsius(summary.tension_mean_n, summary.temperature_mean_c);
    let m_per_percent = 0.01 * request.route.length_m;
    let (nominal, drawn) = draws.map(|law| {
        law.compliance_percent_per_n(load)
            .map_or(f64::NAN, |c| 1.0 / (c * m_per_percent))
    });
    bounded(nominal, &drawn)
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
    fn every_rope_is_a_candidate_or_has_a_reason() {
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
        let sum: f64 = found.candidates.iter().map(|c| c.least_share).sum();
        assert!(
            (sum - 1.0).abs() < 1e-9,
            "one is the least in every draw: {sum}"
        );
        let sorted = found
            .candidates
            .windows(2)
            .all(|w| w[0].elongation_m.value <= w[1].elongation_m.value);
        assert!(sorted && found.candidates[0].pareto);
    }

    #[test]
    fn a_thick_rope_needs_a_large_pulley() {
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
