//! How far a rope will have stretched after an hour, a day, a month, a year of a duty.

use super::caution::Caution;
use super::draws::{Draws, bounded};
use super::duty::DutySummary;
pub use super::route::{Guide, Request, Route};
use super::strand::{Mean, StrandError, strand};
use super::{CatalogueError, CatalogueRope};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_model::Bounded;
use sinew_model::rope::routing::RoutingError;
use sinew_model::rope::validity::Outside;
use sinew_model::rope::{Law, LoadError, RopeLoad, State, damage};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Readings made where nothing else is asked for.
pub const TIMES_DEFAULT_S: [f64; 4] = [HOUR_S, DAY_S, MONTH_S, YEAR_S];
/// s.
pub const HOUR_S: f64 = 3600.0;
/// s.
pub const DAY_S: f64 = 86_400.0;
/// A twelfth of a year, s.
pub const MONTH_S: f64 = YEAR_S / 12.0;
/// 365.25 days, s.
pub const YEAR_S: f64 = 31_557_600.0;
/// Elongation "since tensioned" counts from here, s: what a fitter sees who tensions a rope, lets
/// it sit for a minute and goes.
pub const TENSIONED_AFTER_S: f64 = 60.0;

/// Elongation at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reading {
    /// Time under the duty, s.
    pub time_s: f64,
    /// Strain of the strand from new and slack, m/m.
    pub strain_ratio: Bounded,
    /// Elongation of the strand from new and slack, m.
    pub elongation_m: Bounded,
    /// Elongation since a minute after tensioning, m.
    pub since_tensioned_m: Bounded,
    /// Part of it that unloading would not bring back, m.
    pub irreversible_m: Bounded,
}

/// The prediction for one rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Prediction {
    /// Rope.
    pub rope: String,
    /// The duty in words.
    pub duty: String,
    /// Its sums.
    pub summary: DutySummary,
    /// Strand length, m.
    pub length_m: f64,
    /// Tension the readings refer to, N.
    pub read_at_n: f64,
    /// Temperature the readings refer to, °C.
    pub read_at_c: f64,
    /// Readings.
    pub readings: Vec<Reading>,
    /// Strength left at the last reading, share of new; `None` where bending was not asked for or
    /// the rope's diameter is unknown.
    pub strength_left_share: Option<Bounded>,
    /// Share of draws in which the tension broke the rope, 0 to 1.
    pub broken_share: f64,
    /// Parameters of the law that are starting guesses.
    pub starting_guesses: usize,
    /// All parameters of the law.
    pub parameters: usize,
    /// Draws made.
    pub draws: usize,
    /// Their seed.
    pub seed: u64,
    /// Where the duty leaves what the law was made for, and other cautions.
    pub cautions: Vec<Caution>,
}

impl JsonDocument for Prediction {
    const SCHEMA: &'static str = "sinew/rope-predict/1";
}

/// Why there is no prediction.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PredictError {
    /// The rope.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The routing.
    #[error(transparent)]
    Routing(#[from] RoutingError),
    /// The load, with the catalogue's own values.
    #[error("rope '{rope}': {error}")]
    Load {
        /// Rope.
        rope: String,
        /// Why.
        error: LoadError,
    },
}

/// Predicts the elongation of a strand of one rope.
///
/// The strand is cut into portions by its guiding pulleys; each goes through the duty with its own
/// number of passes and its own share of tension. A rope that breaks in some draws is counted
/// there and left out of the intervals.
///
/// # Errors
/// [`PredictError`].
pub fn predict(rope: &CatalogueRope, request: &Request) -> Result<Prediction, PredictError> {
    predict_with_progress(rope, request, &|_| {})
}

