//! Gauss–Newton on the posterior of one recording.

use super::cost::cost_over;
use super::normal::{NormalEquations, Residuals};
use super::problem::{Problem, chi};
use super::schedule::{COLD_START, OUTLIER_WEIGHT, REFINE, Sampling, Step, THIN, WARM_START};
use super::solution::Solution;
use crate::offset::change::ChangePoint;
use crate::offset::equations::equation::{Equations, Side};
use crate::offset::equations::loaded::Content;
use crate::offset::equations::robust::redescending_weight;
use crate::offset::error::MapError;
use crate::offset::estimate::{Convergence, MapEstimate};
use alloc::vec::Vec;
use core::ops::Range;

/// Normal equations of a range of blocks.
struct Part {
    blocks: Range<usize>,
    normal: NormalEquations,
    residuals: Residuals,
    equations: Equations,
    /// Weight of each of them.
    weights: Vec<f64>,
}

/// Computes the estimate with changes at fixed times.
pub(super) fn solve(problem: &Problem<'_>, changes: &[ChangePoint]) -> Result<Solution, MapError> {
    descend(problem, changes, COLD_START, None)
}

/// [`solve`] from a state with its noise, by a schedule for how near that is.
pub(super) fn solve_from(
    problem: &Problem<'_>,
    changes: &[ChangePoint],
    state: &[f64],
    estimate: &MapEstimate,
    schedule: &[Step],
) -> Result<Solution, MapError> {
    descend(problem, changes, schedule, Some((state, estimate)))
}

/// To the end from a coarse solution.
pub(super) fn refine(problem: &Problem<'_>, coarse: &Solution) -> Result<Solution, MapError> {
    let at = &coarse.estimate;
    solve_from(problem, &at.changes, &at.state, at, REFINE)
}

/// Returns the complete estimate of `last` from the solution `found` of `problem`, which may weigh the same blocks differently.
pub(super) fn completed(
    problem: &Problem<'_>,
    last: &Problem<'_>,
    found: Solution,
) -> Result<MapEstimate, MapError> {
    match core::ptr::eq(problem, last) {
        true => last.complete(found),
        false => last.complete(refine(last, &found)?),
    }
}

/// Computes the estimate without the changes of `with`: two steps from its conditional mean, which
/// is exact for linear equations.
pub(super) fn solve_without(problem: &Problem<'_>, with: &Solution) -> Result<Solution, MapError> {
    let state = with.state_without(problem.total(&[]));
    solve_from(problem, &[], &state, &with.estimate, WARM_START)
}

