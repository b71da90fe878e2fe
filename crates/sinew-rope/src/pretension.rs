//! Preconditioning of a rope, its pretension, and the schedule of re-tensioning.
//!
//! The draws, their model error outside the tested range and their breaks are those of a prediction.
//!
//! The same rope is modelled in two ways. *At constant tension* (loaded by a weight) it elongates; the
//! procedure that removes most of that elongation beforehand is sought. *At constant length* (strung in a
//! machine) its tension falls; the schedule gives the times at which it reaches the lowest permitted tension.

use super::CatalogueRope;
use super::caution::Caution;
use super::draws::{Draw, Draws, bounded};
use super::limits::check_temperature;
use super::predict::{HOUR_S, PredictError, TENSIONED_AFTER_S};
use super::prediction::beyond_data;
pub use super::procedure::{HeldJoint, Mount, Procedure, Request, series_compliance_m_per_n};
use super::schedule::schedule;
pub use super::schedule::{Schedule, Unattended};
use super::strand::{Mean, Trajectory};
use crate::law::validity::{LOAD_RATIO_HIGH, LimitViolation};
use crate::law::{Law, LoadError, RopeLoad, State};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sinew_files::{JsonDocument, interrupt};
use sinew_model::Bounded;

/// Bedding-in tensions tried, as multiples of the working tension.
const TENSIONS: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
/// Bedding-in durations tried, s.
const DURATIONS_S: [f64; 4] = [600.0, HOUR_S, 4.0 * HOUR_S, 24.0 * HOUR_S];
/// Times, spread evenly over the logarithm, at which later elongation is looked at.
const LOOKS: usize = 24;
/// Plan for preconditioning and tensioning a rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// Name of the rope in the catalogue.
    pub rope: String,
    /// Working tension, N.
    pub tension_n: f64,
    /// Lowest tension allowed, N.
    pub lowest_n: f64,
    /// Temperature of the plan, °C.
    pub temperature_c: f64,
    /// Strand length, m.
    pub length_m: f64,
    /// Series compliance of each strand (frame, spring, mounts), m/N.
    pub series_compliance_m_per_n: f64,
    /// Joint with a second rope in the opposite direction, where the tension is the mean of both.
    pub joint: Option<HeldJoint>,
    /// Horizon of the plan, s.
    pub horizon_s: f64,
    /// Share of the later elongation that the procedure must remove, 0 to 1.
    pub remove_share: f64,
    /// Largest later elongation without any procedure, m; in draws that break, up to the break.
    pub without_m: Bounded,
    /// Share of the draws in which the rope breaks at the working tension within the horizon, 0 to 1.
    #[serde(default)]
    pub broken_share: f64,
    /// All procedures tried, by tension, then duration.
    pub procedures: Vec<Procedure>,
    /// Index of the mildest sufficient procedure at catalogue values: lowest tension first, then shortest
    /// time.
    pub chosen: Option<usize>,
    /// Schedule of a rope that is strung as delivered.
    pub schedule_as_delivered: Schedule,
    /// Schedule after the chosen procedure (or the most effective one).
    pub schedule_preconditioned: Schedule,
    /// Number of creep law parameters that are assumed, not measured.
    pub assumed_parameters: usize,
    /// Number of creep law parameters.
    pub parameters: usize,
    /// Warnings about the plan.
    pub cautions: Vec<Caution>,
}

impl JsonDocument for Plan {
    const SCHEMA: &'static str = "sinew/rope-pretension/2";
}

