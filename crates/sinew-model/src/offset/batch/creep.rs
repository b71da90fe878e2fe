//! Ropes that creep while a recording goes on: offsets that move evenly from its first block to its last.
//!
//! A slip takes what creep leaves for a few steps of its own, and creep takes a slip for a slope. So both are tried: creep
//! beside the slips that were found without it, and slips looked for beside creep. What costs least stays.

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

/// Creep that is less likely than this at every joint is left out. It was less likely in six recordings of S6, where
/// nothing creeps.
const UNLIKELY: f64 = 0.05;
/// Creep that two steps say is less likely than this stays so.
const SUSPECTED: f64 = 0.03;
/// What creep must be for slips to be looked for anew beside it.
const LIKELY: f64 = 0.5;
/// What a slip must take off the cost, as the search for slips has it.
const SLIP_GAIN: f64 = 13.0;

/// What creep says of a recording: with the slips found without it, or with those found beside it.
///
/// * `first`: the estimate without any change within the recording; `found`: with all that were found.
/// * `search`: looks for slips beside what an estimate has.
///
/// # Errors
/// [`MapError`].
pub(super) fn told_apart(
    problem: &Problem<'_>,
    first: &Solution,
    found: Solution,
    search: impl FnOnce(Solution) -> Result<Solution, MapError>,
) -> Result<Solution, MapError> {
    let beside = opened(problem, &found)?;
    let is_likely = probability(problem, &beside)? > LIKELY;
    let slips = |s: &Solution| {
        let is_slip = |c: &&ChangePoint| matches!(c.kind, ChangeKind::Offset(_));
        s.estimate.changes.iter().filter(is_slip).count()
    };
    let before = slips(&found);
    let alone = match before {
        0 => beside.clone(),
        _ => opened(problem, first)?,
    };
    // Creep alone may do what several slips were needed for.
    let dearer = cost_at(problem, &alone.estimate, &found.estimate) - found.cost();
    let spared = before > 0 && dearer < SLIP_GAIN * before as f64;
    let mut best = beside;
    if is_likely || spared {
        let anew = search(alone)?;
        let dearer = cost_at(problem, &anew.estimate, &best.estimate) - best.cost();
        let fewer = before as f64 - slips(&anew) as f64;
        if dearer < SLIP_GAIN * fewer {
            best = anew;
        }
    }
    match probability(problem, &best)? > UNLIKELY {
        true => Ok(best),
        false => Ok(found),
    }
}

/// `known` with every tendon's creep open, from the first block on.
fn opened(problem: &Problem<'_>, known: &Solution) -> Result<Solution, MapError> {
    let known = &known.estimate;
    let prior = &problem.model.prior;
    let elastic = (0..prior.joints()).filter(|&i| prior.is_elastic(i));
    let creeps = elastic.map(|i| ChangePoint {
        kind: ChangeKind::Creep(i),
        at_s: problem.start_of(0),
    });
    let mut changes = known.changes.clone();
    changes.extend(creeps);
    let mut state = known.state.clone();
    state.resize(problem.total(&changes), 0.0);
    let warm = solve_from(problem, &changes, &state, known, WARM_START)?;
    if probability(problem, &warm)? < SUSPECTED {
        return Ok(warm);
    }
    // Much of it was taken for noise.
    let near = &warm.estimate;
    solve_from(problem, &near.changes, &near.state, near, ROUGH_START)
}

