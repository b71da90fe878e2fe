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

/// A stiffness' change above this is no failed strand but something that isn't modelled, such as a
/// load where none was stated: it is left unexplained.
pub(super) const MOST_SOFTER: f64 = 0.25;
/// What opening it must take off the cost for the search to start from it. Without such a
/// change it is below 3 in a minute of many poses, up to 6 in a quarter of a minute of six; with 8 %
/// less stiffness at two joints above 12.
const LEAST_GAIN: f64 = 8.0;

/// The estimate with every stiffness opened since the recording began: between two recordings
/// strands may have failed at several joints, and opening one at a time leaves the others to
/// look like slips and loads. `None` where no stiffness was known, or no strand does what it
/// finds.
pub(super) fn opened(problem: &Problem<'_>) -> Result<Option<Solution>, MapError> {
    if problem.blocks.is_empty() {
        return Ok(None);
    }
    let reduced = &problem.model.reduced;
    let known = reduced.known_stiffness(&problem.start, LOST_STIFFNESS.deviation);
    let changes: Vec<ChangePoint> = (known.into_iter())
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
    let possible = sizes.all(|size| size.abs() < MOST_SOFTER);
    Ok(possible.then_some(trial))
}

/// Whether stiffness is so surely lost that the search starts from there.
pub(super) fn is_sure(problem: &Problem<'_>, best: &Solution, softer: &Solution) -> bool {
    let before = cost_at(problem, &best.estimate, &softer.estimate);
    before - softer.cost() > LEAST_GAIN
}

/// The estimate averaged over the joints whose stiffness has changed since the recording before.
pub(super) fn averaged(
    problem: &Problem<'_>,
    best: Solution,
    softer: Solution,
) -> Result<MapEstimate, MapError> {
    let found = best.estimate.changes.clone();
    let is_softer = |c: &ChangePoint| {
        matches!(c.kind, ChangeKind::Compliance(_)) && problem.is_before_recording(c)
    };
    let is_opened = found.iter().any(is_softer);
    let opened = if is_opened {
        best
    } else if found.is_empty() {
        softer
    } else {
        let known = &best.estimate;
        let changes = [&found[..], &softer.estimate.changes].concat();
        let mut state = known.state.clone();
        state.resize(problem.total(&changes), 0.0);
        solve_from(problem, &changes, &state, known, ROUGH_START)?
    };
    let mut out = problem.complete(opened)?;
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
        let softer = mean / likely;
        let square = (variance + mean * mean) / likely;
        let deviation = libm::sqrt((square - softer * softer).max(0.0));
        out.stiffness_changes[joint] = Some(StiffnessChange {
            probability,
            softening: Gaussian::new(softer, deviation),
        });
    }
    if !is_opened {
        out.fold(prior, is_softer);
    }
    Ok(out)
}
