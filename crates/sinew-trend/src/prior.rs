//! Prior of a tendon from the creep law of its rope.

use super::clock::BASELINE_AFTER_S;
use super::result::{MissingFromRobot, PriorBasis};
use crate::filter::{Curve, Prior, generic_curves, node_times_s};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sinew_files::date::DAY_S;
use sinew_model::transmission::Tendon;
use sinew_rope::history::History;
use sinew_rope::law::tested_range::AddedStrain;
use sinew_rope::law::{Law, RopeLoad, State};
use sinew_rope::work::{Work, strand};
use sinew_rope::{Catalogue, CatalogueError, CatalogueRope, Draws, Duty};

/// Number of draws of the law that represent the rope.
pub const CURVES: usize = 200;
/// Prior probability of the generic curves: the law may be wrong, and its longest retardation time
/// is a day.
const GENERIC_SHARE: f64 = 0.2;
/// Standard deviation of a drawn curve's amplitude: strands, pretension and pulleys differ from
/// their description.
const AMPLITUDE_DEVIATION: f64 = 0.4;
/// Plausible creep of the first year of any rope: strain as a fraction. Laws of the catalogue at 1
/// to 8 % of the breaking load: 0.05 to 0.4 %.
const GENERIC_STRAIN: f64 = 3e-3;
/// Range of `L/r` of a tendon without a description.
const LENGTH_OVER_RADIUS: [f64; 2] = [10.0, 60.0];
/// Range of pretension over breaking load of an unspecified rope.
const PRETENSION_SHARE: [f64; 2] = [0.01, 0.08];
/// Relative spread of the highest tension between days.
const PEAK_SPREAD: f64 = 0.05;
/// Size of the creep steps of an unspecified rope, rad: metal ropes bed in on single days.
const UNKNOWN_STEP_RAD: f64 = 0.3e-3;

/// Offset at the nodes of [`node_times_s`] under a load, rad, at pretension and the law's reference
/// temperature; `None` if the tension breaks the rope.
///
/// The rope rests for an hour after tensioning, until its baseline. Then, between nodes, delayed
/// elasticity, flow and retraction follow the mean tension, bedding-in and flow the peaks for their
/// share of the time. Peaks differ between days: the highest of all days exceeds the usual one, and
/// a rope beds in further on that day.
pub fn work_curve(law: &Law, tendon: &Tendon, pretension_n: f64, work: &Work) -> Option<Vec<f64>> {
    through(law, tendon, pretension_n, |law, state, from_s, to_s| {
        work_step(law, state, pretension_n, work, [from_s, to_s], to_s)
    })
}

/// Advances a section between two times since its last tensioning, s, to the age `age_s` of the rope.
fn work_step(
    law: &Law,
    state: &mut State,
    pretension_n: f64,
    work: &Work,
    [from_s, to_s]: [f64; 2],
    age_s: f64,
) -> Option<()> {
    let load = |factor: f64| RopeLoad::celsius(pretension_n * factor, work.temperature_c);
    let quiet_s = (BASELINE_AFTER_S - from_s).clamp(0.0, to_s - from_s);
    law.hold(state, load(1.0), quiet_s).ok()?;
    let dt = to_s - from_s - quiet_s;
    let mut pulled = *state;
    law.hold(state, load(work.mean_factor), dt).ok()?;
    let flow = state.flow_percent;
    let peak = load(work.peak_factor);
    law.hold(&mut pulled, peak, dt * work.peak_share).ok()?;
    let height = 1.0 + PEAK_SPREAD * highest_of(age_s / DAY_S);
    if height > 1.0 {
        let highest = load(work.peak_factor * height);
        let day_s = dt.min(DAY_S);
        law.hold(&mut pulled, highest, day_s * work.peak_share)
            .ok()?;
    }
    state.bedding_percent = state.bedding_percent.max(pulled.bedding_percent);
    state.flow_percent = flow.max(pulled.flow_percent);
    Some(())
}

