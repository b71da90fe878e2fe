//! Which rope of the catalogue to take for a duty, and why not the others.

use super::draws::{Draws, Interval};
use super::predict::{self, PredictError, Prediction};
use super::{Catalogue, CatalogueRope};
use serde::Serialize;
use sinew_model::rope::RopeLoad;
use sinew_model::rope::validity::{self, Outside};

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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    /// Rope.
    pub rope: String,
    /// Diameter, mm, where it is published.
    pub diameter_mm: Option<f64>,
    /// Weight, g/m, where it is published.
    pub weight_g_per_m: Option<f64>,
    /// Published breaking load over largest tension.
    pub safety_factor: Option<f64>,
    /// Stiffness of the strand at the duty's mean load, N/mm.
    pub stiffness_n_per_mm: Interval,
    /// Elongation since tensioned at the last time asked for, mm.
    pub elongation_mm: Interval,
    /// In how many of the draws it stretches least of all candidates, 0 to 1.
    pub least_share: f64,
    /// Whether no other candidate is both thinner (or as thin) and stretches less.
    pub pareto: bool,
    /// Cautions.
    pub warnings: Vec<String>,
}

/// A rope that fell out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rejected {
    /// Rope.
    pub rope: String,
    /// Every constraint it fails, in sentences.
    pub reasons: Vec<String>,
}

/// The choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Selection {
    /// The duty in words.
    pub duty: String,
    /// Time the elongation is for, s.
    pub time_s: f64,
    /// Ropes that meet everything, least elongation first.
    pub candidates: Vec<Candidate>,
    /// The others.
    pub rejected: Vec<Rejected>,
}

/// Chooses among all ropes of a catalogue.
///
/// Ropes are ranked by the elongation since tensioned at the last time of `request`. A constraint
/// on something that is not published rejects the rope: it can't be shown to meet it.
///
/// # Errors
/// [`PredictError::Routing`]; a rope that can't be predicted is rejected with the reason.
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
    let points: Vec<(Option<f64>, f64)> = candidates
        .iter()
        .map(|c| (c.diameter_mm, c.elongation_mm.value))
        .collect();
    for (i, candidate) in candidates.iter_mut().enumerate() {
        candidate.pareto = is_pareto(&points, i);
    }
    candidates.sort_by(|a, b| a.elongation_mm.value.total_cmp(&b.elongation_mm.value));
    Ok(Selection {
        duty: request.duty.about.clone(),
        time_s: request.times_s.last().copied().unwrap_or(0.0),
        candidates,
        rejected,
    })
}

/// Whether no other point is as small in both and smaller in one.
pub fn is_pareto(points: &[(Option<f64>, f64)], i: usize) -> bool {
    let (Some(d), y) = points[i] else {
        return false;
    };
    !points.iter().enumerate().any(|(j, (other, z))| {
        j != i && other.is_some_and(|o| o <= d && *z <= y && (o < d || *z < y))
    })
}

enum Judged {
    Reasons(Vec<String>),
    Refused(PredictError),
}

