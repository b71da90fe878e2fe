//! A constant external force, from the first block on.
//!
//! If it is ignored, it biases offsets, masses and stiffness, and the remainder is treated as noise. The force is
//! therefore freed before changes are searched for: a step over one block in three determines whether the recording
//! supports it, which most recordings do not.

use super::gauss_newton::solve_from;
use super::model_error::{Posterior, weights};
use super::problem::Problem;
use super::schedule::{OUTLIER_WEIGHT, ROUGH_START, SCREENING};
use super::solution::Solution;
use crate::Gaussian;
use crate::cholesky::dot;
use crate::offset::block::Block;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::error::MapError;
use crate::offset::estimate::{ForceEstimate, MapEstimate};
use crate::offset::external_force::PLACE_RAD;
use crate::offset::mixture::{self, Mixture};
use crate::statistics::upper_median;
use alloc::vec::Vec;

/// Minimum probability of a force; below it the force is excluded.
const MIN_FORCE_PROBABILITY: f64 = 0.05;
/// Minimum probability of a force after the first step for a full estimate.
const MIN_SCREENED_PROBABILITY: f64 = 0.03;

/// Returns `found` with a free force if one is specified or supported by the recording.
///
/// # Errors
/// Returns a [`MapError`] if a linear system cannot be solved.
pub(super) fn with_free_force(
    problem: &Problem<'_>,
    found: Solution,
) -> Result<Solution, MapError> {
    let Some(force) = &problem.model.force else {
        return Ok(found);
    };
    if !force.is_identifiable(in_its_place(problem.blocks.iter())) {
        return Ok(found);
    }
    let estimate = &found.estimate;
    let mut changes = estimate.changes.clone();
    changes.push(ChangePoint {
        kind: ChangeKind::Force,
        at_s: problem.start_of(0),
    });
    let mut state = estimate.state.clone();
    state.resize(problem.total(&changes), 0.0);
    let stated = force.prior.is_specified;
    let screened = solve_from(problem, &changes, &state, estimate, SCREENING)?;
    if !stated && probability(problem, &screened) < MIN_SCREENED_PROBABILITY {
        return Ok(found);
    }
    // Much of it was taken for noise.
    let at = &screened.estimate;
    let with = solve_from(problem, &changes, &at.state, at, ROUGH_START)?;
    match stated || probability(problem, &with) > MIN_FORCE_PROBABILITY {
        true => Ok(with),
        false => Ok(found),
    }
}

/// Share of blocks in which the arm is in its place, 0 to 1.
fn in_its_place<'a>(blocks: impl Iterator<Item = &'a Block> + Clone) -> f64 {
    let joints = blocks.clone().next().map_or(0, |b| b.q.len());
    let median = |i: usize| {
        let mut places: Vec<f64> = blocks.clone().filter_map(|b| b.q.get(i)).copied().collect();
        upper_median(&mut places).unwrap_or(f64::NAN)
    };
    let place: Vec<f64> = (0..joints).map(median).collect();
    let is_there = |b: &&Block| {
        let mut pairs = b.q.iter().zip(&place);
        pairs.all(|(q, at)| (q - at).abs() <= PLACE_RAD)
    };
    let there = blocks.clone().filter(is_there).count();
    there as f64 / blocks.count().max(1) as f64
}

/// Whether an estimate has a free force.
pub(super) fn is_open(with: &Solution) -> bool {
    first_column(&with.estimate.changes, 0).is_some()
}

/// Whether an estimate has a force open that is too unlikely to be one.
pub(super) fn is_none(problem: &Problem<'_>, with: &Solution) -> bool {
    let force = problem.model.force.as_ref();
    let is_specified = force.is_some_and(|f| f.prior.is_specified);
    is_open(with) && !is_specified && probability(problem, with) <= MIN_FORCE_PROBABILITY
}

/// Returns the probability of the free force of an estimate.
fn probability(problem: &Problem<'_>, with: &Solution) -> f64 {
    let estimate = &with.estimate;
    let total = estimate.state.len();
    let (Some(first), Some(force)) = (
        first_column(&estimate.changes, problem.total(&[])),
        &problem.model.force,
    ) else {
        return 0.0;
    };
    let [x, y, z] = [0, 1, 2].map(|k| estimate.state[first + k]);
    // If only the data in one pose fit the model, the evidence for a force comes from contacts that moved the arm away.
    let fitting = problem.blocks.iter().zip(&estimate.weights);
    let fitting = fitting.filter(|(_, weight)| **weight > OUTLIER_WEIGHT);
    if !force.is_credible([x, y, z], in_its_place(fitting.map(|(block, _)| block))) {
        return 0.0;
    }
    let through = [0, 1, 2].map(|k| {
        let mut unit = alloc::vec![0.0; total];
        unit[first + k] = 1.0;
        with.factor.forward(&mut unit);
        unit
    });
    let own: Vec<f64> = (through.iter())
        .flat_map(|a| through.iter().map(|b| dot(a, b)))
        .collect();
    let mut mixture = Mixture::new(3, 0);
    mixture.weigh(&[x, y, z], &own, force.odds());
    mixture.probability.into_iter().fold(0.0, f64::max)
}