/// Additional offset at the nodes of [`node_times_s`] after a re-tensioning, per lost share of the
/// pretension, rad; `None` if the tension breaks the rope.
///
/// The difference between a rope whose tension has fallen in proportion to the logarithm of its age
/// to half of the pretension and then rises to the pretension again, and the same rope at constant
/// pretension. It is linear in the lost share for delayed elasticity, and nearly so for bedding-in.
pub fn retensioned_curve(
    law: &Law,
    tendon: &Tendon,
    pretension_n: f64,
    work: &Work,
) -> Option<Vec<f64>> {
    /// Age of the rope at the re-tensioning, s. Relative to the first day's, the additional creep of
    /// ropes of 30 to 300 days differs by less than a tenth.
    const AGE_S: f64 = 100.0 * DAY_S;
    /// Share of the pretension that is lost by then.
    const LOST_RATIO: f64 = 0.5;
    let read = RopeLoad::at_reference(pretension_n);
    let times = node_times_s();
    let mut out = vec![0.0; times.len()];
    for portion in strand(tendon) {
        let law = law.passed_by(portion.guides as f64);
        let per_percent = 0.01 * portion.length_m / tendon.joint_pulley_radius_m;
        for (lost, per_percent) in [
            (LOST_RATIO, per_percent / LOST_RATIO),
            (0.0, -per_percent / LOST_RATIO),
        ] {
            let (mut state, mut from_s) = (State::default(), 0.0);
            for &t in times.iter().take_while(|t| **t <= AGE_S) {
                let tension_n = pretension_n * (1.0 - lost * (1.0 + t).ln() / (1.0 + AGE_S).ln());
                work_step(&law, &mut state, tension_n, work, [from_s, t], t)?;
                from_s = t;
            }
            let total = |state: &State| Some(law.strain(state, read).ok()?.total_percent());
            let (start, mut from_s) = (total(&state)?, 0.0);
            for (value, &t) in out.iter_mut().zip(&times) {
                let between_s = [from_s, t];
                work_step(&law, &mut state, pretension_n, work, between_s, AGE_S + t)?;
                *value += per_percent * (total(&state)? - start);
                from_s = t;
            }
        }
    }
    out.iter().all(|v| v.is_finite()).then_some(out)
}

/// Expected maximum of `count` standard normal numbers: `√(2 ln n) − (ln ln n + ln 4π)/(2 √(2 ln
/// n))`.
fn highest_of(count: f64) -> f64 {
    let root = (2.0 * count.max(2.0).ln()).sqrt();
    let fourth = (4.0 * std::f64::consts::PI).ln();
    (root - (count.max(2.0).ln().ln() + fourth) / (2.0 * root)).max(0.0)
}

/// Offset at the nodes under a specified duty, rad.
pub fn duty_curve(law: &Law, tendon: &Tendon, pretension_n: f64, duty: &Duty) -> Option<Vec<f64>> {
    let read = RopeLoad::at_reference(pretension_n);
    let mut out = vec![0.0; node_times_s().len()];
    for portion in strand(tendon) {
        let law = law.passed_by(portion.guides as f64);
        let mut history = History::new(&law, duty, State::default());
        let per_percent = 0.01 * portion.length_m / tendon.joint_pulley_radius_m;
        for (value, t) in out.iter_mut().zip(node_times_s()) {
            let state = history.at(t).ok()?;
            *value += per_percent * law.strain(&state, read).ok()?.total_percent();
        }
    }
    since_first(out)
}

/// Sums the sections of a strand, advanced from node to node by `step`.
fn through(
    law: &Law,
    tendon: &Tendon,
    pretension_n: f64,
    step: impl Fn(&Law, &mut State, f64, f64) -> Option<()>,
) -> Option<Vec<f64>> {
    let read = RopeLoad::at_reference(pretension_n);
    let times = node_times_s();
    let mut out = vec![0.0; times.len()];
    for portion in strand(tendon) {
        let law = law.passed_by(portion.guides as f64);
        let per_percent = 0.01 * portion.length_m / tendon.joint_pulley_radius_m;
        let (mut state, mut from_s) = (State::default(), 0.0);
        for (value, &t) in out.iter_mut().zip(&times) {
            step(&law, &mut state, from_s, t)?;
            *value += per_percent * law.strain(&state, read).ok()?.total_percent();
            from_s = t;
        }
    }
    since_first(out)
}

/// Values relative to the first node; `None` if a value is not finite.
fn since_first(mut values: Vec<f64>) -> Option<Vec<f64>> {
    let first = *values.first()?;
    values.iter_mut().for_each(|v| *v -= first);
    values.iter().all(|v| v.is_finite()).then_some(values)
}

