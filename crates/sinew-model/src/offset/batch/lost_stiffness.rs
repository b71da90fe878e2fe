//! Stiffness that was lost between two recordings.

use super::cost::cost_at;
use super::gauss_newton::{solve, solve_from};
use super::problem::Problem;
use super::schedule::ROUGH_START;
use super::solution::Solution;
use crate::Gaussian;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::error::MapError;
use crate::offset::estimate::{MapEstimate, StiffnessChange};
use crate::offset::mixture::{self, LOST_STIFFNESS};
use alloc::vec::Vec;

/// Maximum relative stiffness change that is interpreted as a strand failure. A larger one is an
/// unmodelled effect, such as an unspecified load, and remains unexplained.
pub(super) const MAX_STIFFNESS_LOSS: f64 = 0.25;
/// Minimum decrease of the cost by free stiffness for the search to start from it. Without a
/// stiffness change it is below 3 in one minute of many poses, and up to 6 in 15 s of six poses;
/// with 8 % less stiffness at two joints it is above 12.
const MIN_GAIN: f64 = 8.0;

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

/// The estimate averaged over the joints whose stiffness has changed since the recording before.
pub(super) fn averaged(
    problem: &Problem<'_>,
    best: Solution,
    with_loss: Solution,
) -> Result<MapEstimate, MapError> {
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
    let mut out = problem.complete(with_free_stiffness)?;
    let prior = &problem.model.prior;
    let (mut joints, mut columns) = (Vec::new(), Vec::new());
    let mut column = prior.dimension();
    for change in &out.changes {
        if let (ChangeKind::Compliance(joint), true) =
            (change.kind, problem.is_before_recording(change))
        {
            joints.push(joint);
            columns.push(column);
        }
        column += change.kind.columns();
    }
    let probability = mixture::average(
        &columns,
        LOST_STIFFNESS,
        &mut out.state,
        &mut out.covariance,
    )?;
    let total = out.state.len();
    for ((joint, column), probability) in joints.into_iter().zip(columns).zip(probability) {
        // Mean and square over both: without a change both are zero.
        let likely = probability.max(f64::MIN_POSITIVE);
        let (mean, variance) = (out.state[column], out.covariance[column * (total + 1)]);
        let size = mean / likely;
        let square = (variance + mean * mean) / likely;
        let std = libm::sqrt((square - size * size).max(0.0));
        out.stiffness_changes[joint] = Some(StiffnessChange {
            probability,
            compliance_increase: Gaussian::new(size, std),
        });
    }
    if !is_free {
        out.fold(prior, is_stiffness_loss);
    }
    Ok(out)
}