/// A candidate with its elongation in each draw, or why it is none.
fn judge(
    rope: &CatalogueRope,
    request: &predict::Request,
    constraints: &Constraints,
) -> Result<(Candidate, Vec<f64>), Judged> {
    let entry = &rope.entry;
    let value = |v: &Option<sinew_model::rope::entry::Value>| v.as_ref().map(|v| v.value);
    let (diameter_mm, weight_g_per_m) = (value(&entry.diameter_mm), value(&entry.weight_g_per_m));
    let summary = request.duty.summary();
    let mut reasons = Vec::new();
    // One line per constraint: what is asked, what is found, or that it isn't published.
    let mut at_most = |what: &str, unit: &str, found: Option<f64>, limit: Option<f64>| {
        if let Some(limit) = limit {
            match found {
                None => reasons.push(format!("{what} is not published")),
                Some(v) if v > limit => {
                    reasons.push(format!(
                        "{what} {} {unit} is above {limit} {unit}",
                        short(v)
                    ));
                }
                Some(_) => {}
            }
        }
    };
    at_most("diameter", "mm", diameter_mm, constraints.diameter_max_mm);
    at_most(
        "weight",
        "g/m",
        weight_g_per_m,
        constraints.weight_max_g_per_m,
    );
    let bend_ratio = constraints
        .pulley_diameter_mm
        .zip(diameter_mm)
        .map(|(pulley, rope)| pulley / rope);
    let safety_factor = value(&entry.breaking_load_n).map(|n| n / summary.tension_max_n);
    let mut at_least = |what: &str, found: Option<f64>, limit: Option<f64>, missing: &str| {
        if let Some(limit) = limit {
            match found {
                None => reasons.push(missing.to_string()),
                Some(v) if v < limit => {
                    reasons.push(format!("{what} {} is below {limit}", short(v)));
                }
                Some(_) => {}
            }
        }
    };
    at_least(
        "diameter in mm",
        diameter_mm,
        constraints.diameter_min_mm,
        "diameter is not published",
    );
    at_least(
        "pulley over rope diameter",
        bend_ratio,
        constraints.bend_ratio_min,
        "pulley over rope diameter is not known",
    );
    at_least(
        "safety factor",
        safety_factor,
        constraints.safety_factor_min,
        "breaking load is not published, so no safety factor can be shown",
    );
    // The law is asked only where it can answer.
    let prediction = match predict::predict(rope, request) {
        Ok(prediction) => prediction,
        Err(PredictError::Routing(e)) => return Err(Judged::Refused(e.into())),
        Err(e) => {
            reasons.push(e.to_string());
            return Err(Judged::Reasons(reasons));
        }
    };
    if let Ok(draws) = Draws::new(rope, 0, request.seed) {
        for s in &request.duty.stretches {
            let outside = Outside::of(&draws.nominal, s.from).or(Outside::of(&draws.nominal, s.to));
            if outside.hot {
                reasons.push(format!(
                    "temperature is above the {:.0} °C that HMPE may have",
                    validity::HMPE_HOT_K - sinew_model::rope::CELSIUS_ZERO_K
                ));
                break;
            }
        }
    }
    let stiffness = stiffness_n_per_mm(rope, request).unwrap_or(Interval {
        low: f64::NAN,
        value: f64::NAN,
        high: f64::NAN,
    });
    let elongation_mm = prediction
        .readings
        .last()
        .map_or(stiffness, |r| r.since_tensioned_mm);
    if let Some(limit) = constraints.elongation_max_mm
        && (elongation_mm.high.is_nan() || elongation_mm.high > limit)
    {
        reasons.push(format!(
            "elongation may reach {} mm (95 %), above {limit} mm",
            short(elongation_mm.high)
        ));
    }
    if let Some(limit) = constraints.stiffness_min_n_per_mm
        && (stiffness.value.is_nan() || stiffness.value < limit)
    {
        reasons.push(format!(
            "stiffness {} N/mm is below {limit} N/mm",
            short(stiffness.value)
        ));
    }
    if !reasons.is_empty() {
        return Err(Judged::Reasons(reasons));
    }
    let growth = predict::growth_of_draws(rope, request).unwrap_or_default();
    let Prediction { warnings, rope, .. } = prediction;
    let candidate = Candidate {
        rope,
        diameter_mm,
        weight_g_per_m,
        safety_factor,
        stiffness_n_per_mm: stiffness,
        elongation_mm,
        least_share: 0.0,
        pareto: false,
        warnings,
    };
    Ok((candidate, growth))
}

/// Stiffness of the strand for small quick changes at the duty's mean load, N/mm.
fn stiffness_n_per_mm(rope: &CatalogueRope, request: &predict::Request) -> Option<Interval> {
    let draws = Draws::new(rope, request.draws, request.seed).ok()?;
    let summary = request.duty.summary();
    let load = RopeLoad::celsius(summary.tension_mean_n, summary.temperature_mean_c);
    let mm_per_percent = 10.0 * request.route.length_m;
    let (nominal, drawn) = draws.map(|law| {
        law.compliance_percent_per_n(load)
            .map_or(f64::NAN, |c| 1.0 / (c * mm_per_percent))
    });
    Some(Interval::of(nominal, &drawn))
}

/// Three significant digits.
fn short(v: f64) -> String {
    let digits = 2 - v.abs().max(1e-12).log10().floor() as i32;
    format!("{v:.*}", digits.clamp(0, 6) as usize)
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
        let catalogue = Catalogue::shipped().expect("shipped");
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
            ultra.reasons[0].contains("2.00 mm is above 1.9 mm"),
            "{ultra:?}"
        );
        let technora = of("tu-chemnitz-technora-black").expect("nothing published");
        assert!(
            technora.reasons[0].contains("not published"),
            "{technora:?}"
        );
        let climax = of("ockert-climax-combat").expect("too weak");
        assert!(climax.reasons[0].contains("35.0 is below 40"), "{climax:?}");
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
            .all(|w| w[0].elongation_mm.value <= w[1].elongation_mm.value);
        assert!(sorted && found.candidates[0].pareto);
    }

    #[test]
    fn a_thick_rope_needs_a_large_pulley() {
        let catalogue = Catalogue::shipped().expect("shipped");
        // 20 mm over ropes of 0.9 to 2 mm: D/d is 10 on the thickest and 13 at 1.5 mm.
        let limits = Constraints {
            pulley_diameter_mm: Some(20.0),
            bend_ratio_min: Some(12.0),
            ..Constraints::default()
        };
        let found = select(&catalogue, &request(), &limits).expect("a selection");
        let thick = "gottifredi-maffioli-sk99-ultra";
        let reasons: Vec<&String> = found
            .rejected
            .iter()
            .filter(|r| r.rope == thick)
            .flat_map(|r| &r.reasons)
            .collect();
        let said = |r: &&String| r.contains("pulley over rope diameter 10.0 is below 12");
        assert!(reasons.iter().any(said), "{:?}", found.rejected);
        let thin = found
            .candidates
            .iter()
            .any(|c| c.rope == "liros-dc000-0301");
        assert!(thin, "{:?}", found.rejected);
    }

    #[test]
    fn heat_rejects_hmpe_and_keeps_aramid() {
        let catalogue = Catalogue::shipped().expect("shipped");
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
                .all(|r| r.reasons[0].contains("65 °C"))
        );
    }
}
