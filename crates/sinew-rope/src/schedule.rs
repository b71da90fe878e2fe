//! A rope at constant length: how its tension falls, and when to tension it again.

use super::draws::{Draws, bounded};
use super::predict::TENSIONED_AFTER_S;
use super::procedure::{Procedure, Request};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;
use sinew_model::rope::validity::LOAD_RATIO_HIGH;
use sinew_model::rope::{Law, LoadError, RopeLoad, State};

/// First step at constant length, s, and how much longer each next one is: a tension that falls
/// with the logarithm of time changes by a few per mille per step.
const STEP_S: f64 = 5.0;
const STEP_GROWTH: f64 = 1.12;
/// More re-tensionings than this are no schedule.
const EVENTS_MAX: usize = 100;

/// When to tension again at constant length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Schedule {
    /// Times since stringing, s, with the catalogue's own values.
    pub times_s: Vec<f64>,
    /// First of them; NaN (null) where a draw has none.
    #[cfg_attr(feature = "schema", schemars(with = "PerhapsNever"))]
    pub first_s: Bounded,
    /// Share of draws that need no re-tensioning at all.
    pub never_share: f64,
    /// How many within the horizon.
    pub count: Bounded,
    /// Tension at the horizon's end without any re-tensioning, N.
    pub tension_at_end_n: Bounded,
    /// Tension to string the rope with so that it never falls below the lowest within the
    /// horizon, N; `None` where even 40 % of the breaking load does not do.
    pub start_n: Option<Bounded>,
    /// Its tension when it is left alone.
    pub left_alone: LeftAlone,
}

/// A time and its bounds as JSON has them: null where it never comes.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[expect(dead_code, reason = "the schema is made from its fields")]
struct PerhapsNever {
    /// With the catalogue's own values, s.
    value: Option<f64>,
    /// Lower bound, s.
    low: Option<f64>,
    /// Upper bound, s.
    high: Option<f64>,
}

/// Tension of a rope that is strung once and left alone, at the catalogue's own values.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftAlone {
    /// Time since stringing, s.
    pub time_s: Vec<f64>,
    /// Tension, N.
    pub tension_n: Vec<f64>,
}

/// One rope at constant length.
struct Strung {
    /// When tension had fallen below the lowest, s.
    events_s: Vec<f64>,
    /// Tension at the end, N.
    tension_n: f64,
    trace: LeftAlone,
}

/// Strings a rope at `start_n`, gives it a minute at that tension and leaves it at the length it
/// then has; `retension` does the same again whenever its tension has fallen below the lowest.
fn string_up(
    law: &Law,
    mut state: State,
    request: &Request,
    start_n: f64,
    retension: bool,
) -> Result<Strung, LoadError> {
    let load = |tension_n: f64| RopeLoad::celsius(tension_n, request.temperature_c);
    let settle = |state: &mut State| {
        law.hold(state, load(start_n), TENSIONED_AFTER_S)?;
        Ok(law.strain(state, load(start_n))?.total_percent())
    };
    let mut length = settle(&mut state)?;
    let (mut at, mut step, mut tension_n) = (TENSIONED_AFTER_S, STEP_S, start_n);
    let mut out = Strung {
        events_s: Vec::new(),
        tension_n,
        trace: LeftAlone::default(),
    };
    while at < request.horizon_s {
        out.trace.time_s.push(at);
        out.trace.tension_n.push(tension_n);
        let dt = f64::min(step, request.horizon_s - at);
        law.hold(&mut state, load(tension_n), dt)?;
        at += dt;
        step *= STEP_GROWTH;
        tension_n = tension_at(law, &state, length, tension_n, request.temperature_c)?;
        if tension_n < request.lowest_n && retension {
            out.events_s.push(at);
            if out.events_s.len() >= EVENTS_MAX {
                break;
            }
            length = settle(&mut state)?;
            (at, step, tension_n) = (at + TENSIONED_AFTER_S, STEP_S, start_n);
        }
    }
    out.trace.time_s.push(at);
    out.trace.tension_n.push(tension_n);
    out.tension_n = tension_n;
    Ok(out)
}

