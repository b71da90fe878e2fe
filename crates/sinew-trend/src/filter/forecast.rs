//! Paths drawn from the posterior, and their first passage of a limit.

use super::bank::{added, added_folds, creep, folds};
use super::component::{AMPLITUDE, Component, DRIFT, LEVEL, RETENSIONED, SLOW, TAKEN_OUT, entry};
use super::gauss::LogSum;
use super::prior::Prior;
use super::tracker::Trend;
use sinew_model::cholesky;

/// Forecast paths of a tendon, all of equal probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Paths {
    /// Times of the paths, s since tensioning, rising.
    pub times_s: Vec<f64>,
    /// True offset at the reference temperature since the last tensioning, rad: one row per path,
    /// one column per time.
    pub offset_rad: Vec<Vec<f64>>,
    /// True offset including the amount removed by re-tensioning, since the first tensioning, rad;
    /// same shape.
    pub whole_rad: Vec<Vec<f64>>,
}

impl Paths {
    /// Draws `count` paths of a trend over `times_s`, which rise from the time of the last entry
    /// on.
    ///
    /// Filters are drawn systematically by probability; within each, the state is drawn from its
    /// normal distribution with `a > 0`. The amplitude walks by factors, so that it stays above 0.
    ///
    /// * `normal`: generator of standard normal numbers.
    #[must_use]
    pub fn draw(
        trend: &Trend,
        times_s: &[f64],
        count: usize,
        normal: &mut dyn FnMut() -> f64,
    ) -> Self {
        let prior = trend.prior();
        let components = trend.components();
        let weights: Vec<f64> = components
            .iter()
            .map(Component::weight_above_zero)
            .collect();
        let mut all = LogSum::new();
        weights.iter().for_each(|w| all.add(*w));
        let total = all.value();
        let mut times = Vec::with_capacity(times_s.len());
        for &t in times_s {
            let last = times.last().copied().unwrap_or(trend.time_s());
            times.push(if t > last { t } else { last });
        }
        let mut steps: Vec<Step> = Vec::with_capacity(times.len());
        let mut from = trend.time_s();
        let retensioned_s = trend.retensioned_s();
        for &t in &times {
            steps.push(Step {
                folds: folds(prior, from, t),
                creep: creep(prior, from, t),
                added_folds: added_folds(retensioned_s, from, t),
                added: added(prior, retensioned_s, from, t),
            });
            from = t;
        }
        let mut out = Self {
            times_s: times,
            offset_rad: Vec::with_capacity(count),
            whole_rad: Vec::with_capacity(count),
        };
        let mut reached = 0.0;
        for (component, weight) in components.iter().zip(&weights) {
            reached += libm::exp(weight - total);
            while out.offset_rad.len() < count
                && (out.offset_rad.len() as f64 + 0.5) / (count as f64) < reached
            {
                let (offset, whole) = path(prior, component, &steps, normal);
                out.offset_rad.push(offset);
                out.whole_rad.push(whole);
            }
        }
        out
    }
}

/// Creep between two successive times.
struct Step {
    /// E-folds of the time since tensioning.
    folds: f64,
    /// Creep of every curve for an amplitude of 1, rad.
    creep: Vec<f64>,
    /// E-folds of the time since the last re-tensioning.
    added_folds: f64,
    /// Additional creep since the last re-tensioning, per curve for an amplitude of 1, rad; empty
    /// without one.
    added: Vec<f64>,
}

