//! How to bed a rope in, how much pretension to give it, and when to tension it again.
//!
//! Two pictures of the same rope. *At constant tension* (a weight hangs on it) it grows; the
//! procedure that takes most of that growth away beforehand is sought. *At constant length*
//! (strung in a machine and left alone) its tension falls; the schedule says when it has fallen
//! too far.

use super::draws::{Draws, Interval};
use super::predict::{HOUR_S, TENSIONED_AFTER_S, in_parallel};
use super::{CatalogueError, CatalogueRope};
use serde::Serialize;
use sinew_model::rope::validity::LOAD_RATIO_HIGH;
use sinew_model::rope::{Law, Load, LoadError, State};

/// Bedding-in tensions tried, as multiples of the working tension.
const TENSIONS: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
/// Bedding-in durations tried, s.
const DURATIONS_S: [f64; 4] = [600.0, HOUR_S, 4.0 * HOUR_S, 24.0 * HOUR_S];
/// Times, spread evenly over the logarithm, at which later elongation is looked at.
const LOOKS: usize = 24;
/// First step at constant length, s, and how much longer each next one is: a tension that falls
/// with the logarithm of time changes by a few per mille per step.
const STEP_S: f64 = 5.0;
const STEP_GROWTH: f64 = 1.12;
/// More re-tensionings than this are no schedule.
const EVENTS_MAX: usize = 100;

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Working tension, N.
    pub tension_n: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Strand length, m.
    pub length_m: f64,
    /// How long it must hold, s.
    pub horizon_s: f64,
    /// Tension below which the rope is tensioned again, N.
    pub lowest_n: f64,
    /// Share of the later elongation that the procedure must take away, 0 to 1.
    pub remove: f64,
    /// Draws for the intervals.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// A bedding-in procedure and what it does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Procedure {
    /// Held at this tension, N.
    pub tension_n: f64,
    /// For this long, s.
    pub duration_s: f64,
    /// Largest elongation at working tension that is still to come, mm, counted from a minute
    /// after the rope is back at working tension.
    pub still_to_come_mm: Interval,
    /// Share of the elongation without procedure that it takes away.
    pub removed: Interval,
}

/// When to tension again at constant length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Schedule {
    /// Times since stringing, s, with the catalogue's own values.
    pub times_s: Vec<f64>,
    /// First of them; NaN (null) where a draw has none.
    pub first_s: Interval,
    /// Share of draws that need no re-tensioning at all.
    pub never_share: f64,
    /// How many within the horizon.
    pub count: Interval,
    /// Tension at the horizon's end without any re-tensioning, N.
    pub tension_at_end_n: Interval,
    /// Tension to string the rope with so that it never falls below the lowest within the
    /// horizon, N; `None` where even 40 % of the breaking load does not do.
    pub start_n: Option<Interval>,
}

/// The plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// Rope.
    pub rope: String,
    /// Working tension, N.
    pub tension_n: f64,
    /// Lowest tension allowed, N.
    pub lowest_n: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Strand length, mm.
    pub length_mm: f64,
    /// How long it must hold, s.
    pub horizon_s: f64,
    /// Largest later elongation without any procedure, mm.
    pub without_mm: Interval,
    /// All procedures tried, by tension, then duration.
    pub procedures: Vec<Procedure>,
    /// Index of the gentlest one that takes away what is asked, at catalogue values: least
    /// tension first, then least time.
    pub chosen: Option<usize>,
    /// Schedule of a rope strung as it comes.
    pub schedule_new: Schedule,
    /// Schedule after the chosen procedure (or the most effective one).
    pub schedule_bedded: Schedule,
    /// Parameters of the law that are starting guesses.
    pub starting_guesses: usize,
    /// All parameters of the law.
    pub parameters: usize,
    /// Cautions.
    pub warnings: Vec<String>,
}

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PretensionError {
    /// The rope.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The load, with the catalogue's own values.
    #[error("rope '{rope}': {error}")]
    Load {
        /// Rope.
        rope: String,
        /// Why.
        error: LoadError,
    },
}

