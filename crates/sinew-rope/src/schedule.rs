//! A rope at constant length: decay of its tension, and times of re-tensioning.

use super::draws::{Draw, bounded};
use super::predict::{PredictError, TENSIONED_AFTER_S};
use super::procedure::{Mount, Procedure, Request};
use crate::law::strung::{RELAXATION_TOLERANCE, Strand, StrandAssembly};
use crate::law::tested_range::ModelError;
use crate::law::validity::LOAD_RATIO_HIGH;
use crate::law::{CELSIUS_ZERO_K, Law, LoadError, RopeLoad};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sinew_files::interrupt;
use sinew_model::Bounded;

/// Maximum number of re-tensionings in a schedule.
const EVENTS_MAX: usize = 100;

/// Schedule of re-tensioning at constant length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Schedule {
    /// Times of re-tensioning since stringing, s, at the catalogue values.
    pub times_s: Vec<f64>,
    /// Time of the first re-tensioning, s; NaN (null) if a draw has none.
    #[cfg_attr(feature = "schema", schemars(with = "PerhapsNever"))]
    pub first_s: Bounded,
    /// Share of the draws without any re-tensioning, 0 to 1.
    pub never_share: f64,
    /// Number of re-tensionings within the horizon.
    pub count: Bounded,
    /// Tension at the end of the horizon without re-tensioning, N.
    pub tension_at_end_n: Bounded,
    /// Initial tension with which the lowest tension is never reached within the horizon, N, limited to 40 % of the
    /// breaking load; `None` if that is insufficient at the catalogue values.
    pub start_n: Option<Bounded>,
    /// Tension over time without re-tensioning.
    pub unattended: Unattended,
}

/// Time and its bounds as in JSON: null where it does not occur within the horizon.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[expect(dead_code, reason = "the schema is made from its fields")]
struct PerhapsNever {
    /// Time at the catalogue values, s.
    value: Option<f64>,
    /// Lower bound, s.
    low: Option<f64>,
    /// Upper bound, s.
    high: Option<f64>,
}

/// Tension of a rope that is strung once and never re-tensioned, at the catalogue values.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unattended {
    /// Time since stringing, s.
    pub time_s: Vec<f64>,
    /// Tension, N; with a second rope, the mean of both strands.
    pub tension_n: Vec<f64>,
    /// Rotation of the joint under its torque, rad; empty without a joint.
    pub sag_rad: Vec<f64>,
}

/// Simulated relaxation of a strung rope.
struct Relaxation {
    /// Times at which the tension reached the lowest tension, s.
    events_s: Vec<f64>,
    /// Tension at the end of the horizon, N.
    tension_n: f64,
    trace: Unattended,
}

/// Strings ropes at `start_n`, keeps that tension for one minute and then fixes their length; with
/// `retension`, repeats this whenever the tension reaches the lowest tension.
fn string_up(
    strands: Vec<Strand>,
    error: ModelError,
    request: &Request,
    start_n: f64,
    retension: bool,
    tolerance: f64,
) -> Result<Relaxation, LoadError> {
    // Tension is the mean of both strands; the partner carries half of the load's tension difference less.
    let half_n = 0.5 * request.mount.extra_n();
    let kelvin = request.temperature_c + CELSIUS_ZERO_K;
    let strung = StrandAssembly::new(strands, start_n - half_n, kelvin, TENSIONED_AFTER_S)?;
    let mut strung = strung.with_model_error(error);
    let mut at = TENSIONED_AFTER_S;
    let mut out = Relaxation {
        events_s: Vec::new(),
        tension_n: start_n,
        trace: Unattended::default(),
    };
    loop {
        let until_n = retension.then_some(request.lowest_n - half_n);
        out.trace.see(at, start_n, 0.0, &request.mount);
        let left_s = (request.horizon_s - at).max(0.0);
        let (mount, trace) = (&request.mount, &mut out.trace);
        let mut seen = |s: f64, strung: &StrandAssembly| {
            trace.see(at + s, strung.tension_n() + half_n, strung.sag_m(), mount);
        };
        at += strung.leave(left_s, until_n, tolerance, &mut seen)?;
        out.tension_n = strung.tension_n() + half_n;
        if until_n.is_none_or(|low| strung.tension_n() > low * (1.0 + 1e-9)) || left_s == 0.0 {
            return Ok(out);
        }
        out.events_s.push(at);
        if out.events_s.len() >= EVENTS_MAX {
            return Ok(out);
        }
        strung.tension_again(start_n - half_n, TENSIONED_AFTER_S)?;
        at += TENSIONED_AFTER_S;
    }
}

