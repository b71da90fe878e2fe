//! Posterior of a change: whether it happened, and when.

use super::changepoint_time::costs_by_time;
use super::cost::cost_at;
use super::gauss_newton::solve;
use super::problem::Problem;
use super::solution::Solution;
use crate::Interval95;
use crate::cholesky;
use crate::offset::change::{ChangeKind, ChangePoint, SearchScope, without};
use crate::offset::error::MapError;
use crate::offset::estimate::ChangePosterior;
use alloc::vec::Vec;

/// Prior odds that a joint slips or loses a strand within a recording; an assumed value.
const SLIP_ODDS: f64 = 0.02;
/// Prior odds that a payload is picked up or put down; an assumed value.
const PAYLOAD_ODDS: f64 = 0.3;
/// Prior odds, per joint and recording, of a persistent effect that resembles a change; from the false detections in
/// simulated recordings.
const LOOKALIKE_ODDS: f64 = 0.001;
/// Maximum exponent of a gain: beyond it a change is certain and the exponential would overflow.
const MAX_LOG_ODDS: f64 = 100.0;
/// Probability on each side outside the interval of the time.
const TAIL: f64 = 0.025;
/// Number of standard deviations beyond which a change is not compared with no change.
pub(super) const CERTAIN_SIGMA: f64 = 12.0;

/// Posterior of every change within the recording; a stiffness loss that accompanies a slip is part
/// of the slip.
///
/// Of `M` times each is as likely before; with the cost `S_b` of a change at block `b`, its
/// prior deviations `s` and the posterior covariance `C` of its entries, it explains the recording
/// better than noise does by (Laplace)
///
/// ```text
/// B = (1/M) Σ_b e^(S − S_b) · e^(S₀ − S) · √|C| / Π s,    S₀: without it,   S: with it
/// ```
///
/// and the time has the probabilities `e^(−S_b)`. An effect that resembles a change has the same likelihood: with the
/// prior odds `o` of a change and `l` of such an effect, the probability of the change is `o B / (1 + (o + l) B)`.
pub(super) fn posteriors(
    problem: &Problem<'_>,
    best: &Solution,
    scope: SearchScope,
) -> Result<Vec<ChangePosterior>, MapError> {
    let changes = &best.estimate.changes;
    let own = |c: &ChangePoint| {
        let before = matches!(c.kind, ChangeKind::Compliance(_)) && problem.is_before_recording(c);
        let stays = matches!(c.kind, ChangeKind::Creep(_) | ChangeKind::Force);
        !before && !stays && !changes.iter().any(|slip| c.accompanies(slip))
    };
    let numbers = (0..changes.len()).filter(|&k| own(&changes[k]));
    numbers
        .map(|k| posterior(problem, best, k, scope))
        .collect()
}

fn posterior(
    problem: &Problem<'_>,
    best: &Solution,
    k: usize,
    scope: SearchScope,
) -> Result<ChangePosterior, MapError> {
    let estimate = &best.estimate;
    let change = estimate.changes[k];
    let costs = costs_by_time(problem, estimate, k);
    let times: Vec<(f64, f64)> = (costs.iter().enumerate())
        .map(|(b, cost)| (problem.start_of(b), *cost))
        .filter(|(at_s, _)| problem.is_possible(change.kind, *at_s, scope))
        .collect();
    let here = problem.blocks.iter().position(|b| b.time_s >= change.at_s);
    let here = here.and_then(|b| costs.get(b)).copied().unwrap_or_default();
    // Over the most probable time, which may differ if a time was not refined.
    let least = times.iter().fold(here, |least, (_, cost)| least.min(*cost));
    let odds: Vec<f64> = (times.iter())
        .map(|(_, cost)| libm::exp(least - cost))
        .collect();
    let all: f64 = odds.iter().sum();
    let happens = match change.kind {
        ChangeKind::Payload => PAYLOAD_ODDS,
        ChangeKind::Offset(_)
        | ChangeKind::Compliance(_)
        | ChangeKind::Creep(_)
        | ChangeKind::Force => SLIP_ODDS,
    };
    let ln_explains = here - least
        + libm::log(all / times.len().max(1) as f64)
        + gain(problem, best, k)?
        + ln_volume_ratio(problem, best, k)?;
    let explains = libm::exp(ln_explains.min(MAX_LOG_ODDS));
    let or_else = (happens + LOOKALIKE_ODDS) * explains;
    let half_block_s = 0.5 * problem.model.block_s;
    // The blocks are delayed by the low-pass, but no block precedes the first.
    let happened = |at_s: f64| (at_s - problem.model.delay_s).max(problem.start_of(0));
    let at = |share: f64| {
        let mut sum = 0.0;
        let mut passed = times.iter().zip(&odds);
        let reached = passed.find(|(_, odds)| {
            sum += **odds;
            sum >= share * all
        });
        reached.map_or(change.at_s, |((at_s, _), _)| *at_s)
    };
    Ok(ChangePosterior {
        change,
        time_s: happened(change.at_s),
        probability: happens * explains / (1.0 + or_else),
        probability_not_noise: or_else / (1.0 + or_else),
        interval_s: Interval95::new(
            happened(at(TAIL) - half_block_s),
            happened(at(1.0 - TAIL) + half_block_s),
        ),
    })
}