/// Curves of a rope: the draws of a prediction with their model error outside the tested range, under the duty or,
/// without one, under loads drawn from typical robot use; a fifth of the probability for [`generic_curves`].
///
/// # Errors
/// Returns [`CatalogueError::NoLaw`] if the rope has no complete law.
pub fn rope_curves(
    rope: &CatalogueRope,
    tendon: &Tendon,
    pretension_n: f64,
    duty: Option<&Duty>,
    temperature_c: f64,
    seed: u64,
) -> Result<Vec<Curve>, CatalogueError> {
    let load = (duty, temperature_c);
    rope_curves_with_progress(rope, tendon, pretension_n, load, seed, &|_| ())
}

/// Computes [`rope_curves`] with the duty and the temperature in one argument.
///
/// * `done`: called with the share of the draws that are complete.
fn rope_curves_with_progress(
    rope: &CatalogueRope,
    tendon: &Tendon,
    pretension_n: f64,
    (duty, temperature_c): (Option<&Duty>, f64),
    seed: u64,
    done: &dyn Fn(f64),
) -> Result<Vec<Curve>, CatalogueError> {
    let draws = Draws::new(rope, CURVES, seed)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut curves = Vec::with_capacity(CURVES + 22);
    for i in 0..CURVES {
        let work = Work::unknown(temperature_c, &mut rng);
        curves.extend(drawn(&draws, i, tendon, pretension_n, duty, &work));
        done((i + 1) as f64 / CURVES as f64);
    }
    Ok(with_generic(curves, Some(tendon)))
}

/// Prior of a tendon whose rope may be any of `ropes` under an unspecified pretension, and the
/// number of ropes with a law.
///
/// The laws are drawn from their uncertainties, each under 1 to 8 % of its breaking load and under
/// loads drawn from typical robot use; a fifth of the probability for [`generic_curves`]. Without a
/// rope the share of its breaking load is unknown too, so that no pretension is required.
///
/// * `tendon`: `None` for 10 to 60 times the radius of its pulley.
pub fn any_rope(
    ropes: &[CatalogueRope],
    tendon: Option<&Tendon>,
    temperature_c: f64,
    seed: u64,
) -> (Prior, usize) {
    let has_law = |rope: &&CatalogueRope| Draws::new(rope, 0, seed).is_ok();
    let each = CURVES.div_ceil(ropes.iter().filter(has_law).count().max(1));
    let draws: Vec<Draws> = (ropes.iter())
        .filter_map(|rope| Draws::new(rope, each, seed).ok())
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // One draw of every rope, then a second of every rope, and so on.
    let in_turn = (0..each).flat_map(|i| draws.iter().map(move |of_rope| (i, of_rope)));
    let curves = in_turn.take(CURVES).filter_map(|(i, of_rope)| {
        let mut between = |[low, high]: [f64; 2]| low * (high / low).powf(rng.random::<f64>());
        let share = between(PRETENSION_SHARE);
        let undescribed = undescribed(between(LENGTH_OVER_RADIUS));
        let work = Work::unknown(temperature_c, &mut rng);
        let pretension_n = share * of_rope.laws.get(i)?.parameters().breaking_load_n;
        let tendon = tendon.unwrap_or(&undescribed);
        drawn(of_rope, i, tendon, pretension_n, None, &work)
    });
    let mut prior = Prior::new(with_generic(curves.collect(), tendon));
    if draws.len() > 1 {
        prior.step_rad = UNKNOWN_STEP_RAD;
    }
    (prior, draws.len())
}

/// Tendon with this `L/r` and no other property.
fn undescribed(length_over_radius: f64) -> Tendon {
    Tendon {
        rope: None,
        length_m: length_over_radius,
        joint_pulley_radius_m: 1.0,
        pretension_n: None,
        antagonistic: false,
        guides: Vec::new(),
        retension_at_m: None,
        replace_at_strain: None,
        frame_expansion_per_k: None,
    }
}

