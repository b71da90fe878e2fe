//! What the rope's law says on a tendon before its first record.

use super::clock::BASELINE_AFTER_S;
use super::result::{MissingFromRobot, PriorBasis};
use crate::filter::{Curve, Prior, generic_curves, node_times_s};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use sinew_files::date::DAY_S;
use sinew_model::transmission::Tendon;
use sinew_rope::history::History;
use sinew_rope::law::{Law, RopeLoad, State};
use sinew_rope::work::{Work, strand};
use sinew_rope::{Catalogue, CatalogueError, CatalogueRope, Draws, Duty};

/// Draws of the law that stand for the rope.
pub const CURVES: usize = 200;
/// Share of the prior that trusts no rope law: the law may be wrong, and its last delay is a day.
const GENERIC_SHARE: f64 = 0.2;
/// Deviation of a drawn curve's amplitude: strands, pretension and pulleys aren't as stated.
const AMPLITUDE_DEVIATION: f64 = 0.4;
/// Creep of a first year that surprises nobody, whatever the rope: strain as a fraction. Laws of the catalogue at 1 to 8 % of
/// the breaking load: 0.05 to 0.4 %.
const GENERIC_STRAIN: f64 = 3e-3;
/// `L/r` that a tendon has nobody described.
const LENGTH_OVER_RADIUS: [f64; 2] = [10.0, 60.0];
/// Pretension over breaking load of a rope nobody knows.
const PRETENSION_SHARE: [f64; 2] = [0.01, 0.08];
/// Highest tensions of days differ by so much, as a share of themselves.
const PEAK_SPREAD: f64 = 0.05;
/// Steps that the creep of a rope nobody knows comes in, rad: metal ropes bed in on single days.
const UNKNOWN_STEP_RAD: f64 = 0.3e-3;

/// Offset at the nodes of [`node_times_s`] under some work, rad, at pretension and the law's reference
/// temperature; `None` where the tension breaks the rope.
///
/// For an hour after tensioning it rests, until its baseline. Then, between nodes, delayed elasticity, flow and retraction see
/// the mean tension, bedding-in and flow the peaks for their share of the time. Days' peaks differ. So the highest of all days
/// until then is above the usual one, and a rope beds in further on that day.
pub fn work_curve(law: &Law, tendon: &Tendon, pretension_n: f64, work: &Work) -> Option<Vec<f64>> {
    let mean = RopeLoad::celsius(pretension_n * work.mean_factor, work.temperature_c);
    let peak = RopeLoad::celsius(pretension_n * work.peak_factor, work.temperature_c);
    let quiet = RopeLoad::celsius(pretension_n, work.temperature_c);
    through(law, tendon, pretension_n, |law, state, from_s, to_s| {
        let quiet_s = (BASELINE_AFTER_S - from_s).clamp(0.0, to_s - from_s);
        law.hold(state, quiet, quiet_s).ok()?;
        let dt = to_s - from_s - quiet_s;
        let mut pulled = *state;
        law.hold(state, mean, dt).ok()?;
        let flow = state.flow_percent;
        law.hold(&mut pulled, peak, dt * work.peak_share).ok()?;
        let height = 1.0 + PEAK_SPREAD * highest_of(to_s / DAY_S);
        if height > 1.0 {
            let tension_n = pretension_n * work.peak_factor * height;
            let highest = RopeLoad::celsius(tension_n, work.temperature_c);
            let day_s = dt.min(DAY_S);
            law.hold(&mut pulled, highest, day_s * work.peak_share)
                .ok()?;
        }
        state.bedding_percent = state.bedding_percent.max(pulled.bedding_percent);
        state.flow_percent = flow.max(pulled.flow_percent);
        Some(())
    })
}

/// Largest of so many standard normal numbers, as a rule: `√(2 ln n) − (ln ln n + ln 4π)/(2 √(2 ln n))`.
fn highest_of(count: f64) -> f64 {
    let root = (2.0 * count.max(2.0).ln()).sqrt();
    let fourth = (4.0 * std::f64::consts::PI).ln();
    (root - (count.max(2.0).ln().ln() + fourth) / (2.0 * root)).max(0.0)
}

/// The same under a duty that is known.
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

/// Sums the portions of a strand that go from node to node by `step`.
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

/// From the first node on; a curve that isn't finite is none.
fn since_first(mut values: Vec<f64>) -> Option<Vec<f64>> {
    let first = *values.first()?;
    values.iter_mut().for_each(|v| *v -= first);
    values.iter().all(|v| v.is_finite()).then_some(values)
}