/// Tension at which the strain is `length`, N; 0 when the rope is slack.
fn tension_at(
    law: &Law,
    state: &State,
    length: f64,
    guess_n: f64,
    temperature_c: f64,
) -> Result<f64, LoadError> {
    let excess = |tension_n: f64| {
        law.strain(state, RopeLoad::celsius(tension_n, temperature_c))
            .map(|s| s.total_percent() - length)
    };
    if excess(0.0)? >= 0.0 {
        return Ok(0.0);
    }
    // Strain rises with tension: bisection between slack and a bit above the guess.
    let top = law.parameters().breaking_load_n;
    let (mut low, mut high) = (0.0, f64::min(2.0 * guess_n + 1.0, top));
    if excess(high)? < 0.0 {
        high = top;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle)? < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
        if high - low < 1e-9 * high {
            break;
        }
    }
    Ok(0.5 * (low + high))
}

pub(super) fn schedule(
    draws: &Draws,
    request: &Request,
    procedure: Option<Procedure>,
) -> Result<Schedule, LoadError> {
    let bedded = |law: &Law| {
        let mut state = State::default();
        if let Some(p) = procedure {
            let load = RopeLoad::celsius(p.tension_n, request.temperature_c);
            law.hold(&mut state, load, p.duration_s)?;
        }
        Ok::<State, LoadError>(state)
    };
    let one = |law: &Law| {
        let state = bedded(law)?;
        let with = string_up(law, state, request, request.tension_n, true)?;
        let without = string_up(law, state, request, request.tension_n, false)?;
        let start_n = start(law, state, request)?;
        Ok::<_, LoadError>((with.events_s, without, start_n))
    };
    let (times_s, left_alone, start_n) = one(&draws.nominal)?;
    let drawn: Vec<_> = draws
        .laws
        .par_iter()
        .map(|law| one(law).ok())
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect();
    let never = drawn.iter().filter(|d| d.0.is_empty()).count();
    type Drawn = (Vec<f64>, Strung, Option<f64>);
    let collect = |f: &dyn Fn(&Drawn) -> f64| -> Vec<f64> { drawn.iter().map(f).collect() };
    let first = |events: &[f64]| events.first().copied().unwrap_or(f64::INFINITY);
    let finite = |i: Bounded| {
        let nan = |v: f64| if v.is_finite() { v } else { f64::NAN };
        Bounded {
            low: nan(i.low),
            value: nan(i.value),
            high: nan(i.high),
        }
    };
    Ok(Schedule {
        first_s: finite(bounded(first(&times_s), &collect(&|d| first(&d.0)))),
        never_share: never as f64 / drawn.len().max(1) as f64,
        count: bounded(times_s.len() as f64, &collect(&|d| d.0.len() as f64)),
        tension_at_end_n: bounded(left_alone.tension_n, &collect(&|d| d.1.tension_n)),
        start_n: start_n.map(|value| bounded(value, &collect(&|d| d.2.unwrap_or(f64::NAN)))),
        times_s,
        left_alone: left_alone.trace,
    })
}

