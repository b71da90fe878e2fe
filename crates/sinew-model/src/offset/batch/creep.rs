//! Ropes that creep during a recording: offsets that change linearly in time from its first block to its last.
//!
//! A slip estimate absorbs part of a creep rate, and a creep rate absorbs part of a slip. Both orders are tried: creep
//! in addition to the slips found without it, and slips searched for in addition to creep. The solution of lowest cost
//! is kept.

use super::cost::cost_at;
use super::gauss_newton::solve_from;
use super::problem::Problem;
use super::schedule::{ROUGH_START, WARM_START};
use super::solution::{Solution, covariance};
use crate::Gaussian;
use crate::offset::change::{ChangeKind, ChangePoint};
use crate::offset::error::MapError;
use crate::offset::estimate::{CreepEstimate, MapEstimate};
use crate::offset::mixture::{self, CREEP, Mixture};
use alloc::vec::Vec;

/// Minimum probability of creep at the most probable joint; below it creep is excluded. Six recordings of S6, without
/// creep, stay below it.
const MIN_CREEP_PROBABILITY: f64 = 0.05;
/// Minimum probability of creep from two steps for a full estimate.
const MIN_SCREENED_PROBABILITY: f64 = 0.03;
/// Minimum probability of creep for a new search for slips in addition to it.
const SEARCH_PROBABILITY: f64 = 0.5;
/// Minimum decrease of the cost by a slip, the same as in the search for slips.
const MIN_SLIP_GAIN: f64 = 13.0;

/// Estimates creep in a recording: with the slips found without it, or with those found in addition to it.
///
/// * `first`: the estimate without any change within the recording; `found`: with all that were found.
/// * `search`: searches for slips in addition to the changes of an estimate.
///
/// # Errors
/// Returns a [`MapError`] if a linear system cannot be solved.
pub(super) fn separate_creep_and_slips(
    problem: &Problem<'_>,
    first: &Solution,
    found: Solution,
    search: impl FnOnce(Solution) -> Result<Solution, MapError>,
) -> Result<Solution, MapError> {
    let with_slips = with_free_creep(problem, &found)?;
    let is_likely = probability(problem, &with_slips)? > SEARCH_PROBABILITY;
    let slips = |s: &Solution| {
        let is_slip = |c: &&ChangePoint| matches!(c.kind, ChangeKind::Offset(_));
        s.estimate.changes.iter().filter(is_slip).count()
    };
    let before = slips(&found);
    let alone = match before {
        0 => with_slips.clone(),
        _ => with_free_creep(problem, first)?,
    };
    // Creep alone may do what several slips were needed for.
    let dearer = cost_at(problem, &alone.estimate, &found.estimate) - found.cost();
    let spared = before > 0 && dearer < MIN_SLIP_GAIN * before as f64;
    let mut best = with_slips;
    if is_likely || spared {
        let searched_again = search(alone)?;
        let dearer = cost_at(problem, &searched_again.estimate, &best.estimate) - best.cost();
        let fewer = before as f64 - slips(&searched_again) as f64;
        if dearer < MIN_SLIP_GAIN * fewer {
            best = searched_again;
        }
    }
    match probability(problem, &best)? > MIN_CREEP_PROBABILITY {
        true => Ok(best),
        false => Ok(found),
    }
}

/// Returns `solution` with a free creep rate of every tendon, from the first block on.
fn with_free_creep(problem: &Problem<'_>, solution: &Solution) -> Result<Solution, MapError> {
    let estimate = &solution.estimate;
    let prior = &problem.model.prior;
    let elastic = (0..prior.joints()).filter(|&i| prior.is_elastic(i));
    let creeps = elastic.map(|i| ChangePoint {
        kind: ChangeKind::Creep(i),
        at_s: problem.start_of(0),
    });
    let mut changes = estimate.changes.clone();
    changes.extend(creeps);
    let mut state = estimate.state.clone();
    state.resize(problem.total(&changes), 0.0);
    let warm = solve_from(problem, &changes, &state, estimate, WARM_START)?;
    if probability(problem, &warm)? < MIN_SCREENED_PROBABILITY {
        return Ok(warm);
    }
    // Much of it was taken for noise.
    let near = &warm.estimate;
    solve_from(problem, &near.changes, &near.state, near, ROUGH_START)
}