/// Makes a plan for one rope.
///
/// # Errors
/// [`PretensionError`].
pub fn plan(rope: &CatalogueRope, request: &Request) -> Result<Plan, PretensionError> {
    let draws = Draws::new(rope, request.draws, request.seed)?;
    let work = Load::celsius(request.tension_n, request.temperature_c);
    let refuse = |error| PretensionError::Load {
        rope: rope.entry.name.clone(),
        error,
    };
    let mm = 10.0 * request.length_m;
    // Without a procedure, and with each: nominal and every draw.
    let later = |procedure: Option<(f64, f64)>| -> Result<(f64, Vec<f64>), LoadError> {
        let one = |law: &Law| {
            let mut state = State::default();
            if let Some((tension_n, duration_s)) = procedure {
                let load = Load { tension_n, ..work };
                law.hold(&mut state, load, duration_s)?;
            }
            still_to_come(law, state, work, request.horizon_s).map(|v| mm * v)
        };
        let drawn = in_parallel(&draws.laws, |law| one(law).unwrap_or(f64::NAN));
        Ok((one(&draws.nominal)?, drawn))
    };
    let (without, without_drawn) = later(None).map_err(refuse)?;
    let mut procedures = Vec::new();
    let limit_n = LOAD_RATIO_HIGH * draws.nominal.parameters().breaking_load_n;
    for times in TENSIONS {
        let tension_n = times * request.tension_n;
        if times > 1.0 && tension_n > limit_n {
            break;
        }
        for duration_s in DURATIONS_S {
            let (value, drawn) = later(Some((tension_n, duration_s))).map_err(refuse)?;
            let removed: Vec<f64> = drawn
                .iter()
                .zip(&without_drawn)
                .map(|(with, without)| 1.0 - with / without)
                .collect();
            procedures.push(Procedure {
                tension_n,
                duration_s,
                still_to_come_mm: Interval::of(value, &drawn),
                removed: Interval::of(1.0 - value / without, &removed),
            });
        }
    }
    let chosen = procedures
        .iter()
        .position(|p| p.removed.value >= request.remove);
    let best = procedures
        .iter()
        .max_by(|a, b| a.removed.value.total_cmp(&b.removed.value))
        .copied();
    let bedded = chosen.map(|i| procedures[i]).or(best);
    let schedule_new = schedule(&draws, request, None).map_err(refuse)?;
    let schedule_bedded = schedule(&draws, request, bedded).map_err(refuse)?;
    let entry = &rope.entry;
    let outside = draws.nominal.outside(work);
    let mut warnings: Vec<String> = outside.sentences().map(str::to_string).collect();
    if entry.guesses() > 0 {
        warnings.push(format!(
            "{} of {} parameters are starting guesses: check the plan on one rope before it is \
             used on many",
            entry.guesses(),
            entry.law.len()
        ));
    }
    Ok(Plan {
        rope: entry.name.clone(),
        tension_n: request.tension_n,
        lowest_n: request.lowest_n,
        temperature_c: request.temperature_c,
        length_mm: 1e3 * request.length_m,
        horizon_s: request.horizon_s,
        without_mm: Interval::of(without, &without_drawn),
        procedures,
        chosen,
        schedule_new,
        schedule_bedded,
        starting_guesses: entry.guesses(),
        parameters: entry.law.len(),
        warnings,
    })
}

/// Largest elongation at constant load from a minute on, %.
fn still_to_come(
    law: &Law,
    mut state: State,
    load: Load,
    horizon_s: f64,
) -> Result<f64, LoadError> {
    law.hold(&mut state, load, TENSIONED_AFTER_S)?;
    let start = law.strain(&state, load)?.total_percent();
    let rates = law.rates(load)?;
    let ratio = (horizon_s / TENSIONED_AFTER_S).max(1.0);
    let mut at = TENSIONED_AFTER_S;
    let mut most = 0.0f64;
    for i in 1..=LOOKS {
        let next = TENSIONED_AFTER_S * ratio.powf(i as f64 / LOOKS as f64);
        law.advance(&mut state, &rates, next - at)?;
        at = next;
        let strain = law.strain(&state, load)?.total_percent();
        most = most.max(strain - start);
    }
    Ok(most)
}

/// One rope at constant length.
struct Strung {
    /// When tension had fallen below the lowest, s.
    events_s: Vec<f64>,
    /// Tension at the end, N.
    tension_n: f64,
}