/// Least tension to string a rope with so that at the horizon it still has the lowest one.
fn start(law: &Law, state: State, request: &Request) -> Result<Option<f64>, LoadError> {
    let ends = |start_n: f64| {
        string_up(law, state, request, start_n, false).map(|s| s.tension_n - request.lowest_n)
    };
    // More tension is not always better: it beds the rope in anew. The least that does is sought
    // from below.
    const GROWTH: f64 = 1.06;
    let limit = LOAD_RATIO_HIGH * law.parameters().breaking_load_n;
    let (mut low, mut high) = (request.lowest_n, request.lowest_n * GROWTH);
    while high <= limit && ends(high)? < 0.0 {
        low = high;
        high *= GROWTH;
    }
    if high > limit {
        return Ok(None);
    }
    // To half a per cent of the range's lower end: finer than any tensioner.
    while high - low > 0.005 * request.lowest_n {
        let middle = 0.5 * (low + high);
        if ends(middle)? < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Some(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Catalogue;
    use crate::predict::{MONTH_S, YEAR_S};
    use crate::pretension::{Plan, plan};

    fn request() -> Request {
        Request {
            tension_n: 60.0,
            temperature_c: 23.0,
            length_m: 0.7,
            horizon_s: YEAR_S,
            lowest_n: 45.0,
            remove: 0.7,
            draws: 40,
            seed: 1,
        }
    }

    fn planned(name: &str, request: &Request) -> Plan {
        let catalogue = Catalogue::shipped().expect("shipped");
        plan(catalogue.find(name).expect("there"), request).expect("a plan")
    }

    #[test]
    fn bedding_in_saves_re_tensioning() {
        let p = planned("liros-dc000-0301", &request());
        let (new, bedded) = (&p.schedule_new, &p.schedule_bedded);
        assert!(
            new.times_s.len() > bedded.times_s.len(),
            "{new:?} {bedded:?}"
        );
        assert!(bedded.tension_at_end_n.value > new.tension_at_end_n.value);
        assert!(new.times_s.windows(2).all(|w| w[0] < w[1]));
        let start = new
            .start_n
            .expect("40 % of the breaking load is enough")
            .value;
        // Strung so, it ends where it must, and a bit less would not do.
        let law = Draws::new(
            Catalogue::shipped()
                .expect("shipped")
                .find("liros-dc000-0301")
                .expect("there"),
            0,
            1,
        )
        .expect("complete")
        .nominal;
        let ends = |n: f64| {
            string_up(&law, State::default(), &request(), n, false)
                .expect("load")
                .tension_n
        };
        assert!(ends(start) >= 45.0 && ends(start * 0.98) < 45.0);
    }

    #[test]
    fn tension_falls_at_constant_length_and_strain_stays() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let law = Draws::new(rope, 0, 1).expect("complete").nominal;
        let mut last = 60.0;
        for days in [1.0, 10.0, 100.0] {
            let r = Request {
                horizon_s: days * 86_400.0,
                ..request()
            };
            let end = string_up(&law, State::default(), &r, 60.0, false)
                .expect("load")
                .tension_n;
            assert!(end < last && end > 0.0, "{days} d: {end} N");
            last = end;
        }
    }

    #[test]
    fn steps_at_constant_length_are_short_enough() {
        // The same rope in a hundred equal steps per decade against the program's own.
        let catalogue = Catalogue::shipped().expect("shipped");
        let rope = catalogue.find("liros-dc000-0301").expect("there");
        let law = Draws::new(rope, 0, 1).expect("complete").nominal;
        let r = Request {
            horizon_s: MONTH_S,
            ..request()
        };
        let coarse = string_up(&law, State::default(), &r, 60.0, false)
            .expect("load")
            .tension_n;
        let mut state = State::default();
        law.hold(&mut state, RopeLoad::at_reference(60.0), TENSIONED_AFTER_S)
            .expect("load");
        let length = law
            .strain(&state, RopeLoad::at_reference(60.0))
            .expect("load")
            .total_percent();
        let (mut t, mut n) = (TENSIONED_AFTER_S, 60.0);
        while t < MONTH_S {
            let dt = f64::min(0.2 + 0.01 * (t - TENSIONED_AFTER_S), MONTH_S - t);
            law.hold(&mut state, RopeLoad::at_reference(n), dt)
                .expect("load");
            n = tension_at(&law, &state, length, n, 23.0).expect("load");
            t += dt;
        }
        assert!((coarse / n - 1.0).abs() < 0.01, "{coarse} {n}");
    }
}