fn descend(
    problem: &Problem<'_>,
    changes: &[ChangePoint],
    schedule: &[Step],
    warm: Option<(&[f64], &MapEstimate)>,
) -> Result<Solution, MapError> {
    let n = problem.layout().joints;
    let model = problem.model;
    let total = problem.total(changes);
    let prior = problem.prior_information(changes, total);
    let mut at = MapEstimate {
        changes: changes.to_vec(),
        state: problem.origin(total),
        covariance: Vec::new(),
        temperature_c: problem.start.temperature_c,
        end_s: problem.end_s(),
        noise_rad: alloc::vec![1e-3; n],
        motor_noise_nm: (0..n).map(|i| model.motor_floor(i)).collect(),
        tension_noise_nm: (0..n).map(|i| model.tension_floor(i)).collect(),
        weights: Vec::with_capacity(problem.blocks.len()),
        convergence: Convergence::new(0, f64::INFINITY, f64::INFINITY),
        stiffness_changes: alloc::vec![None; n],
        creep: alloc::vec![None; n],
        force: None,
        posteriors: Vec::new(),
        encoder_slips: Vec::new(),
    };
    if let Some((state, estimate)) = warm {
        at.state.copy_from_slice(state);
        at.noise_rad.copy_from_slice(&estimate.noise_rad);
        at.motor_noise_nm.copy_from_slice(&estimate.motor_noise_nm);
        at.tension_noise_nm
            .copy_from_slice(&estimate.tension_noise_nm);
    }
    let mut last_step = f64::INFINITY;
    let mut parts = parts(problem, changes, schedule);
    for (stage, step) in schedule.iter().enumerate() {
        let (first, others) = parts.split_at_mut(1);
        let first = &mut first[0];
        first.normal.start(&prior, &problem.prior_gradient(&at));
        match others {
            [] => sum(problem, &at, step, first),
            [other, ..] => {
                other.normal.clear();
                problem
                    .executor
                    .join(&mut || sum(problem, &at, step, first), &mut || {
                        sum(problem, &at, step, other)
                    });
                first.normal.merge(&mut other.normal);
            }
        }
        last_step = first.normal.solve()?;
        for (x, step) in at.state.iter_mut().zip(&first.normal.gradient) {
            *x += step;
        }
        // Noise from the residuals, once they mean something.
        if stage >= 2 || warm.is_some() {
            for i in 0..n {
                let noise = |side| Residuals::noise(parts.iter().map(|p| &p.residuals), i, side);
                if let Some(noise) = noise(Side::Link) {
                    at.noise_rad[i] = noise.max(model.noise_floor_rad);
                }
                if let Some(noise) = noise(Side::Motor) {
                    at.motor_noise_nm[i] = noise.max(model.motor_floor(i));
                }
                if let Some(noise) = noise(Side::Tension) {
                    at.tension_noise_nm[i] = noise.max(model.tension_floor(i));
                }
            }
        }
    }
    let every = schedule
        .last()
        .map_or(1, |step| step.gradient.every(problem.blocks.len()));
    let cost = cost_over(problem, &at, &at, every);
    at.convergence = Convergence::new(schedule.len(), last_step, cost);
    for part in &mut parts {
        at.weights.append(&mut part.weights);
    }
    let NormalEquations {
        information,
        factor,
        ..
    } = parts.swap_remove(0).normal;
    Ok(Solution {
        estimate: at,
        information,
        factor,
    })
}

/// Divides all blocks into halves if the schedule runs to the end; screening is short, and
/// candidates are screened in parallel.
fn parts(problem: &Problem<'_>, changes: &[ChangePoint], schedule: &[Step]) -> Vec<Part> {
    let count = problem.blocks.len();
    let all_near = schedule
        .iter()
        .all(|step| matches!(step.gradient, Sampling::Thinned));
    // Thinned blocks are multiples of `THIN`.
    let middle = count / 2 / THIN * THIN;
    let ranges = if all_near || middle == 0 {
        alloc::vec![0..count]
    } else {
        alloc::vec![0..middle, middle..count]
    };
    let layout = problem.layout();
    let part = |blocks: Range<usize>| Part {
        normal: NormalEquations::new(problem.total(changes), layout, changes),
        residuals: Residuals::new(layout.joints, blocks.clone()),
        equations: Equations::new(layout, changes),
        weights: alloc::vec![1.0; blocks.len()],
        blocks,
    };
    ranges.into_iter().map(part).collect()
}

/// Adds the equations of a part's blocks for a step from `at`.
fn sum(problem: &Problem<'_>, at: &MapEstimate, step: &Step, part: &mut Part) {
    let [every, informing] =
        [step.gradient, step.information].map(|s| s.every(problem.blocks.len()));
    for b in part.blocks.clone().step_by(every) {
        problem.equations(at, b, Content::Rows, &mut part.equations);
        let weight = redescending_weight(chi(&part.equations, at), step.scale);
        part.weights[b - part.blocks.start] = weight;
        let counts = step.is_wide() || weight > OUTLIER_WEIGHT;
        part.residuals.keep(b, &part.equations, counts);
        let information = |e: &_| weight * problem.information_of(e, at, b);
        part.normal
            .add_gradient(&part.equations, |e| every as f64 * information(e));
        if b % informing == 0 {
            part.normal
                .add_information(&part.equations, |e| informing as f64 * information(e));
        }
    }
}