/// Draws one path of one filter.
fn path(
    prior: &Prior,
    component: &Component,
    steps: &[Step],
    normal: &mut dyn FnMut() -> f64,
) -> (Vec<f64>, Vec<f64>) {
    let is_retensioned = steps.iter().any(|step| !step.added.is_empty());
    let state = draw(component, is_retensioned, normal);
    let mut offset = vec![0.0; steps.len()];
    let mut whole = vec![0.0; steps.len()];
    let creep_rate_rel_error = prior
        .noises
        .get(component.noise as usize)
        .map_or(0.0, |n| n.creep_rate_rel_error);
    let (mut level, mut amplitude) = (state[LEVEL_DRAWN], state[AMPLITUDE_DRAWN]);
    let mut retensioned = state[RETENSIONED_DRAWN];
    let curve = component.curve as usize;
    for (i, step) in steps.iter().enumerate() {
        // Factor of mean 1; the level uses the mean of both ends.
        let mut walk = |folds: f64| {
            let variance = creep_rate_rel_error * creep_rate_rel_error * folds;
            libm::exp(libm::sqrt(variance) * normal() - 0.5 * variance)
        };
        let factor = walk(step.folds);
        let creep = step.creep.get(curve).copied().unwrap_or(0.0);
        let mut crept = 0.5 * (1.0 + factor) * amplitude * creep;
        if let Some(added) = step.added.get(curve) {
            let factor = walk(step.added_folds);
            crept += 0.5 * (1.0 + factor) * retensioned * added;
            retensioned *= factor;
        }
        let jerk = libm::sqrt(prior.step_rad * crept.max(0.0));
        level += crept + if jerk > 0.0 { jerk * normal() } else { 0.0 };
        amplitude *= factor;
        whole[i] = level;
        offset[i] = level + state[TAKEN_OUT_DRAWN];
    }
    (offset, whole)
}

/// States that are drawn; the last one only after a re-tensioning.
const DRAWN_STATES: [usize; DRAWN] = [LEVEL, TAKEN_OUT, AMPLITUDE, DRIFT, SLOW, RETENSIONED];
/// Number of states that are drawn.
const DRAWN: usize = 6;
/// Places among the states that are drawn.
const LEVEL_DRAWN: usize = 0;
const TAKEN_OUT_DRAWN: usize = 1;
const AMPLITUDE_DRAWN: usize = 2;
const RETENSIONED_DRAWN: usize = DRAWN - 1;

/// Draws a state of a filter with an amplitude above 0.
fn draw(
    component: &Component,
    is_retensioned: bool,
    normal: &mut dyn FnMut() -> f64,
) -> [f64; DRAWN] {
    let of = |i: usize, k: usize| component.covariance[entry(DRAWN_STATES[i], DRAWN_STATES[k])];
    let covariance: [f64; DRAWN * DRAWN] = core::array::from_fn(|at| of(at / DRAWN, at % DRAWN));
    let mut l = [0.0; DRAWN * DRAWN];
    // A state that is exactly determined has a column of zeros: the factorisation accepts it.
    let pivot = |left: f64| Some(libm::sqrt(left.max(0.0)));
    let _ = cholesky::factorise_singular(&covariance, &mut l, DRAWN, pivot);
    // Maximum number of attempts: filters with an amplitude rarely above 0 contribute few paths.
    const MAX_ATTEMPTS: usize = 64;
    let mean = DRAWN_STATES.map(|state| component.mean[state]);
    let drawn = if is_retensioned {
        DRAWN
    } else {
        RETENSIONED_DRAWN
    };
    let mut x = mean;
    for _ in 0..MAX_ATTEMPTS {
        let z: [f64; DRAWN] = core::array::from_fn(|i| if i < drawn { normal() } else { 0.0 });
        x = mean;
        for i in 0..DRAWN {
            x[i] += (0..=i).map(|k| l[i * DRAWN + k] * z[k]).sum::<f64>();
        }
        if x[AMPLITUDE_DRAWN] > 0.0 {
            return x;
        }
    }
    x[AMPLITUDE_DRAWN] = 0.0;
    x
}

/// Times at which paths first reach `limit_rad`, s, one per path; infinite if not reached, the
/// first time if exceeded from the start. Linear interpolation between times.
#[must_use]
pub fn first_passage(times_s: &[f64], paths_rad: &[Vec<f64>], limit_rad: f64) -> Vec<f64> {
    paths_rad
        .iter()
        .map(|path| {
            let Some(i) = path.iter().position(|v| *v >= limit_rad) else {
                return f64::INFINITY;
            };
            let Some(&t) = times_s.get(i) else {
                return f64::INFINITY;
            };
            if i == 0 {
                return t;
            }
            let (t0, y0, y1) = (times_s[i - 1], path[i - 1], path[i]);
            t0 + (t - t0) * (limit_rad - y0) / (y1 - y0)
        })
        .collect()
}