/// Probability of creep at the joint where that is likeliest.
fn probability(problem: &Problem<'_>, with: &Solution) -> Result<f64, MapError> {
    let known = &with.estimate;
    let total = known.state.len();
    let columns = columns(&known.changes, problem.total(&[]));
    let covariance = covariance(&with.information, total)?;
    let rates: Vec<f64> = columns.iter().map(|(_, c)| known.state[*c]).collect();
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
    use crate::offset::belief::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::offset::block::Block;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{BLOCKS, SLIPS_AT, slipping, turntable};

    /// 6 mrad a minute: 1.6 mrad over the blocks.
    const RATE_RAD_PER_S: f64 = 1e-4;
    const LONG_S: f64 = 0.2 * BLOCKS as f64;
    const SLIP: ChangeKind = ChangeKind::Offset(0);
    /// Of the fixture.
    const AT_FIRST_RAD: f64 = 1e-3;

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

    /// What is found where a joint slips and creeps, with the offset at the start and at the end less the truth, over its
    /// deviation.
    fn found(slip_rad: f64, rate_rad_per_s: f64, seed: u64) -> (MapEstimate, [f64; 2]) {
        let model = turntable();
        let blocks = moving(&model, slip_rad, rate_rad_per_s, seed);
        let map = searched(&model, UNKNOWN_OFFSET_RAD, &blocks);
        let off = [(0.0, 0.0), (LONG_S, slip_rad)].map(|(at_s, slipped)| {
            let read = map.offset_at(&model.prior, 0, at_s);
            let truth = AT_FIRST_RAD + slipped + rate_rad_per_s * at_s;
            (read.mean - truth) / read.deviation
        });
        assert_eq!(
            map.offset(&model.prior, 0),
            map.offset_at(&model.prior, 0, LONG_S)
        );
        (map, off)
    }

    /// What is told of a recording in which changes were found at some blocks; `search` looks for slips beside creep alone.
    fn told(
        (slip_rad, rate_rad_per_s): (f64, f64),
        kind: ChangeKind,
        found_at: &[usize],
        search: impl FnOnce(Solution) -> Solution,
    ) -> MapEstimate {
        let model = turntable();
        let blocks = moving(&model, slip_rad, rate_rad_per_s, 3);
        let believed = model.prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem =
            Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let change = |b: &usize| ChangePoint {
            kind,
            at_s: problem.start_of(*b),
        };
        let found: Vec<ChangePoint> = found_at.iter().map(change).collect();
        let (first, found) = (solve(&problem, &[]), solve(&problem, &found));
        told_apart(&problem, &first.unwrap(), found.unwrap(), |s| Ok(search(s)))
            .unwrap()
            .estimate
    }

    /// Eight slips of 0.1 mrad each look as a creep does, which needs one number where they need eight.
    #[test]
    fn creep_that_was_taken_for_many_slips_is_told_from_them() {
        let staircase: Vec<usize> = (1..9).map(|k| k * BLOCKS / 9).collect();
        let map = told((0.0, 0.5 * RATE_RAD_PER_S), SLIP, &staircase, |alone| {
            assert!(slips(&alone.estimate).is_empty());
            alone
        });
        assert!(slips(&map).is_empty(), "{:?}", map.changes);
        let creeps = |c: &ChangePoint| c.kind == ChangeKind::Creep(0);
        assert!(map.changes.iter().any(creeps), "{:?}", map.changes);
    }

    /// What was found beside slips is none of creep's business: it is still there when slips are looked for anew.
    #[test]
    fn a_loss_of_stiffness_that_was_found_stays_beside_creep() {
        let softer = ChangeKind::Compliance(0);
        let mut searched = false;
        let map = told((0.0, RATE_RAD_PER_S), softer, &[SLIPS_AT], |alone| {
            searched = true;
            assert!(alone.estimate.changes.iter().any(|c| c.kind == softer));
            alone
        });
        assert!(searched && map.changes.iter().any(|c| c.kind == softer));
    }

    /// No creep does what a slip of 3 mrad did: nothing is looked for anew, and it stays.
    #[test]
    fn a_slip_that_creep_cannot_stand_for_stays() {
        let map = told((3e-3, 0.0), SLIP, &[SLIPS_AT], |_| {
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
    fn an_offset_that_moves_evenly_creeps_and_is_told_at_the_end() {
        for seed in 1..6 {
            let (map, off) = found(0.0, RATE_RAD_PER_S, seed);
            assert!(slips(&map).is_empty(), "{seed}: {:?}", map.changes);
            let creep = map.creep[0].unwrap();
            assert!(creep.probability > 0.99, "{seed}: {creep:?}");
            let rate = creep.rate_rad_per_s;
            assert!(
                (rate.mean - RATE_RAD_PER_S).abs() < 3.0 * rate.deviation,
                "{seed}: {rate:?}"
            );
            assert!(rate.deviation < 0.2 * RATE_RAD_PER_S, "{seed}: {rate:?}");
            assert!(off.iter().all(|z| z.abs() < 3.0), "{seed}: {off:?}");
        }
    }

    #[test]
    fn a_slip_is_no_creep_and_an_offset_that_stays_is_neither() {
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
    fn a_joint_that_creeps_may_slip() {
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
