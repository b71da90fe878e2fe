//! Stiffness that was lost between two recordings.
//!
//! Every stiffness drifts by some percent without a loss: by temperature, humidity and settling of a braid. The posterior
//! probability is therefore that of a change by more than [`MIN_CHANGE`], with the evidence of [`super::model_error`].

use super::cost::cost_at;
use super::gauss_newton::{completed, solve, solve_from};
use super::model_error::{self, ModelError, Posterior};
use super::problem::Problem;
use super::schedule::ROUGH_START;
use super::solution::Solution;
use crate::Gaussian;
use crate::cholesky::{self, Factor, dot};
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::effects::JointParameter;
use crate::offset::error::MapError;
use crate::offset::estimate::{MapEstimate, StiffnessChange};
use crate::offset::mixture::{self, LOST_STIFFNESS, happened, sets};
use alloc::vec::Vec;

/// Maximum relative stiffness change that is interpreted as a strand failure. A larger one is an
/// unmodelled effect, such as an unspecified load, and remains unexplained.
pub(super) const MAX_STIFFNESS_LOSS: f64 = 0.25;
/// Minimum decrease of the cost by free stiffness for the search to start from it. Without a
/// stiffness change it is below 3 in one minute of many poses, and up to 6 in 15 s of six poses;
/// with 8 % less stiffness at two joints it is above 12.
const MIN_GAIN: f64 = 8.0;

/// Relative change of a stiffness above which it counts as changed: half of a tenth, the share of one strand in ten.
const MIN_CHANGE: f64 = 0.05;
/// Standard deviation of the relative stiffness between two recordings without a loss; an assumed value.
const DRIFT: f64 = 0.02;

/// Returns the estimate with every stiffness free since the start of the recording: between two
/// recordings strands may have failed at several joints, and freeing one stiffness at a time makes
/// the others appear as slips and loads. `None` if no stiffness has an informative prior, or if the
/// estimated change is impossible for a strand failure.
pub(super) fn with_free_stiffness(problem: &Problem<'_>) -> Result<Option<Solution>, MapError> {
    if problem.blocks.is_empty() {
        return Ok(None);
    }
    let reduced = &problem.model.reduced;
    let stiffnesses = reduced.stiffness_with_prior(&problem.start, LOST_STIFFNESS.std);
    let changes: Vec<ChangePoint> = (stiffnesses.into_iter())
        .map(|i| ChangePoint {
            kind: ChangeKind::Compliance(i),
            at_s: problem.start_of(0),
        })
        .collect();
    if changes.is_empty() {
        return Ok(None);
    }
    let trial = solve(problem, &changes)?;
    let mut sizes = trial.estimate.state.iter().skip(reduced.layout.dimension());
    let possible = sizes.all(|size| size.abs() < MAX_STIFFNESS_LOSS);
    Ok(possible.then_some(trial))
}

/// Whether the evidence for a stiffness loss is high enough for the search to start from it.
pub(super) fn is_significant(problem: &Problem<'_>, best: &Solution, with_loss: &Solution) -> bool {
    let before = cost_at(problem, &best.estimate, &with_loss.estimate);
    before - with_loss.cost() > MIN_GAIN
}

/// The estimate averaged over the joints whose stiffness has changed since the recording before, and its posteriors under
/// the model error. `stored`: that of the baseline; `last`: problem of the estimate, after that of the search.
pub(super) fn averaged(
    (problem, last): (&Problem<'_>, &Problem<'_>),
    best: Solution,
    with_loss: Solution,
    stored: Option<&ModelError>,
) -> Result<(MapEstimate, Vec<Posterior>), MapError> {
    let found = best.estimate.changes.clone();
    let is_stiffness_loss = |c: &ChangePoint| {
        matches!(c.kind, ChangeKind::Compliance(_)) && problem.is_before_recording(c)
    };
    let is_free = found.iter().any(is_stiffness_loss);
    let with_free_stiffness = if is_free {
        best
    } else if found.is_empty() {
        with_loss
    } else {
        let estimate = &best.estimate;
        let changes = [&found[..], &with_loss.estimate.changes].concat();
        let mut state = estimate.state.clone();
        state.resize(problem.total(&changes), 0.0);
        solve_from(problem, &changes, &state, estimate, ROUGH_START)?
    };
    let at = &with_free_stiffness.estimate;
    let posteriors = model_error::posteriors(problem, at, stored)?;
    let free = model_error::columns(problem.layout(), &at.changes, is_stiffness_loss);
    let found = stiffness_changes(problem, &posteriors, &free)?;
    let mut out = completed(problem, last, with_free_stiffness)?;
    let prior = &problem.model.prior;
    let columns: Vec<usize> = model_error::columns(prior.layout(), &out.changes, is_stiffness_loss)
        .into_iter()
        .map(|(column, _)| column)
        .collect();
    mixture::average(
        &columns,
        LOST_STIFFNESS,
        &mut out.state,
        &mut out.covariance,
    )?;
    for (joint, change) in found {
        out.stiffness_changes[joint] = Some(change);
    }
    if !is_free {
        out.fold(prior, is_stiffness_loss);
    }
    Ok((out, posteriors))
}

/// Posterior of all changes of the stiffness for one set of joints with a loss and one correlation of the model error.
struct Component {
    set: u128,
    ln_evidence: f64,
    /// Compliance increase of every joint, relative to the nominal value.
    increases: Vec<Gaussian>,
}