/// Curve of draw `i` under the duty or, without one, under loads of typical robot use.
fn drawn(
    draws: &Draws,
    i: usize,
    tendon: &Tendon,
    pretension_n: f64,
    duty: Option<&Duty>,
    work: &Work,
) -> Option<Curve> {
    let (tension_n, temperature_c) = match duty.map(Duty::summary) {
        Some(duty) => (
            [duty.tension_mean_n, duty.tension_max_n],
            [duty.temperature_min_c, duty.temperature_max_c],
        ),
        None => (
            [work.mean_factor, work.peak_factor].map(|f| f * pretension_n),
            [work.temperature_c; 2],
        ),
    };
    let draw = draws.draw(i, draws.extrapolation(tension_n, temperature_c))?;
    let mut values = match duty {
        Some(duty) => duty_curve(draw.law, tendon, pretension_n, duty),
        None => work_curve(draw.law, tendon, pretension_n, work),
    }?;
    let work = match duty.map(Duty::summary) {
        Some(duty) => &Work {
            mean_factor: duty.tension_mean_n / pretension_n,
            peak_factor: duty.tension_max_n / pretension_n,
            temperature_c: duty.temperature_mean_c,
            ..*work
        },
        None => work,
    };
    let mut retensioned = retensioned_curve(draw.law, tendon, pretension_n, work)?;
    for values in [&mut values, &mut retensioned] {
        let mut added = AddedStrain::default();
        for (value, time_s) in values.iter_mut().zip(node_times_s()) {
            added = draw.error.next(added, time_s, *value);
            *value = added.widened;
        }
    }
    let curve = Curve {
        values,
        retensioned: Some(retensioned),
        amplitude: 1.0,
        amplitude_std: AMPLITUDE_DEVIATION,
        log_weight: ((1.0 - GENERIC_SHARE) / CURVES as f64).ln(),
    };
    Some(curve).filter(Curve::is_possible)
}

/// Appends generic curves with their share of the probability.
fn with_generic(mut curves: Vec<Curve>, tendon: Option<&Tendon>) -> Vec<Curve> {
    let generic = generic(tendon);
    let share = if curves.is_empty() {
        1.0
    } else {
        GENERIC_SHARE
    };
    let log_weight = (share / generic.len() as f64).ln();
    curves.extend(generic.into_iter().map(|c| Curve { log_weight, ..c }));
    curves
}

/// Generic curves without a rope law.
pub fn generic(tendon: Option<&Tendon>) -> Vec<Curve> {
    let [low, high] = LENGTH_OVER_RADIUS;
    let usual = (low * high).sqrt();
    generic_curves(GENERIC_STRAIN * tendon.map_or(usual, |t| t.length_m / t.joint_pulley_radius_m))
}

/// Prior of a tendon and its basis.
#[derive(Debug, Clone, PartialEq)]
pub struct RopePrior {
    /// Prior of the trend.
    pub prior: Prior,
    /// Basis of the prior: rope, or reason for a generic prior.
    pub basis: PriorBasis,
}

/// Prior of a tendon: of its rope if the robot description names one, otherwise of any rope of the
/// catalogue.
///
/// # Errors
/// Returns a [`CatalogueError`] if the named rope is not found or has no complete law.
pub fn rope_prior(
    tendon: Option<&Tendon>,
    catalogue: &Catalogue,
    duty: Option<&Duty>,
    temperature_c: f64,
    seed: u64,
) -> Result<RopePrior, CatalogueError> {
    rope_prior_with_progress(tendon, catalogue, (duty, temperature_c), seed, &|_| ())
}

/// Computes [`rope_prior`] with the duty and the temperature in one argument.
///
/// * `done`: called with the share of the draws that are complete.
pub(super) fn rope_prior_with_progress(
    tendon: Option<&Tendon>,
    catalogue: &Catalogue,
    (duty, temperature_c): (Option<&Duty>, f64),
    seed: u64,
    done: &dyn Fn(f64),
) -> Result<RopePrior, CatalogueError> {
    let any_of = |ropes, missing| {
        let (prior, ropes) = any_rope(ropes, tendon, temperature_c, seed);
        RopePrior {
            prior,
            basis: PriorBasis::Unknown { missing, ropes },
        }
    };
    let Some(tendon) = tendon else {
        return Ok(any_of(catalogue.ropes(), MissingFromRobot::Tendon));
    };
    let Some(name) = &tendon.rope else {
        return Ok(any_of(catalogue.ropes(), MissingFromRobot::Rope));
    };
    let rope = catalogue.find(name)?;
    let Some(pretension_n) = tendon.pretension_n else {
        Draws::new(rope, 0, seed)?;
        let own = std::slice::from_ref(rope);
        return Ok(any_of(own, MissingFromRobot::Pretension));
    };
    let load = (duty, temperature_c);
    let curves = rope_curves_with_progress(rope, tendon, pretension_n, load, seed, done)?;
    Ok(RopePrior {
        prior: Prior::new(curves),
        basis: PriorBasis::Rope {
            rope: name.clone(),
            parameters: rope.entry.law.len(),
            assumed: rope.entry.assumed(),
            draws: CURVES,
            duty: duty.map(|d| d.about.clone()),
        },
    })
}

/// Converts days to seconds.
pub fn days(d: f64) -> f64 {
    d * DAY_S
}
