//! How sure a change is, and when it came.

use super::changes::{Change, SURE, Seek, What, softens};
use super::map::{MapError, MapEstimate};
use super::solution::Solution;
use super::solve::Problem;
use crate::cholesky;
use alloc::vec::Vec;

/// How sure it is that something changed within a recording, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certainty {
    /// What is meant, where the blocks, which lag, show it.
    pub change: Change,
    /// When it happened, s: that less the lag ([`FeatureConfig::delay_s`](super::FeatureConfig::delay_s)).
    pub at_s: f64,
    /// Probability that it happened, 0…1.
    pub probability: f64,
    /// Probability that it is no noise, whatever it is.
    pub no_noise: f64,
    /// The moment lies between these with 95 %, s.
    pub between_s: [f64; 2],
}

/// Odds that a joint slips or loses a strand within a recording: a starting guess.
const SLIPS: f64 = 0.02;
/// Odds that a load is picked up or put down: a starting guess.
const LOADS: f64 = 0.3;
/// Odds that something else in a recording looks like one and lasts, of each joint: false alarms of the
/// scenario bench.
const LOOKALIKES: f64 = 0.001;
/// More than this is certain; its exponential is finite.
const MOST: f64 = 100.0;
/// Half of what lies outside the interval of the moment.
const TAIL: f64 = 0.025;

impl MapEstimate {
    /// How sure a change within the recording is; of a loss of stiffness that came with a slip, the
    /// slip. `None` where changes were given, not sought, and for what changed before the recording.
    pub fn certainty(&self, change: &Change) -> Option<&Certainty> {
        let mut all = self.certainties.iter();
        all.find(|c| c.change == *change || softens(change, &c.change))
    }
}