/// Makes a plan for one rope.
///
/// # Errors
/// [`PredictError`].
pub fn plan(rope: &CatalogueRope, request: &Request) -> Result<Plan, PredictError> {
    check_temperature(rope, request.temperature_c)?;
    let draws = Draws::new(rope, request.draws, request.seed)?;
    let work = RopeLoad::celsius(request.tension_n, request.temperature_c);
    let to_error = |error| PredictError::Load {
        rope: rope.entry.name.clone(),
        error,
    };
    let rate = draws.endurance.damage_per_s(&draws.nominal, work, 1.0);
    let life_s = 1.0 / rate.map_err(to_error)?;
    if life_s <= request.horizon_s {
        return Err(PredictError::BreaksBefore {
            rope: rope.entry.name.clone(),
            tension_n: request.tension_n,
            life_s,
            horizon_s: request.horizon_s,
        });
    }
    let slack_n = 0.5 * request.mount.extra_n();
    if request.lowest_n <= slack_n {
        return Err(PredictError::Slack {
            lowest_n: request.lowest_n,
            slack_n,
        });
    }
    let rope_m = rope.diameter_m();
    let (length_m, tension_n) = (request.length_m, request.tension_n);
    let pieces = |law: &Law| request.mount.pieces(law, length_m, rope_m, tension_n);
    // Whether the pulleys fit does not depend on the law.
    pieces(&draws.nominal)?;
    let extrapolation = draws.extrapolation([tension_n; 2], [request.temperature_c; 2]);
    let each: Vec<Draw<'_>> = draws.each(extrapolation).collect();
    let looks_s = looks_s(request.horizon_s);
    // Without a procedure, and with each: nominal and every draw, which may break.
    let later = |procedure: Option<(f64, f64)>| -> Result<(f64, Vec<Trajectory>), LoadError> {
        let strains = |law: &Law, times_s: &[f64]| -> Result<Vec<Mean>, LoadError> {
            let mut out = vec![Mean::default(); times_s.len()];
            for piece in pieces(law).unwrap_or_default() {
                let law = piece.law;
                let weight = piece.length_m / length_m;
                let mut state = State::default();
                if let Some((tension_n, duration_s)) = procedure {
                    let load = RopeLoad { tension_n, ..work };
                    law.hold(&mut state, load, duration_s)?;
                }
                let rates = law.rates(work)?;
                let mut at = 0.0;
                for (mean, &time_s) in out.iter_mut().zip(times_s) {
                    law.advance(&mut state, &rates, time_s - at)?;
                    mean.add(weight, &law, &state, work)?;
                    at = time_s;
                }
            }
            Ok(out)
        };
        let trajectory = |draw: &Draw<'_>| {
            interrupt::check();
            let rate = draw.endurance.damage_per_s(draw.law, work, 1.0);
            let load_share = draw.law.load_ratio(work.tension_n);
            let life_s = rate.map_or(0.0, |rate| 1.0 / rate);
            Trajectory::new(draw, life_s, load_share, &looks_s, |times_s| {
                strains(draw.law, times_s).ok()
            })
        };
        let nominal = strains(&draws.nominal, &looks_s)?;
        let drawn = each.par_iter().map(trajectory).collect();
        Ok((most(nominal.iter()), drawn))
    };
    let m_per_percent = 0.01 * request.length_m;
    let longer = |drawn: &[Trajectory]| -> Vec<f64> {
        let most = |c: &Trajectory| most((0..looks_s.len()).filter_map(|i| c.at(i)));
        drawn.iter().map(|c| m_per_percent * most(c)).collect()
    };
    let (without, drawn) = later(None).map_err(to_error)?;
    let (without, without_drawn) = (m_per_percent * without, longer(&drawn));
    let broken = drawn.iter().filter(|c| c.life_s <= request.horizon_s);
    let broken_share = broken.count() as f64 / drawn.len().max(1) as f64;
    let mut procedures = Vec::new();
    let limit_n = LOAD_RATIO_HIGH * draws.nominal.parameters().breaking_load_n;
    for times in TENSIONS {
        let tension_n = times * request.tension_n;
        if times > 1.0 && tension_n > limit_n {
            break;
        }
        for duration_s in DURATIONS_S {
            let (value, drawn) = later(Some((tension_n, duration_s))).map_err(to_error)?;
            let (value, drawn) = (m_per_percent * value, longer(&drawn));
            let removed: Vec<f64> = drawn
                .iter()
                .zip(&without_drawn)
                .map(|(with, without)| 1.0 - with / without)
                .collect();
            procedures.push(Procedure {
                tension_n,
                duration_s,
                remaining_m: bounded(value, &drawn),
                removed_share: bounded(1.0 - value / without, &removed),
            });
        }
    }
    let chosen = procedures
        .iter()
        .position(|p| p.removed_share.value >= request.remove);
    let best = procedures
        .iter()
        .max_by(|a, b| a.removed_share.value.total_cmp(&b.removed_share.value))
        .copied();
    let bedded = chosen.map(|i| procedures[i]).or(best);
    let nominal = &draws.nominal;
    let schedule_as_delivered = schedule(nominal, &each, request, rope_m, None, to_error)?;
    let schedule_preconditioned = schedule(nominal, &each, request, rope_m, bedded, to_error)?;
    let entry = &rope.entry;
    let outside = LimitViolation::of(&draws.nominal, work);
    let mut cautions = Caution::outside(outside);
    cautions.extend(beyond_data(
        rope.tested_range(),
        extrapolation,
        [draws.nominal.load_ratio(request.tension_n); 2],
        [request.temperature_c; 2],
        request.horizon_s,
    ));
    if entry.assumed() > 0 {
        cautions.push(Caution::AssumedParameters {
            assumed: entry.assumed(),
            parameters: entry.law.len(),
        });
    }
    Ok(Plan {
        rope: entry.name.clone(),
        tension_n: request.tension_n,
        lowest_n: request.lowest_n,
        temperature_c: request.temperature_c,
        length_m: request.length_m,
        series_compliance_m_per_n: request.mount.series_compliance_m_per_n,
        joint: request.mount.joint,
        horizon_s: request.horizon_s,
        remove_share: request.remove,
        without_m: bounded(without, &without_drawn),
        broken_share,
        procedures,
        chosen,
        schedule_as_delivered,
        schedule_preconditioned,
        assumed_parameters: entry.assumed(),
        parameters: entry.law.len(),
        cautions,
    })
}