/// Probability and size of a change of each joint's stiffness by more than [`MIN_CHANGE`], averaged over the sets of
/// joints that may have lost stiffness, and over the correlations of the model error.
///
/// # Errors
/// Returns [`MapError::Prior`] if a covariance is not positive definite.
fn stiffness_changes(
    problem: &Problem<'_>,
    posteriors: &[Posterior],
    free: &[(usize, ChangeKind)],
) -> Result<Vec<(usize, StiffnessChange)>, MapError> {
    let columns: Vec<usize> = free.iter().map(|(column, _)| *column).collect();
    let mut components = Vec::new();
    for posterior in posteriors {
        components.extend(of_all_sets(posterior, &columns)?);
    }
    let joints = free.iter().filter_map(|(_, kind)| match kind {
        ChangeKind::Compliance(joint) => Some(*joint),
        _ => None,
    });
    let weights = model_error::weights(posteriors);
    let compliance = |joint: usize| {
        let k = problem.layout().place(joint, JointParameter::Compliance);
        let means = posteriors.iter().zip(&weights).map(|(p, w)| w * p.state[k]);
        1.0 + means.sum::<f64>()
    };
    let change =
        |(i, joint): (usize, usize)| (joint, averaged_change(&components, i, compliance(joint)));
    Ok(joints.enumerate().map(change).collect())
}

/// Components of a posterior for all sets of joints that may have lost stiffness.
///
/// With all changes `c ~ N(0, s²)` free, their posterior is `N(ĉ, C)` with the evidence `Z`. For a set `S` of joints with
/// a loss, and a drift of every joint, the prior is `N(0, Λ)`, so that
///
/// ```text
/// Σ = (C⁻¹ − I/s² + Λ⁻¹)⁻¹,   m = Σ C⁻¹ ĉ
/// ln evidence = ln Z + ½ ĉᵀ C⁻¹ (m − ĉ) + ½ ln |Σ| − ½ ln |C| − ½ ln |Λ| + |S| ln odds
/// ```
///
/// up to a constant.
fn of_all_sets(posterior: &Posterior, columns: &[usize]) -> Result<Vec<Component>, MapError> {
    let n = columns.len();
    let ln_determinant = |a: &[f64]| -> Result<f64, MapError> {
        Ok(Factor::of(a, n).map_err(MapError::Prior)?.ln_determinant())
    };
    let times = |a: &[f64], x: &[f64]| -> Vec<f64> {
        a.chunks_exact(n.max(1)).map(|row| dot(row, x)).collect()
    };
    let covariance = posterior.covariance(columns);
    let own = cholesky::inverse(&covariance, n).map_err(MapError::Prior)?;
    let found: Vec<f64> = columns.iter().map(|&k| posterior.state[k]).collect();
    let pull = times(&own, &found);
    let whole = posterior.ln_evidence - 0.5 * (dot(&pull, &found) + ln_determinant(&covariance)?);
    let free = LOST_STIFFNESS.std * LOST_STIFFNESS.std;
    let of = |set: u128| {
        let variances = (0..n).map(|i| match happened(set, i) {
            true => DRIFT * DRIFT + free,
            false => DRIFT * DRIFT,
        });
        let mut information = own.clone();
        let mut ln_evidence = whole + LOST_STIFFNESS.ln_prior(set.count_ones() as usize, n);
        for (i, variance) in variances.enumerate() {
            information[i * (n + 1)] += 1.0 / variance - 1.0 / free;
            ln_evidence -= 0.5 * libm::log(variance);
        }
        let covariance = cholesky::inverse(&information, n).map_err(MapError::Prior)?;
        let mean = times(&covariance, &pull);
        let increases = mean.iter().enumerate().map(|(i, mean)| {
            let std = libm::sqrt(covariance[i * (n + 1)]);
            Gaussian::new(*mean, std)
        });
        Ok(Component {
            set,
            ln_evidence: ln_evidence + 0.5 * (dot(&pull, &mean) + ln_determinant(&covariance)?),
            increases: increases.collect(),
        })
    };
    sets(n).map(of).collect()
}

/// Change of stiffness `i` over all components; `before`: its relative compliance before.
fn averaged_change(components: &[Component], i: usize, before: f64) -> StiffnessChange {
    // Compliance increases at which the stiffness is 5 % less and 5 % more than before.
    let [softer, stiffer] =
        [1.0 - MIN_CHANGE, 1.0 + MIN_CHANGE].map(|ratio| before * (1.0 / ratio - 1.0));
    let ln = components.iter().map(|c| c.ln_evidence);
    let most = ln.fold(f64::NEG_INFINITY, f64::max);
    let (mut all, mut beyond, mut lost) = (0.0, 0.0, 0.0);
    let (mut sum, mut square) = (0.0, 0.0);
    for component in components {
        let weight = libm::exp(component.ln_evidence - most);
        let value = component.increases[i];
        all += weight;
        beyond +=
            weight * (value.probability_above(softer) + 1.0 - value.probability_above(stiffer));
        if happened(component.set, i) {
            lost += weight;
            sum += weight * value.mean;
            square += weight * (value.mean * value.mean + value.std * value.std);
        }
    }
    let size = sum / lost;
    let std = libm::sqrt((square / lost - size * size).max(0.0));
    StiffnessChange {
        probability: beyond / all,
        compliance_increase: Gaussian::new(size, std),
        // K/K_before − 1 = −c/(1 + κ + c) and its derivative.
        change_ratio: Gaussian::new(
            -size / (before + size),
            std * before / ((before + size) * (before + size)),
        ),
    }
}