impl Unattended {
    fn see(&mut self, time_s: f64, tension_n: f64, sag_m: f64, mount: &Mount) {
        self.time_s.push(time_s);
        self.tension_n.push(tension_n);
        self.sag_rad.extend(mount.joint.map(|j| sag_m / j.radius_m));
    }
}

pub(super) fn schedule(
    nominal: &Law,
    each: &[Draw<'_>],
    request: &Request,
    rope_m: Option<f64>,
    procedure: Option<Procedure>,
    to_error: impl Fn(LoadError) -> PredictError + Copy + Sync,
) -> Result<Schedule, PredictError> {
    let strands = |law: &Law| -> Result<Vec<Strand>, PredictError> {
        let mut pieces = request
            .mount
            .pieces(law, request.length_m, rope_m, request.tension_n)?;
        for piece in pieces.iter_mut() {
            if let Some(p) = procedure {
                let load = RopeLoad::celsius(p.tension_n, request.temperature_c);
                let held = piece.law.hold(&mut piece.state, load, p.duration_s);
                held.map_err(to_error)?;
            }
        }
        Ok(request.mount.strands(pieces))
    };
    let one = |law: &Law, error: ModelError| {
        let strands = strands(law)?;
        let relax = |retension| {
            let (strands, start_n) = (strands.clone(), request.tension_n);
            let tolerance = RELAXATION_TOLERANCE;
            string_up(strands, error, request, start_n, retension, tolerance).map_err(to_error)
        };
        let start_n = start(law, &strands, error, request).map_err(to_error)?;
        Ok::<_, PredictError>((relax(true)?.events_s, relax(false)?, start_n))
    };
    let (times_s, unattended, start_n) = one(nominal, ModelError::default())?;
    let stiffness_error = |draw: &Draw<'_>| {
        interrupt::check();
        let load_share = draw.law.load_ratio(request.tension_n);
        let factor = draw.error.immediate_factor(load_share);
        one(&draw.law.with_stiffness_error(factor), draw.error).ok()
    };
    let drawn: Vec<_> = each
        .par_iter()
        .map(stiffness_error)
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect();
    let never = drawn.iter().filter(|d| d.0.is_empty()).count();
    type Drawn = (Vec<f64>, Relaxation, Option<f64>);
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
    let limit_n = LOAD_RATIO_HIGH * nominal.parameters().breaking_load_n;
    Ok(Schedule {
        first_s: finite(bounded(first(&times_s), &collect(&|d| first(&d.0)))),
        never_share: never as f64 / drawn.len().max(1) as f64,
        count: bounded(times_s.len() as f64, &collect(&|d| d.0.len() as f64)),
        tension_at_end_n: bounded(unattended.tension_n, &collect(&|d| d.1.tension_n)),
        start_n: start_n.map(|value| bounded(value, &collect(&|d| d.2.unwrap_or(limit_n)))),
        times_s,
        unattended: unattended.trace,
    })
}

/// Smallest initial tension with which the tension at the horizon is at least the lowest one, N.
fn start(
    law: &Law,
    strands: &[Strand],
    error: ModelError,
    request: &Request,
) -> Result<Option<f64>, LoadError> {
    /// Tolerance of the relaxation; the initial tension is searched to half a per cent.
    const TOLERANCE: f64 = 1e-5;
    let ends = |start_n: f64| {
        string_up(strands.to_vec(), error, request, start_n, false, TOLERANCE)
            .map(|s| s.tension_n - request.lowest_n)
    };
    // More tension is not always better, because it adds bedding-in. The lowest sufficient one is searched
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
    use crate::pretension::tests::{planned, request};
    use crate::{Catalogue, Draws};

    /// Tension at the horizon of a new rope.
    fn ends(law: &Law, request: &Request, start_n: f64) -> f64 {
        let pieces = request
            .mount
            .pieces(law, request.length_m, None, request.tension_n)
            .expect("a strand");
        let strands = request.mount.strands(pieces);
        let error = ModelError::default();
        string_up(
            strands,
            error,
            request,
            start_n,
            false,
            RELAXATION_TOLERANCE,
        )
        .expect("load")
        .tension_n
    }

    #[test]
    fn bedding_in_saves_re_tensioning() {
        let p = planned("liros-dc000-0301", &request());
        let (new, bedded) = (&p.schedule_as_delivered, &p.schedule_preconditioned);
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
        // StrandAssembly so, it ends where it must, and a bit less would not do.
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
        let ends = |n: f64| ends(&law, &request(), n);
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
            let end = ends(&law, &r, 60.0);
            assert!(end < last && end > 0.0, "{days} d: {end} N");
            last = end;
        }
    }
}