/// Times at which later elongation is looked at, s; the first is a minute after tensioning.
fn looks_s(horizon_s: f64) -> Vec<f64> {
    let ratio = (horizon_s / TENSIONED_AFTER_S).max(1.0);
    let at = |i: usize| TENSIONED_AFTER_S * ratio.powf(i as f64 / LOOKS as f64);
    (0..=LOOKS).map(at).collect()
}

/// Largest strain added after the first of some strains, %, at least 0; NaN without any.
fn most<'a>(mut means: impl Iterator<Item = &'a Mean>) -> f64 {
    let Some(start) = means.next() else {
        return f64::NAN;
    };
    means.map(|m| m.strain - start.strain).fold(0.0, f64::max)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::Catalogue;
    use crate::predict::YEAR_S;

    pub(crate) fn request() -> Request {
        Request {
            tension_n: 60.0,
            temperature_c: 23.0,
            length_m: 0.7,
            mount: Mount::default(),
            horizon_s: YEAR_S,
            lowest_n: 45.0,
            remove: 0.7,
            draws: 40,
            seed: 1,
        }
    }

    pub(crate) fn planned(name: &str, request: &Request) -> Plan {
        let catalogue = Catalogue::shipped().expect("shipped");
        plan(catalogue.find(name).expect("there"), request).expect("a plan")
    }

    #[test]
    fn preconditioning_more_reduces_remaining_elongation() {
        let p = planned("liros-dc000-0301", &request());
        assert_eq!(p.procedures.len(), 24);
        for pair in p.procedures.windows(2) {
            if pair[0].tension_n == pair[1].tension_n {
                let (short, long) = (pair[0].remaining_m, pair[1].remaining_m);
                assert!(long.value <= short.value + 1e-15, "{pair:?}");
            }
        }
        let chosen = p.procedures[p.chosen.expect("one does it")];
        assert!(chosen.removed_share.value >= 0.7 && chosen.tension_n >= 60.0);
        assert!(chosen.remaining_m.value <= 0.3 * p.without_m.value + 1e-15);
    }
}