/// [`predict`] with a call of `done` after each draw, with how many are done; not in order, from several threads.
///
/// # Errors
/// [`PredictError`].
pub fn predict_with_progress(
    rope: &CatalogueRope,
    request: &Request,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Prediction, PredictError> {
    Ok(drawn(rope, request, done)?.prediction(rope, request))
}

/// One rope's strand at the catalogue's values and in every draw.
pub(crate) struct Drawn {
    pub(crate) draws: Draws,
    read_at: RopeLoad,
    /// A minute after tensioning, then at the times of the request.
    nominal: Vec<Mean>,
    /// The same in each draw; `None` where the rope breaks.
    drawn: Vec<Option<Vec<Mean>>>,
}

/// Runs a strand through the duty, at the catalogue's values and in every draw.
pub(crate) fn drawn(
    rope: &CatalogueRope,
    request: &Request,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Drawn, PredictError> {
    let draws = Draws::new(rope, request.draws, request.seed)?;
    let summary = request.duty.summary();
    let read_at = request.read_at.unwrap_or(RopeLoad::celsius(
        summary.tension_mean_n,
        summary.temperature_mean_c,
    ));
    let mut times = vec![TENSIONED_AFTER_S];
    times.extend(&request.times_s);
    let nominal = strand(&draws.nominal, request, read_at, &times).map_err(|e| match e {
        StrandError::Load(error) => PredictError::Load {
            rope: rope.entry.name.clone(),
            error,
        },
        StrandError::Routing(error) => error.into(),
    })?;
    let finished = AtomicUsize::new(0);
    let each = draws.laws.par_iter().map(|law| {
        let means = strand(law, request, read_at, &times).ok();
        done(finished.fetch_add(1, Ordering::Relaxed) + 1);
        means
    });
    let drawn = each.collect();
    Ok(Drawn {
        draws,
        read_at,
        nominal,
        drawn,
    })
}

impl Drawn {
    /// Elongation since tensioned at the last time asked for, m, in each draw; NaN where the rope
    /// breaks.
    pub(crate) fn growth_m(&self, request: &Request) -> Vec<f64> {
        let of = |m: &Vec<Mean>| {
            let [first, .., last] = m.as_slice() else {
                return 0.0;
            };
            0.01 * request.route.length_m * (last.strain - first.strain)
        };
        let each = self.drawn.iter().map(|m| m.as_ref().map_or(f64::NAN, of));
        each.collect()
    }

    /// What the draws say.
    pub(crate) fn prediction(&self, rope: &CatalogueRope, request: &Request) -> Prediction {
        let drawn: Vec<&Vec<Mean>> = self.drawn.iter().flatten().collect();
        let broken = self.drawn.len() - drawn.len();
        let m_per_percent = 0.01 * request.route.length_m;
        let reading = |(at, &time_s): (usize, &f64)| {
            let interval = |f: &dyn Fn(&[Mean]) -> f64| {
                let all: Vec<f64> = drawn.iter().map(|m| f(m)).collect();
                bounded(f(&self.nominal), &all)
            };
            // The first is a minute after tensioning.
            let at = at + 1;
            let strain_percent = interval(&|m| m[at].strain);
            Reading {
                time_s,
                strain_ratio: strain_percent.scaled(0.01),
                elongation_m: strain_percent.scaled(m_per_percent),
                since_tensioned_m: interval(&|m| m[at].strain - m[0].strain).scaled(m_per_percent),
                irreversible_m: interval(&|m| m[at].irreversible).scaled(m_per_percent),
            }
        };
        let entry = &rope.entry;
        Prediction {
            rope: entry.name.clone(),
            duty: request.duty.about.clone(),
            summary: request.duty.summary(),
            length_m: request.route.length_m,
            read_at_n: self.read_at.tension_n,
            read_at_c: self.read_at.temperature_k - sinew_model::rope::CELSIUS_ZERO_K,
            readings: request.times_s.iter().enumerate().map(reading).collect(),
            strength_left_share: bending(rope, &self.draws, request),
            broken_share: broken as f64 / self.drawn.len().max(1) as f64,
            starting_guesses: entry.guesses(),
            parameters: entry.law.len(),
            draws: request.draws,
            seed: request.seed,
            cautions: cautions(rope, &self.draws.nominal, request),
        }
    }
}

fn bending(rope: &CatalogueRope, draws: &Draws, request: &Request) -> Option<Bounded> {
    let route = &request.route;
    let rope_m = 1e-3 * rope.entry.diameter_mm.as_ref()?.value;
    let hours = request.times_s.last()? / HOUR_S;
    // A stroke takes the rope on and off each pulley twice.
    let passes = 2.0 * route.strokes_per_hour * hours;
    if passes == 0.0 || route.pulleys.is_empty() {
        return None;
    }
    let tension_n = request.duty.summary().tension_mean_n;
    let left = |law: &Law| {
        // The worst portion passes every pulley.
        let mut state = State::default();
        for p in &route.pulleys {
            let bent = damage::bend(law, &mut state, tension_n, 2.0 * p.radius_m, rope_m, passes);
            if bent.is_err() {
                return f64::NAN;
            }
        }
        damage::strength_left(&state)
    };
    let (nominal, drawn) = draws.map(left);
    Some(bounded(nominal, &drawn))
}

fn cautions(rope: &CatalogueRope, law: &Law, request: &Request) -> Vec<Caution> {
    let mut outside = Outside::default();
    for s in &request.duty.stretches {
        outside = outside
            .or(Outside::of(law, s.from))
            .or(Outside::of(law, s.to));
    }
    let mut out = Caution::outside(outside);
    let entry = &rope.entry;
    if entry.breaking_load_n.is_none() {
        out.push(Caution::BreakingLoadGuessed {
            breaking_load_n: law.parameters().breaking_load_n,
        });
    }
    let longest = request.times_s.last().copied().unwrap_or(0.0);
    if entry.guesses() > 0 && longest > DAY_S {
        out.push(Caution::Extrapolated);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Catalogue, Duty};
    use sinew_model::rope::routing::Pulley;

    fn request(duty: Duty, route: Route) -> Request {
        Request {
            duty,
            route,
            times_s: TIMES_DEFAULT_S.to_vec(),
            read_at: None,
            draws: 200,
            seed: 1,
        }
    }

    #[test]
    fn a_constant_duty_is_the_law_itself() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let asked = request(Duty::constant(60.0, 23.0), Route::straight(0.7));
        let found = predict(rope, &asked).expect("a prediction");
        let law = Draws::new(rope, 0, 1).expect("complete").nominal;
        for reading in &found.readings {
            let mut s = State::default();
            let load = RopeLoad::at_reference(60.0);
            law.hold(&mut s, load, reading.time_s).expect("load");
            let strain = law.strain(&s, load).expect("load");
            let i = reading.strain_ratio.scaled(100.0);
            assert!((i.value - strain.total_percent()).abs() < 1e-9);
            assert!(i.low < i.value && i.value < i.high, "{i:?}");
            assert!((1e3 * reading.elongation_m.value - 7.0 * i.value).abs() < 1e-12);
        }
        assert!(found.cautions.contains(&Caution::Extrapolated));
    }

    #[test]
    fn guiding_pulleys_stretch_what_passes_them() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let pulley = |at_m| Pulley {
            at_m,
            radius_m: 0.008,
            wrap_rad: 1.0,
            friction: None,
        };
        let duty = Duty::constant(100.0, 23.0);
        let bare = predict(rope, &request(duty.clone(), Route::straight(0.7))).expect("bare");
        let mut route = Route::straight(0.7);
        route.stroke_m = 0.1;
        route.pulleys = vec![pulley(0.2), pulley(0.5)];
        route.strokes_per_hour = 60.0;
        let led = predict(rope, &request(duty, route)).expect("led");
        let growth = |p: &Prediction| 100.0 * p.readings[3].strain_ratio.value;
        assert!(growth(&led) > growth(&bare) + 0.01);
        let strength = led.strength_left_share.expect("bending was asked for");
        assert!(strength.low <= strength.value && strength.value <= strength.high);
        assert!(bare.strength_left_share.is_none());
    }

    #[test]
    fn a_load_that_breaks_the_rope_is_refused_and_one_that_may_is_counted() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let technora = catalogue.find("tu-chemnitz-technora-black").expect("there");
        let ask = |n: f64| {
            predict(
                technora,
                &request(Duty::constant(n, 23.0), Route::straight(0.7)),
            )
        };
        let error = ask(5000.0)
            .expect_err("above the breaking load")
            .to_string();
        assert!(error.contains("breaks a rope of 4500 N"), "{error}");
        let close = ask(4300.0).expect("below");
        assert!(
            close.broken_share > 0.05 && close.broken_share < 0.6,
            "{}",
            close.broken_share
        );
        let guessed = |c: &Caution| matches!(c, Caution::BreakingLoadGuessed { .. });
        assert!(close.cautions.iter().any(guessed));
    }
}