/// Curves of a rope: its law drawn from its stated uncertainty, under the duty or, without one, under
/// work drawn from what robots do; a fifth of the probability for
/// [`generic_curves`].
///
/// # Errors
/// [`CatalogueError::NoLaw`].
pub fn rope_curves(
    rope: &CatalogueRope,
    tendon: &Tendon,
    pretension_n: f64,
    duty: Option<&Duty>,
    temperature_c: f64,
    seed: u64,
) -> Result<Vec<Curve>, CatalogueError> {
    let draws = Draws::new(rope, CURVES, seed)?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut curves = Vec::with_capacity(CURVES + 22);
    for law in &draws.laws {
        let work = Work::unknown(temperature_c, &mut rng);
        let values = match duty {
            Some(duty) => duty_curve(law, tendon, pretension_n, duty),
            None => work_curve(law, tendon, pretension_n, &work),
        };
        curves.extend(values.map(drawn).filter(Curve::is_possible));
    }
    Ok(with_generic(curves, Some(tendon)))
}

/// The prior of a tendon whose rope may be any of these under a pretension nobody knows, and how many of them have a law: their laws
/// drawn from their uncertainties, each under 1 to 8 % of its breaking load and under work drawn from what robots do; a fifth
/// of the probability for [`generic_curves`].
///
/// Whoever doesn't know the rope doesn't know the share of its breaking load either, so the pretension isn't asked for.
///
/// * `tendon`: `None`: 10 to 60 times as long as its pulley's radius.
pub fn any_rope(
    ropes: &[CatalogueRope],
    tendon: Option<&Tendon>,
    temperature_c: f64,
    seed: u64,
) -> (Prior, usize) {
    let has_law = |rope: &&CatalogueRope| Draws::new(rope, 0, seed).is_ok();
    let each = CURVES.div_ceil(ropes.iter().filter(has_law).count().max(1));
    let laws: Vec<Vec<Law>> = (ropes.iter())
        .filter_map(|rope| Some(Draws::new(rope, each, seed).ok()?.laws))
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    // One of every rope, another of every rope, and so on.
    let in_turn = (0..each).flat_map(|i| laws.iter().filter_map(move |of_rope| of_rope.get(i)));
    let curves = in_turn.take(CURVES).filter_map(|law| {
        let mut between = |[low, high]: [f64; 2]| low * (high / low).powf(rng.random::<f64>());
        let share = between(PRETENSION_SHARE);
        let undescribed = undescribed(between(LENGTH_OVER_RADIUS));
        let work = Work::unknown(temperature_c, &mut rng);
        let pretension_n = share * law.parameters().breaking_load_n;
        let values = work_curve(law, tendon.unwrap_or(&undescribed), pretension_n, &work);
        values.map(drawn).filter(Curve::is_possible)
    });
    let mut prior = Prior::new(with_generic(curves.collect(), tendon));
    if laws.len() > 1 {
        prior.step_rad = UNKNOWN_STEP_RAD;
    }
    (prior, laws.len())
}

/// A tendon of this `L/r`, of which nothing else is known.
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

/// A drawn curve of a law.
fn drawn(values: Vec<f64>) -> Curve {
    Curve {
        values,
        amplitude: 1.0,
        amplitude_deviation: AMPLITUDE_DEVIATION,
        log_weight: ((1.0 - GENERIC_SHARE) / CURVES as f64).ln(),
    }
}

/// Curves of laws, and generic ones with their share of the probability.
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

/// Curves without a rope law.
pub fn generic(tendon: Option<&Tendon>) -> Vec<Curve> {
    let [low, high] = LENGTH_OVER_RADIUS;
    let usual = (low * high).sqrt();
    generic_curves(GENERIC_STRAIN * tendon.map_or(usual, |t| t.length_m / t.joint_pulley_radius_m))
}

/// A prior and what it rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct RopePrior {
    /// The prior.
    pub prior: Prior,
    /// What it rests on.
    pub basis: PriorBasis,
}

/// The prior of a tendon: of its rope where the robot names one, else of any rope of the catalogue.
///
/// # Errors
/// [`CatalogueError`] for a rope that is named and not there, or has no complete law.
pub fn rope_prior(
    tendon: Option<&Tendon>,
    catalogue: &Catalogue,
    duty: Option<&Duty>,
    temperature_c: f64,
    seed: u64,
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
    let curves = rope_curves(rope, tendon, pretension_n, duty, temperature_c, seed)?;
    Ok(RopePrior {
        prior: Prior::new(curves),
        basis: PriorBasis::Rope {
            rope: name.clone(),
            parameters: rope.entry.law.len(),
            guesses: rope.entry.guesses(),
            draws: CURVES,
            duty: duty.map(|d| d.about.clone()),
        },
    })
}

/// Days to seconds.
pub fn days(d: f64) -> f64 {
    d * DAY_S
}
