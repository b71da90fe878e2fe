//! A constant force from outside, from the first block on.
//!
//! Held for nothing, it bends offsets, masses and stiffness, and what they can't take up is left as noise. So it is opened
//! before changes are looked for: a step over one block in three tells whether the recording speaks for it, and in most it
//! doesn't.

use super::gauss_newton::solve_from;
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

/// A force that is less likely than this is left out.
const UNLIKELY: f64 = 0.05;
/// One that the first step says is less likely than this stays so.
const SUSPECTED: f64 = 0.03;

/// `found` with a force open, where one is stated or the recording speaks for it.
///
/// # Errors
/// [`MapError`].
pub(super) fn opened(problem: &Problem<'_>, found: Solution) -> Result<Solution, MapError> {
    let Some(force) = &problem.model.force else {
        return Ok(found);
    };
    if !force.is_asked_for(in_its_place(problem.blocks.iter())) {
        return Ok(found);
    }
    let known = &found.estimate;
    let mut changes = known.changes.clone();
    changes.push(ChangePoint {
        kind: ChangeKind::Force,
        at_s: problem.start_of(0),
    });
    let mut state = known.state.clone();
    state.resize(problem.total(&changes), 0.0);
    let stated = force.believed.is_stated;
    let screened = solve_from(problem, &changes, &state, known, SCREENING)?;
    if !stated && probability(problem, &screened) < SUSPECTED {
        return Ok(found);
    }
    // Much of it was taken for noise.
    let at = &screened.estimate;
    let with = solve_from(problem, &changes, &at.state, at, ROUGH_START)?;
    match stated || probability(problem, &with) > UNLIKELY {
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

/// Whether an estimate has a force open that is too unlikely to be one.
pub(super) fn is_none(problem: &Problem<'_>, with: &Solution) -> bool {
    let force = problem.model.force.as_ref();
    let is_stated = force.is_some_and(|f| f.believed.is_stated);
    let is_open = first_column(&with.estimate.changes, 0).is_some();
    is_open && !is_stated && probability(problem, with) <= UNLIKELY
}

/// Probability of the force that is open in an estimate.
fn probability(problem: &Problem<'_>, with: &Solution) -> f64 {
    let known = &with.estimate;
    let total = known.state.len();
    let (Some(first), Some(force)) = (
        first_column(&known.changes, problem.total(&[])),
        &problem.model.force,
    ) else {
        return 0.0;
    };
    let [x, y, z] = [0, 1, 2].map(|k| known.state[first + k]);
    // Where nothing fits but what the arm does in its place, contacts speak for it that took the arm elsewhere.
    let fitting = problem.blocks.iter().zip(&known.weights);
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

/// Where a force is in a state whose changes begin at `first`.
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

/// Averages a complete estimate over whether the force that is open in it acts; a stated one does.
///
/// # Errors
/// [`MapError`].
pub(super) fn average(problem: &Problem<'_>, out: &mut MapEstimate) -> Result<(), MapError> {
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
        let mean = force.believed.force_n[k].mean + out.state[first + k];
        Gaussian::new(mean, libm::sqrt(variance))
    });
    let probability = if force.believed.is_stated {
        1.0
    } else {
        let columns = [first, first + 1, first + 2];
        let each = mixture::average(&columns, force.odds(), &mut out.state, &mut out.covariance)?;
        each.into_iter().fold(0.0, f64::max)
    };
    out.force = Some(ForceEstimate {
        is_stated: force.believed.is_stated,
        probability,
        force_n,
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::search::searched;
    use crate::offset::belief::UNKNOWN_OFFSET_RAD;
    use crate::offset::external_force::ExternalForce;
    use crate::offset::fixtures::{pushable, pushed};

    const ACTS_N: [f64; 3] = [2.4, -1.2, 4.0];

    /// About a vertical axis nothing is learned of what pulls along it: that part stays as stated.
    #[test]
    fn a_stated_force_is_corrected_as_far_as_the_joints_feel_it() {
        let stated = [2.0, -1.6, 5.0].map(|mean| Gaussian::new(mean, 0.5));
        let model = pushable(ExternalForce {
            force_n: stated,
            is_stated: true,
        });
        for seed in 1..4 {
            let map = searched(&model, UNKNOWN_OFFSET_RAD, &pushed(&model, ACTS_N, seed));
            let force = map.force.unwrap();
            assert!(force.is_stated && force.probability == 1.0, "{force:?}");
            let [across @ .., along] = force.force_n;
            for (is, should) in across.into_iter().zip(ACTS_N) {
                assert!(is.deviation < 0.4, "{is:?}");
                assert!((is.mean - should).abs() < 3.0 * is.deviation, "{is:?}");
            }
            assert!((along.mean - 5.0).abs() < 1e-6, "{along:?}");
            assert!((along.deviation - 0.5).abs() < 1e-6, "{along:?}");
        }
    }

    #[test]
    fn a_force_that_nobody_stated_is_found_where_one_acts_and_only_there() {
        let model = pushable(ExternalForce::possible(2.0).unwrap());
        for seed in 1..4 {
            let map = searched(&model, UNKNOWN_OFFSET_RAD, &pushed(&model, ACTS_N, seed));
            let force = map.force.unwrap();
            assert!(!force.is_stated && force.probability > 0.99, "{force:?}");
            for (is, should) in force.force_n.into_iter().zip(ACTS_N).take(2) {
                assert!((is.mean - should).abs() < 3.0 * is.deviation, "{is:?}");
            }
            let map = searched(&model, UNKNOWN_OFFSET_RAD, &pushed(&model, [0.0; 3], seed));
            let probability = map.force.map_or(0.0, |force| force.probability);
            assert!(probability < 0.1, "{probability}");
        }
    }
}