/// Returns the probability of creep at the most probable joint.
fn probability(problem: &Problem<'_>, with: &Solution) -> Result<f64, MapError> {
    let estimate = &with.estimate;
    let total = estimate.state.len();
    let columns = columns(&estimate.changes, problem.total(&[]));
    let covariance = covariance(&with.information, total)?;
    let rates: Vec<f64> = columns.iter().map(|(_, c)| estimate.state[*c]).collect();
    let own: Vec<f64> = (columns.iter())
        .flat_map(|(_, i)| columns.iter().map(move |(_, k)| i * total + k))
        .map(|at| covariance[at])
        .collect();
    let mut mixture = Mixture::new(columns.len(), 0);
    mixture.weigh(&rates, &own, CREEP);
    Ok(mixture.probability.into_iter().fold(0.0, f64::max))
}

/// Joints that may creep, and where their rates are in a state whose changes begin at `first`.
fn columns(changes: &[ChangePoint], first: usize) -> Vec<(usize, usize)> {
    let mut column = first;
    let mut out = Vec::new();
    for change in changes {
        if let ChangeKind::Creep(joint) = change.kind {
            out.push((joint, column));
        }
        column += change.kind.columns();
    }
    out
}

/// Averages a complete estimate over which joints creep, where it has any creep open.
pub(super) fn average(problem: &Problem<'_>, out: &mut MapEstimate) -> Result<(), MapError> {
    let of = columns(&out.changes, problem.model.prior.dimension());
    if of.is_empty() {
        return Ok(());
    }
    let places: Vec<usize> = of.iter().map(|(_, column)| *column).collect();
    let probability = mixture::average(&places, CREEP, &mut out.state, &mut out.covariance)?;
    let total = out.state.len();
    for ((joint, column), probability) in of.into_iter().zip(probability) {
        let variance = out.covariance[column * (total + 1)];
        out.creep[joint] = Some(CreepEstimate {
            probability,
            rate_rad_per_s: Gaussian::new(out.state[column], libm::sqrt(variance)),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::gauss_newton::solve;
    use crate::offset::batch::search::searched;
    use crate::offset::block::Block;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{BLOCKS, SLIPS_AT, slipping, turntable};
    use crate::offset::state_estimate::{Payload, UNKNOWN_OFFSET_RAD};

    /// 6 mrad a minute: 1.6 mrad over the blocks.
    const RATE_RAD_PER_S: f64 = 1e-4;
    const DURATION_S: f64 = 0.2 * BLOCKS as f64;
    const SLIP: ChangeKind = ChangeKind::Offset(0);
    /// Offset at the start of the fixture's recording, rad.
    const INITIAL_OFFSET_RAD: f64 = 1e-3;

    /// Blocks of a joint that slips and creeps.
    fn moving(
        model: &EstimationModel,
        slip_rad: f64,
        rate_rad_per_s: f64,
        seed: u64,
    ) -> Vec<Block> {
        let mut blocks = slipping(model, slip_rad, seed);
        for block in &mut blocks {
            let y = block.y[0] + rate_rad_per_s * block.time_s;
            (block.y[0], block.y_square[0], block.y_cube[0]) = (y, y * y, y * y * y);
        }
        blocks
    }

    /// Returns the estimate for a joint that slips and creeps, with the errors of the offset at the start and at the
    /// end, divided by their standard deviations.
    fn found(slip_rad: f64, rate_rad_per_s: f64, seed: u64) -> (MapEstimate, [f64; 2]) {
        let model = turntable();
        let blocks = moving(&model, slip_rad, rate_rad_per_s, seed);
        let map = searched(&model, UNKNOWN_OFFSET_RAD, &blocks);
        let off = [(0.0, 0.0), (DURATION_S, slip_rad)].map(|(at_s, slipped)| {
            let read = map.offset_at(&model.prior, 0, at_s);
            let truth = INITIAL_OFFSET_RAD + slipped + rate_rad_per_s * at_s;
            (read.mean - truth) / read.std
        });
        assert_eq!(
            map.offset(&model.prior, 0),
            map.offset_at(&model.prior, 0, DURATION_S)
        );
        (map, off)
    }

    /// Returns the estimate of a recording in which changes were found at some blocks; `search` searches for slips in
    /// addition to creep.
    fn estimate_with_changes(
        (slip_rad, rate_rad_per_s): (f64, f64),
        kind: ChangeKind,
        found_at: &[usize],
        search: impl FnOnce(Solution) -> Solution,
    ) -> MapEstimate {
        let model = turntable();
        let blocks = moving(&model, slip_rad, rate_rad_per_s, 3);
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem =
            Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let change = |b: &usize| ChangePoint {
            kind,
            at_s: problem.start_of(*b),
        };
        let found: Vec<ChangePoint> = found_at.iter().map(change).collect();
        let (first, found) = (solve(&problem, &[]), solve(&problem, &found));
        separate_creep_and_slips(&problem, &first.unwrap(), found.unwrap(), |s| Ok(search(s)))
            .unwrap()
            .estimate
    }

    /// Eight slips of 0.1 mrad each look like creep, which needs one parameter instead of eight.
    #[test]
    fn creep_replaces_staircase_of_slips() {
        let staircase: Vec<usize> = (1..9).map(|k| k * BLOCKS / 9).collect();
        let map = estimate_with_changes((0.0, 0.5 * RATE_RAD_PER_S), SLIP, &staircase, |alone| {
            assert!(slips(&alone.estimate).is_empty());
            alone
        });
        assert!(slips(&map).is_empty(), "{:?}", map.changes);
        let creeps = |c: &ChangePoint| c.kind == ChangeKind::Creep(0);
        assert!(map.changes.iter().any(creeps), "{:?}", map.changes);
    }

    /// A change found in addition to slips is independent of creep: it is kept when slips are searched for again.
    #[test]
    fn stiffness_loss_is_kept_with_creep() {
        let softer = ChangeKind::Compliance(0);
        let mut searched = false;
        let map = estimate_with_changes((0.0, RATE_RAD_PER_S), softer, &[SLIPS_AT], |alone| {
            searched = true;
            assert!(alone.estimate.changes.iter().any(|c| c.kind == softer));
            alone
        });
        assert!(searched && map.changes.iter().any(|c| c.kind == softer));
    }

    /// No creep explains a slip of 3 mrad: there is no new search, and the slip is kept.
    #[test]
    fn slip_not_explained_by_creep_is_kept() {
        let map = estimate_with_changes((3e-3, 0.0), SLIP, &[SLIPS_AT], |_| {
            panic!("nothing speaks for it")
        });
        assert_eq!(slips(&map), [0.2 * SLIPS_AT as f64]);
    }

    fn slips(map: &MapEstimate) -> Vec<f64> {
        let slips = map.changes.iter();
        let slips = slips.filter(|c| c.kind == ChangeKind::Offset(0));
        slips.map(|c| c.at_s).collect()
    }

    #[test]
    fn linear_drift_is_creep_offset_at_end() {
        for seed in 1..6 {
            let (map, off) = found(0.0, RATE_RAD_PER_S, seed);
            assert!(slips(&map).is_empty(), "{seed}: {:?}", map.changes);
            let creep = map.creep[0].unwrap();
            assert!(creep.probability > 0.99, "{seed}: {creep:?}");
            let rate = creep.rate_rad_per_s;
            assert!(
                (rate.mean - RATE_RAD_PER_S).abs() < 3.0 * rate.std,
                "{seed}: {rate:?}"
            );
            assert!(rate.std < 0.2 * RATE_RAD_PER_S, "{seed}: {rate:?}");
            assert!(off.iter().all(|z| z.abs() < 3.0), "{seed}: {off:?}");
        }
    }

    #[test]
    fn slip_and_constant_offset_are_not_creep() {
        for seed in 1..6 {
            let (map, off) = found(3e-3, 0.0, seed);
            assert_eq!(slips(&map).len(), 1, "{seed}: {:?}", map.changes);
            let likely = map.creep[0].map_or(0.0, |creep| creep.probability);
            assert!(likely < 0.3, "{seed}: {likely}");
            assert!(off.iter().all(|z| z.abs() < 3.0), "{seed}: {off:?}");
            let (map, _) = found(0.0, 0.0, seed);
            assert!(slips(&map).is_empty(), "{seed}: {:?}", map.changes);
            let likely = map.creep[0].map_or(0.0, |creep| creep.probability);
            assert!(likely < 0.3, "{seed}: {likely}");
        }
    }

    #[test]
    fn creeping_joint_slip_is_detected() {
        for seed in 1..6 {
            let (map, off) = found(3e-3, RATE_RAD_PER_S, seed);
            let [at_s] = slips(&map)[..] else {
                panic!("{seed}: {:?}", map.changes);
            };
            assert!((at_s - 0.2 * SLIPS_AT as f64).abs() < 0.5, "{seed}: {at_s}");
            let likely = map.creep[0].unwrap().probability;
            assert!(likely > 0.3, "{seed}: {likely}");
            assert!(off.iter().all(|z| z.abs() < 3.0), "{seed}: {off:?}");
        }
    }
}