impl Problem<'_> {
    /// Of every change within the recording, those of stiffness that came with a slip apart.
    ///
    /// Of `M` moments each is as likely before; with the cost `S_b` of a change at block `b`, its
    /// prior deviations `s` and the posterior covariance `C` of its entries, it explains the recording
    /// better than noise does by (Laplace)
    ///
    /// ```text
    /// B = (1/M) Σ_b e^(S − S_b) · e^(S₀ − S) · √|C| / Π s,    S₀: without it,   S: with it
    /// ```
    ///
    /// and the moment has the probabilities `e^(−S_b)`. What looks like it explains as much: with the
    /// odds `o` of a change and `l` of that, it happened with the probability `o B / (1 + (o + l) B)`.
    pub(super) fn certainties(
        &self,
        best: &Solution,
        seek: Seek,
    ) -> Result<Vec<Certainty>, MapError> {
        let changes = &best.estimate.changes;
        let own = |c: &Change| {
            let before = matches!(c.what, What::Compliance(_)) && self.is_since_before(c);
            !before && !changes.iter().any(|slip| softens(c, slip))
        };
        let numbers = (0..changes.len()).filter(|&k| own(&changes[k]));
        numbers.map(|k| self.certainty(best, k, seek)).collect()
    }

    fn certainty(&self, best: &Solution, k: usize, seek: Seek) -> Result<Certainty, MapError> {
        let known = &best.estimate;
        let change = known.changes[k];
        let sums = self.sums_by_moment(known, k);
        let moments: Vec<(f64, f64)> = (sums.iter().enumerate())
            .map(|(b, sum)| (self.start_of(b), *sum))
            .filter(|(at_s, _)| self.is_possible(change.what, *at_s, seek))
            .collect();
        let here = self.blocks.iter().position(|b| b.time_s >= change.at_s);
        let here = here.and_then(|b| sums.get(b)).copied().unwrap_or_default();
        // Over the likeliest, which may be another where a moment was not settled.
        let least = moments.iter().fold(here, |least, (_, sum)| least.min(*sum));
        let odds: Vec<f64> = (moments.iter())
            .map(|(_, sum)| libm::exp(least - sum))
            .collect();
        let all: f64 = odds.iter().sum();
        let happens = match change.what {
            What::Payload => LOADS,
            What::Offset(_) | What::Compliance(_) => SLIPS,
        };
        let ln_explains = here - least
            + libm::log(all / moments.len().max(1) as f64)
            + self.worth(best, k)?
            + self.ln_narrowed(best, k)?;
        let explains = libm::exp(ln_explains.min(MOST));
        let or_else = (happens + LOOKALIKES) * explains;
        let half_block_s = 0.5 * self.estimator.block_s();
        // The blocks lag, but nothing came before the first.
        let happened = |at_s: f64| (at_s - self.estimator.delay_s()).max(self.start_of(0));
        let at = |share: f64| {
            let mut sum = 0.0;
            let mut passed = moments.iter().zip(&odds);
            let reached = passed.find(|(_, odds)| {
                sum += **odds;
                sum >= share * all
            });
            reached.map_or(change.at_s, |((at_s, _), _)| *at_s)
        };
        Ok(Certainty {
            change,
            at_s: happened(change.at_s),
            probability: happens * explains / (1.0 + or_else),
            no_noise: or_else / (1.0 + or_else),
            between_s: [
                happened(at(TAIL) - half_block_s),
                happened(at(1.0 - TAIL) + half_block_s),
            ],
        })
    }

    /// What change `k`, with the stiffness it took along, takes off the cost; where it is many standard
    /// deviations from nothing, what that is worth at least.
    fn worth(&self, best: &Solution, k: usize) -> Result<f64, MapError> {
        if self.significance(best, k) > SURE {
            return Ok(0.5 * SURE * SURE);
        }
        let known = &best.estimate;
        let without = self.solve(&kept_without(&known.changes, k))?;
        Ok(self.cost_at(&without.estimate, known) - known.cost)
    }

    /// `½ ln |C| − Σ ln s` of its entries.
    fn ln_narrowed(&self, best: &Solution, k: usize) -> Result<f64, MapError> {
        let changes = &best.estimate.changes;
        let total = best.estimate.state.len();
        let (mut columns, mut ln_before) = (Vec::new(), 0.0);
        let mut column = self.total(&[]);
        for (j, change) in changes.iter().enumerate() {
            let deviations = self.deviations(change);
            if j == k || softens(change, &changes[k]) {
                columns.extend(column..column + deviations.len());
                ln_before += deviations.iter().map(|s| libm::log(*s)).sum::<f64>();
            }
            column += deviations.len();
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
}

/// All changes but one and the stiffness it took along.
pub(super) fn kept_without(changes: &[Change], k: usize) -> Vec<Change> {
    let gone = changes[k];
    let changes = changes.iter().copied();
    changes
        .filter(|c| *c != gone && !softens(c, &gone))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::UNKNOWN_OFFSET_RAD;
    use crate::offset::block::Block;
    use crate::offset::drawn::{BLOCKS, SLIPS_AT, random, slipping, turntable};
    use crate::offset::map::MapEstimator;
    use crate::offset::prior::Payload;

    const SEEK: Seek = Seek {
        offsets: true,
        payload: false,
        continues: false,
    };

    /// What `of` says of a recording.
    fn told<T>(estimator: &MapEstimator, blocks: &[Block], of: impl FnOnce(Problem<'_>) -> T) -> T {
        let believed = (estimator.prior()).belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        of(Problem::new(estimator, &believed, Payload::Empty, blocks).unwrap())
    }

    /// With a slip put at a block, moved to where it belongs.
    fn with_slip(problem: &Problem<'_>, b: usize) -> Solution {
        let slip = Change {
            what: What::Offset(0),
            at_s: problem.start_of(b),
        };
        let there = problem.solve(&[slip]).unwrap();
        let moved =
            problem.at_its_moment(&there, 0, |at_s| problem.is_possible(slip.what, at_s, SEEK));
        moved.unwrap().unwrap_or(there)
    }

    fn of(problem: &Problem<'_>, solution: &Solution) -> Certainty {
        let all = problem.certainties(solution, SEEK).unwrap();
        assert_eq!(all.len(), 1);
        all[0]
    }

    #[test]
    fn a_slip_is_surer_the_larger_and_nothing_is_not_one() {
        let estimator = turntable();
        let mut last = 0.0;
        for (slip_rad, least, most) in [(0.0, 0.0, 0.02), (0.5e-3, 0.02, 0.94), (5e-3, 0.95, 0.96)]
        {
            let blocks = slipping(&estimator, slip_rad, 4);
            let probability = told(&estimator, &blocks, |problem| {
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

    /// The width of `C` against the determinants of all information with and without the change.
    #[test]
    fn what_a_change_narrows_is_what_the_determinants_differ_by() {
        let estimator = turntable();
        let blocks = slipping(&estimator, 5e-3, 4);
        let believed = (estimator.prior()).belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
        let problem = Problem::new(&estimator, &believed, Payload::Empty, &blocks).unwrap();
        let softer = Change {
            what: What::Compliance(0),
            at_s: problem.start_of(SLIPS_AT),
        };
        let slip = Change {
            what: What::Offset(0),
            ..softer
        };
        let with = problem.solve(&[slip, softer]).unwrap();
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
            .flat_map(|c| problem.deviations(c))
            .map(libm::log)
            .sum();
        let expected = ln_root(&without, kept) - ln_root(&with.information, total) - ln_prior;
        let narrowed = problem.ln_narrowed(&with, 0).unwrap();
        assert!((narrowed - expected).abs() < 1e-9, "{narrowed} {expected}");
        assert!(narrowed < -3.0, "{narrowed}");
    }

    #[test]
    fn the_moment_lies_in_its_interval_and_small_slips_have_wide_ones() {
        let estimator = turntable();
        let mut mean_width = [0.0, 0.0];
        for (slip_rad, width) in [0.6e-3, 3e-3].into_iter().zip(&mut mean_width) {
            const DRAWS: u64 = 20;
            let mut inside = 0;
            for draw in 0..DRAWS {
                let mut seed = 77 + draw;
                random(&mut seed);
                let blocks = slipping(&estimator, slip_rad, seed);
                let ([from_s, to_s], truth) = told(&estimator, &blocks, |problem| {
                    let certainty = of(&problem, &with_slip(&problem, SLIPS_AT));
                    (
                        certainty.between_s,
                        problem.start_of(SLIPS_AT) - estimator.delay_s(),
                    )
                });
                inside += u64::from(from_s <= truth && truth <= to_s);
                *width += (to_s - from_s) / DRAWS as f64;
            }
            assert!(inside >= DRAWS - 2, "{slip_rad}: {inside}");
        }
        let [small, large] = mean_width;
        let whole_s = 0.2 * BLOCKS as f64;
        assert!(large < small && small < 0.6 * whole_s, "{small} {large}");
    }
}