/// Strings a rope at `start_n` and leaves it at its length; `retension` tensions it again
/// whenever it has fallen below the lowest.
fn string_up(
    law: &Law,
    mut state: State,
    request: &Request,
    start_n: f64,
    retension: bool,
) -> Result<Strung, LoadError> {
    let load = |tension_n: f64| Load::celsius(tension_n, request.temperature_c);
    let mut tension_n = start_n;
    let mut length = law.strain(&state, load(tension_n))?.total_percent();
    let (mut at, mut step) = (0.0, STEP_S);
    let mut events_s = Vec::new();
    while at < request.horizon_s {
        let dt = f64::min(step, request.horizon_s - at);
        law.hold(&mut state, load(tension_n), dt)?;
        at += dt;
        step *= STEP_GROWTH;
        tension_n = tension_at(law, &state, length, tension_n, request.temperature_c)?;
        if tension_n < request.lowest_n && retension {
            events_s.push(at);
            if events_s.len() >= EVENTS_MAX {
                break;
            }
            tension_n = start_n;
            length = law.strain(&state, load(tension_n))?.total_percent();
            step = STEP_S;
        }
    }
    Ok(Strung {
        events_s,
        tension_n,
    })
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
        law.strain(state, Load::celsius(tension_n, temperature_c))
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

fn schedule(
    draws: &Draws,
    request: &Request,
    procedure: Option<Procedure>,
) -> Result<Schedule, LoadError> {
    let bedded = |law: &Law| {
        let mut state = State::default();
        if let Some(p) = procedure {
            let load = Load::celsius(p.tension_n, request.temperature_c);
            law.hold(&mut state, load, p.duration_s)?;
        }
        Ok::<State, LoadError>(state)
    };
    let one = |law: &Law| {
        let state = bedded(law)?;
        let with = string_up(law, state, request, request.tension_n, true)?;
        let without = string_up(law, state, request, request.tension_n, false)?;
        Ok::<_, LoadError>((
            with.events_s,
            without.tension_n,
            start(law, state, request)?,
        ))
    };
    let (times_s, end_n, start_n) = one(&draws.nominal)?;
    let drawn: Vec<_> = in_parallel(&draws.laws, |law| one(law).ok())
        .into_iter()
        .flatten()
        .collect();
    let never = drawn.iter().filter(|d| d.0.is_empty()).count();
    type Drawn = (Vec<f64>, f64, Option<f64>);
    let collect = |f: &dyn Fn(&Drawn) -> f64| -> Vec<f64> { drawn.iter().map(f).collect() };
    let first = |events: &[f64]| events.first().copied().unwrap_or(f64::INFINITY);
    let finite = |i: Interval| {
        let nan = |v: f64| if v.is_finite() { v } else { f64::NAN };
        Interval {
            low: nan(i.low),
            value: nan(i.value),
            high: nan(i.high),
        }
    };
    Ok(Schedule {
        first_s: finite(Interval::of(first(&times_s), &collect(&|d| first(&d.0)))),
        never_share: never as f64 / drawn.len().max(1) as f64,
        count: Interval::of(times_s.len() as f64, &collect(&|d| d.0.len() as f64)),
        tension_at_end_n: Interval::of(end_n, &collect(&|d| d.1)),
        start_n: start_n.map(|value| Interval::of(value, &collect(&|d| d.2.unwrap_or(f64::NAN)))),
        times_s,
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
    use crate::rope::Catalogue;
    use crate::rope::predict::{MONTH_S, YEAR_S};

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
    fn more_tension_and_more_time_leave_less_to_come() {
        let p = planned("liros-dc000-0301", &request());
        assert_eq!(p.procedures.len(), 24);
        for pair in p.procedures.windows(2) {
            if pair[0].tension_n == pair[1].tension_n {
                let (short, long) = (pair[0].still_to_come_mm, pair[1].still_to_come_mm);
                assert!(long.value <= short.value + 1e-12, "{pair:?}");
            }
        }
        let chosen = p.procedures[p.chosen.expect("one does it")];
        assert!(chosen.removed.value >= 0.7 && chosen.tension_n >= 60.0);
        assert!(chosen.still_to_come_mm.value <= 0.3 * p.without_mm.value + 1e-12);
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
        let length = law
            .strain(&state, Load::at_reference(60.0))
            .expect("load")
            .total_percent();
        let (mut t, mut n) = (0.0, 60.0);
        while t < MONTH_S {
            let dt = f64::min(0.2 + 0.01 * t, MONTH_S - t);
            law.hold(&mut state, Load::at_reference(n), dt)
                .expect("load");
            n = tension_at(&law, &state, length, n, 23.0).expect("load");
            t += dt;
        }
        assert!((coarse / n - 1.0).abs() < 0.01, "{coarse} {n}");
    }
}