/// Probability of the free force at column `first` of posteriors.
fn weighed(problem: &Problem<'_>, posteriors: &[Posterior], first: usize) -> f64 {
    let Some(force) = &problem.model.force else {
        return 0.0;
    };
    let columns = [first, first + 1, first + 2];
    let of = |posterior: &Posterior| {
        let mut mixture = Mixture::new(columns.len(), 0);
        mixture.weigh(
            &columns.map(|k| posterior.state[k]),
            &posterior.covariance(&columns),
            force.odds(),
        );
        mixture.probability.into_iter().fold(0.0, f64::max)
    };
    let weights = weights(posteriors);
    let each = posteriors.iter().zip(weights).map(|(p, w)| w * of(p));
    each.sum()
}

/// Returns the column of a force in a state whose changes begin at `first`.
fn first_column(changes: &[ChangePoint], first: usize) -> Option<usize> {
    let mut column = first;
    for change in changes {
        if change.kind == ChangeKind::Force {
            return Some(column);
        }
        column += change.kind.columns();
    }
    None
}

/// Averages a complete estimate over whether its free force acts; a specified force always acts. The probability of the
/// force is that of `evidence`, the posteriors under the model error.
///
/// # Errors
/// Returns a [`MapError`] if a covariance is not positive definite.
pub(super) fn average(
    problem: &Problem<'_>,
    out: &mut MapEstimate,
    evidence: Option<&[Posterior]>,
) -> Result<(), MapError> {
    let prior = &problem.model.prior;
    let (Some(first), Some(force)) = (
        first_column(&out.changes, prior.dimension()),
        &problem.model.force,
    ) else {
        return Ok(());
    };
    let total = out.state.len();
    let force_n = core::array::from_fn(|k| {
        let variance = out.covariance[(first + k) * (total + 1)];
        let mean = force.prior.force_n[k].mean + out.state[first + k];
        Gaussian::new(mean, libm::sqrt(variance))
    });
    let probability = if force.prior.is_specified {
        1.0
    } else {
        let columns = [first, first + 1, first + 2];
        let each = mixture::average(&columns, force.odds(), &mut out.state, &mut out.covariance)?;
        let own = each.into_iter().fold(0.0, f64::max);
        evidence.map_or(own, |evidence| {
            let first = first - prior.dimension() + problem.total(&[]);
            weighed(problem, evidence, first)
        })
    };
    out.force = Some(ForceEstimate {
        is_specified: force.prior.is_specified,
        probability,
        force_n,
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::search::searched;
    use crate::offset::external_force::ExternalForce;
    use crate::offset::fixtures::{pushable, pushed};
    use crate::offset::state_estimate::UNKNOWN_OFFSET_RAD;

    const TRUE_FORCE_N: [f64; 3] = [2.4, -1.2, 4.0];

    /// About a vertical axis the vertical component is not identifiable: it keeps its specified value.
    #[test]
    fn specified_force_corrected_in_observable_axes() {
        let stated = [2.0, -1.6, 5.0].map(|mean| Gaussian::new(mean, 0.5));
        let model = pushable(ExternalForce {
            force_n: stated,
            is_specified: true,
        });
        for seed in 1..4 {
            let map = searched(
                &model,
                UNKNOWN_OFFSET_RAD,
                &pushed(&model, TRUE_FORCE_N, seed),
            );
            let force = map.force.unwrap();
            assert!(force.is_specified && force.probability == 1.0, "{force:?}");
            let [across @ .., along] = force.force_n;
            for (is, should) in across.into_iter().zip(TRUE_FORCE_N) {
                assert!(is.std < 0.4, "{is:?}");
                assert!((is.mean - should).abs() < 3.0 * is.std, "{is:?}");
            }
            assert!((along.mean - 5.0).abs() < 1e-6, "{along:?}");
            assert!((along.std - 0.5).abs() < 1e-6, "{along:?}");
        }
    }

    #[test]
    fn unspecified_force_found_only_if_present() {
        let model = pushable(ExternalForce::possible(2.0).unwrap());
        for seed in 1..4 {
            let map = searched(
                &model,
                UNKNOWN_OFFSET_RAD,
                &pushed(&model, TRUE_FORCE_N, seed),
            );
            let force = map.force.unwrap();
            assert!(!force.is_specified && force.probability > 0.99, "{force:?}");
            for (is, should) in force.force_n.into_iter().zip(TRUE_FORCE_N).take(2) {
                assert!((is.mean - should).abs() < 3.0 * is.std, "{is:?}");
            }
            let map = searched(&model, UNKNOWN_OFFSET_RAD, &pushed(&model, [0.0; 3], seed));
            let probability = map.force.map_or(0.0, |force| force.probability);
            assert!(probability < 0.1, "{probability}");
        }
    }
}
