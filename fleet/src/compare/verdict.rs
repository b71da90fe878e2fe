//! Verdict on each group from the posterior draws, with a bound on the error probability of all verdicts together.

use super::design::Design;
use super::factor::{Factor, GroupKey};
use crate::hierarchy::{Draws, median_and_95};
use sinew_model::statistics::quantile;

/// Maximum probability that any verdict is wrong.
const MAX_ERROR_PROBABILITY: f64 = 0.05;

/// Verdict on a group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// Creeps more than the other groups.
    Worse,
    /// Creeps less than the other groups.
    Better,
    /// No significant difference.
    Inconclusive,
    /// Confounded with the named factors and levels, independent of the number of tendons.
    TiedTo(Vec<(Factor, String)>),
    /// No other group to compare with.
    Alone,
}

/// Result of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Key of the group.
    pub key: GroupKey,
    /// Number of tendons.
    pub tendons: usize,
    /// Number of robots of the group.
    pub robots: usize,
    /// Creep per decade of a typical tendon, in the unit of the comparison: median and 95 % interval; NaN if confounded.
    pub creep: [f64; 3],
    /// Ratio of the creep to the median of the other groups: median and 95 % interval; NaN if the group is confounded
    /// or the only one.
    pub ratio: [f64; 3],
    /// Probability that the creep exceeds that of the others by more than the requested margin.
    pub probability_worse: f64,
    /// Verdict on the group.
    pub verdict: Verdict,
}

/// Evaluates every group.
///
/// * `least`: smallest relevant relative difference; 0.05 for 5 %.
pub(super) fn groups(design: &Design, draws: &Draws, least: f64) -> Vec<Group> {
    let margin = (1.0 + least).ln();
    let mut error_probabilities: Vec<[f64; 2]> = Vec::new();
    let mut out: Vec<Group> = Vec::new();
    for (g, group) in design.groups.iter().enumerate() {
        let column = design.first_group + g;
        let others: Vec<usize> = (design.groups.iter().enumerate())
            .filter(|(o, other)| *o != g && other.key.family == group.key.family)
            .map(|(o, _)| design.first_group + o)
            .collect();
        let middle = &design.middles[&group.key.family];
        let level = |b: &Vec<f64>| {
            let at: f64 = middle.iter().zip(b).map(|(x, b)| x * b).sum();
            (at + b[column]).exp()
        };
        let apart: Vec<f64> = (draws.coefficients.iter())
            .map(|b| {
                let mut rest: Vec<f64> = others.iter().map(|o| b[*o]).collect();
                rest.sort_by(f64::total_cmp);
                b[column] - quantile(&rest, 0.5)
            })
            .collect();
        // One more draw than there are keeps the probability above 0.
        let share = |wrong: &dyn Fn(f64) -> bool| {
            let count = apart.iter().filter(|d| wrong(**d)).count();
            (count as f64 + 1.0) / (apart.len() as f64 + 1.0)
        };
        let alone = others.is_empty();
        let is_comparable = !alone && group.tied_to.is_empty();
        let not_worse = share(&|d| !(d > margin));
        let not_better = share(&|d| !(d < -margin));
        error_probabilities.push(if is_comparable {
            [not_worse, not_better]
        } else {
            [1.0; 2]
        });
        out.push(Group {
            key: group.key.clone(),
            tendons: group.tendons,
            robots: group.robots,
            creep: match alone || is_comparable {
                true => median_and_95(draws.coefficients.iter().map(level).collect()),
                false => [f64::NAN; 3],
            },
            ratio: match is_comparable {
                true => median_and_95(apart).map(f64::exp),
                false => [f64::NAN; 3],
            },
            probability_worse: if is_comparable {
                1.0 - not_worse
            } else {
                f64::NAN
            },
            verdict: match (alone, is_comparable) {
                (true, _) => Verdict::Alone,
                (_, true) => Verdict::Inconclusive,
                _ => Verdict::TiedTo(group.tied_to.clone()),
            },
        });
    }
    if draws.have_converged() {
        claim(&mut out, &error_probabilities);
    }
    out.sort_by(|a, b| {
        let family = a.key.family.cmp(&b.key.family);
        // What has no ratio comes last.
        let order = |g: &Group| {
            if g.ratio[0].is_nan() {
                f64::NEG_INFINITY
            } else {
                g.ratio[0]
            }
        };
        family.then(order(b).total_cmp(&order(a)))
    });
    out
}

/// Assigns verdicts in the order of their error probabilities, while their sum is at most
/// [`MAX_ERROR_PROBABILITY`]. The sum bounds the probability that any verdict is wrong.
fn claim(groups: &mut [Group], error_probabilities: &[[f64; 2]]) {
    let mut claims: Vec<(f64, usize, Verdict)> = Vec::new();
    for (g, [not_worse, not_better]) in error_probabilities.iter().enumerate() {
        claims.push((*not_worse, g, Verdict::Worse));
        claims.push((*not_better, g, Verdict::Better));
    }
    claims.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    for (probability, g, verdict) in claims {
        sum += probability;
        if sum > MAX_ERROR_PROBABILITY {
            return;
        }
        groups[g].verdict = verdict;
    }
}