/// Returns the decrease of the cost by change `k` with its stiffness loss; for a change of many standard deviations a
/// lower bound.
fn gain(problem: &Problem<'_>, best: &Solution, k: usize) -> Result<f64, MapError> {
    let estimate = &best.estimate;
    if best.significance(problem.total(&estimate.changes[..k])) > CERTAIN_SIGMA {
        return Ok(0.5 * CERTAIN_SIGMA * CERTAIN_SIGMA);
    }
    let other = solve(problem, &without(&estimate.changes, k))?;
    Ok(cost_at(problem, &other.estimate, estimate) - best.cost())
}

/// Returns `½ ln |C| − Σ ln s` of its entries.
fn ln_volume_ratio(problem: &Problem<'_>, best: &Solution, k: usize) -> Result<f64, MapError> {
    let changes = &best.estimate.changes;
    let total = best.estimate.state.len();
    let (mut columns, mut ln_before) = (Vec::new(), 0.0);
    let mut column = problem.total(&[]);
    for (j, change) in changes.iter().enumerate() {
        let stds = problem.stds(change);
        if j == k || change.accompanies(&changes[k]) {
            columns.extend(column..column + stds.len());
            ln_before += stds.iter().map(|s| libm::log(*s)).sum::<f64>();
        }
        column += stds.len();
    }
    let through: Vec<Vec<f64>> = (columns.iter())
        .map(|&column| {
            let mut unit = alloc::vec![0.0; total];
            unit[column] = 1.0;
            best.factor.forward(&mut unit);
            unit
        })
        .collect();
    let n = columns.len();
    let own: Vec<f64> = (through.iter())
        .flat_map(|a| through.iter().map(|b| cholesky::dot(a, b)))
        .collect();
    let mut factor = alloc::vec![0.0; n * n];
    cholesky::factorise(&own, &mut factor, n).map_err(MapError::Prior)?;
    let ln_root: f64 = (0..n).map(|i| libm::log(factor[i * n + i])).sum();
    Ok(ln_root - ln_before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::batch::changepoint_time::at_best_time;
    use crate::offset::block::Block;
    use crate::offset::equations::estimation_model::EstimationModel;
    use crate::offset::executor::Sequential;
    use crate::offset::fixtures::{BLOCKS, SCOPE, SLIPS_AT, random, slipping, turntable};
    use crate::offset::state_estimate::{Payload, UNKNOWN_OFFSET_RAD};

    /// Evaluates `of` on a recording.
    fn of_recording<T>(
        model: &EstimationModel,
        blocks: &[Block],
        of: impl FnOnce(Problem<'_>) -> T,
    ) -> T {
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        of(Problem::new(model, &Sequential, &believed, Payload::Empty, blocks).unwrap())
    }

    /// With a slip put at a block, moved to where it belongs.
    fn with_slip(problem: &Problem<'_>, b: usize) -> Solution {
        let slip = ChangePoint {
            kind: ChangeKind::Offset(0),
            at_s: problem.start_of(b),
        };
        let there = solve(problem, &[slip]).unwrap();
        let moved = at_best_time(problem, &there, 0, |at_s| {
            problem.is_possible(slip.kind, at_s, SCOPE)
        });
        moved.unwrap().unwrap_or(there)
    }

    fn of(problem: &Problem<'_>, solution: &Solution) -> ChangePosterior {
        let all = posteriors(problem, solution, SCOPE).unwrap();
        assert_eq!(all.len(), 1);
        all[0]
    }

    #[test]
    fn slip_probability_increases_with_size() {
        let model = turntable();
        let mut last = 0.0;
        for (slip_rad, least, most) in [(0.0, 0.0, 0.02), (0.5e-3, 0.02, 0.94), (5e-3, 0.95, 0.96)]
        {
            let blocks = slipping(&model, slip_rad, 4);
            let probability = of_recording(&model, &blocks, |problem| {
                of(&problem, &with_slip(&problem, SLIPS_AT)).probability
            });
            assert!(
                (least..=most).contains(&probability),
                "{slip_rad}: {probability}"
            );
            assert!(probability > last);
            last = probability;
        }
    }

    /// A significant change is a slip or an effect similar to a slip, at most 20 to 1; without a change it is noise.
    #[test]
    fn significant_change_is_slip_or_similar() {
        let model = turntable();
        for (slip_rad, least, most) in [(0.0, 0.0, 0.02), (0.5e-3, 0.02, 0.98), (5e-3, 0.999, 1.0)]
        {
            let blocks = slipping(&model, slip_rad, 4);
            let found = of_recording(&model, &blocks, |problem| {
                of(&problem, &with_slip(&problem, SLIPS_AT))
            });
            let not_noise = found.probability_not_noise;
            assert!((least..=most).contains(&not_noise), "{slip_rad}: {found:?}");
            let odds = found.probability / (not_noise - found.probability);
            assert!(
                (odds - SLIP_ODDS / LOOKALIKE_ODDS).abs() < 1e-9 * odds,
                "{odds}"
            );
        }
    }

    /// The width of `C` is compared with the determinants of the information with and without the change.
    #[test]
    fn volume_ratio_equals_determinant_ratio() {
        let model = turntable();
        let blocks = slipping(&model, 5e-3, 4);
        let believed = model
            .prior
            .state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem =
            Problem::new(&model, &Sequential, &believed, Payload::Empty, &blocks).unwrap();
        let softer = ChangePoint {
            kind: ChangeKind::Compliance(0),
            at_s: problem.start_of(SLIPS_AT),
        };
        let slip = ChangePoint {
            kind: ChangeKind::Offset(0),
            ..softer
        };
        let with = solve(&problem, &[slip, softer]).unwrap();
        let ln_root = |information: &[f64], n: usize| -> f64 {
            let whole: Vec<f64> = (0..n * n)
                .map(|at| information[(at / n).max(at % n) * n + (at / n).min(at % n)])
                .collect();
            let mut factor = alloc::vec![0.0; n * n];
            cholesky::factorise(&whole, &mut factor, n).unwrap();
            (0..n).map(|i| libm::log(factor[i * n + i])).sum()
        };
        let total = with.estimate.state.len();
        let kept = total - 2;
        let mut without = Vec::new();
        for row in with.information.chunks_exact(total).take(kept) {
            without.extend_from_slice(&row[..kept]);
        }
        let ln_prior: f64 = [slip, softer]
            .iter()
            .flat_map(|c| problem.stds(c))
            .map(libm::log)
            .sum();
        let expected = ln_root(&without, kept) - ln_root(&with.information, total) - ln_prior;
        let narrowed = ln_volume_ratio(&problem, &with, 0).unwrap();
        assert!((narrowed - expected).abs() < 1e-9, "{narrowed} {expected}");
        assert!(narrowed < -3.0, "{narrowed}");
    }

    #[test]
    fn change_time_interval_covers_truth() {
        let model = turntable();
        let mut mean_width = [0.0, 0.0];
        for (slip_rad, width) in [0.6e-3, 3e-3].into_iter().zip(&mut mean_width) {
            const DRAWS: u64 = 20;
            let mut inside = 0;
            for draw in 0..DRAWS {
                let mut seed = 77 + draw;
                random(&mut seed);
                let blocks = slipping(&model, slip_rad, seed);
                let (interval_s, truth) = of_recording(&model, &blocks, |problem| {
                    let posterior = of(&problem, &with_slip(&problem, SLIPS_AT));
                    (
                        posterior.interval_s,
                        problem.start_of(SLIPS_AT) - model.delay_s,
                    )
                });
                inside += u64::from(interval_s.contains(truth));
                *width += (interval_s.high - interval_s.low) / DRAWS as f64;
            }
            assert!(inside >= DRAWS - 2, "{slip_rad}: {inside}");
        }
        let [small, large] = mean_width;
        let whole_s = 0.2 * BLOCKS as f64;
        assert!(large < small && small < 0.6 * whole_s, "{small} {large}");
    }
}
