//! Selection of a rope from the catalogue for a duty, with the reasons for each rejection.

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
    /// Largest elongation after pretensioning at the last requested time, mm; compared with the upper bound
    /// of the 95 % interval.
    pub elongation_max_mm: Option<f64>,
    /// Smallest stiffness of the strand at the duty's mean load, N/mm.
    pub stiffness_min_n_per_mm: Option<f64>,
    /// Largest weight per length, g/m.
    pub weight_max_g_per_m: Option<f64>,
}

/// Rope that meets every constraint.
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
    /// Elongation after pretensioning at the last requested time, m.
    pub elongation_m: Bounded,
    /// Time of the break, s; `None` beyond 300 years.
    pub life_s: Option<Bounded>,
    /// Share of the draws in which the rope breaks within the last requested time, 0 to 1.
    pub broken_share: f64,
    /// Share of the draws in which it has the smallest elongation of all candidates, 0 to 1.
    pub min_share: f64,
    /// Whether no other candidate of known diameter is at most as thick, elongates at most as much and lasts
    /// at least as long, at the catalogue values.
    pub pareto: bool,
    /// Number of creep law parameters that are assumed, not measured.
    pub assumed_parameters: usize,
    /// Number of creep law parameters.
    pub parameters: usize,
    /// Warnings about the prediction.
    pub cautions: Vec<Caution>,
}

/// Class of a candidate, ranked before its elongation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Rank {
    /// Lasts, within the manufacturers' advice on load and pulleys.
    Sound,
    /// Loaded or bent more than manufacturers advise.
    BeyondAdvice,
    /// Breaks within the time in more than [`MAY_BREAK_SHARE`] of the draws, or exceeds the manufacturer's
    /// discard strain.
    MayBreak,
}

impl Candidate {
    /// Class of the candidate by lifetime and by manufacturers' advice.
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

    /// Objectives besides the size, the smaller the better: elongation, m, and negative lifetime, s.
    #[must_use]
    pub fn objectives(&self) -> [f64; 2] {
        let life_s = self.life_s.map_or(LIFE_MOST_S, |l| l.value);
        [self.elongation_m.value, -life_s]
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
    /// Upper bound of the elongation above the limit.
    Elongation {
        /// Upper bound of the elongation's 95 % interval, m.
        high_m: f64,
        /// Largest permitted elongation, m.
        limit_m: f64,
    },
    /// Stiffness of the strand below the limit.
    Stiffness {
        /// Stiffness of the strand, N/m.
        stiffness_n_per_m: f64,
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
    /// Break before the last requested time.
    Breaks {
        /// Time of the break at the catalogue values, s.
        after_s: f64,
        /// Cause of the break.
        cause: BreakCause,
    },
    /// HMPE would be too hot.
    Hot,
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
    /// Ropes that meet all constraints, sorted by [`Candidate::rank`] and then by elongation.
    pub candidates: Vec<Candidate>,
    /// Rejected ropes with their reasons.
    pub rejected: Vec<Rejected>,
}

impl JsonDocument for Selection {
    const SCHEMA: &'static str = "sinew/rope-select/2";
}

/// Chooses among all ropes of a catalogue.
///
/// Ropes are ranked by the elongation after pretensioning at the last time of `request`. A constraint on a
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
    let mut candidates = Vec::new();
    let mut rejected = Vec::new();
    let mut growths: Vec<Vec<f64>> = Vec::new();
    for rope in catalogue.ropes() {
        match assess(rope, request, constraints) {
            Ok((candidate, growth)) => {
                candidates.push(candidate);
                growths.push(growth);
            }
            Err(Assessment::Reasons(reasons)) => rejected.push(Rejected {
                rope: rope.entry.name.clone(),
                reasons,
            }),
            Err(Assessment::Failed(error)) => return Err(error),
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
            candidates[i].min_share += 1.0 / request.draws as f64;
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

/// Assesses a rope: a candidate with its elongation per draw, or the reasons of its rejection.
fn assess(
    rope: &CatalogueRope,
    request: &predict::Request,
    constraints: &Constraints,
) -> Result<(Candidate, Vec<f64>), Assessment> {
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
    .collect();
    // The law is evaluated only within its validity.
    let found = match drawn(rope, request, &|_| {}) {
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
    if let Some(bend_ratio) = bend_ratio
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
    if let Some(after_s) = found.breaks_after_s {
        reasons.push(Rejection::Breaks {
            after_s,
            cause: life.cause,
        });
        return Err(Assessment::Reasons(reasons));
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
        return Err(Assessment::Reasons(reasons));
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
        min_share: 0.0,
        pareto: false,
        assumed_parameters: entry.assumed(),
        parameters: entry.law.len(),
        cautions,
    };
    Ok((candidate, found.growth_m(request)))
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
            .windows(2)
            .all(|w| w[0].elongation_m.value <= w[1].elongation_m.value);
        assert!(sorted && found.candidates[0].pareto);
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
