//! What the draws say of each group, and what may be claimed of all of them together.

use super::design::Design;
use super::factor::{Factor, GroupKey};
use crate::hierarchy::{Draws, median_and_95};
use sinew_model::statistics::quantile;

/// Probability that any of the claims is wrong, at most.
const WRONG: f64 = 0.05;

/// What can be told of a group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// It creeps more than the others.
    Worse,
    /// It creeps less than the others.
    Better,
    /// The tendons don't tell.
    CantTell,
    /// It can't be told from this, however many tendons there are.
    TiedTo(Vec<(Factor, String)>),
    /// There is no other to hold it against.
    Alone,
}

/// A group.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Which.
    pub key: GroupKey,
    /// Tendons.
    pub tendons: usize,
    /// Robots they are in.
    pub robots: usize,
    /// Creep per decade of a typical tendon, in the comparison's unit: median and 95 % interval; NaN where it is tied.
    pub creep: [f64; 3],
    /// Creep over that of the middle one of the others: median and 95 % interval; NaN where it is tied or alone.
    pub ratio: [f64; 3],
    /// Probability that it creeps more than they do, by more than was asked for.
    pub probability_worse: f64,
    /// What can be told.
    pub verdict: Verdict,
}

/// Judges every group.
///
/// * `least`: a smaller difference is none, as a ratio above 1.
pub(super) fn groups(design: &Design, draws: &Draws, least: f64) -> Vec<Group> {
    let margin = (1.0 + least).ln();
    let mut doubts: Vec<[f64; 2]> = Vec::new();
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
        // A draw more than there are, so that no doubt is none at all.
        let share = |wrong: &dyn Fn(f64) -> bool| {
            let count = apart.iter().filter(|d| wrong(**d)).count();
            (count as f64 + 1.0) / (apart.len() as f64 + 1.0)
        };
        let alone = others.is_empty();
        let told = !alone && group.tied_to.is_empty();
        let not_worse = share(&|d| !(d > margin));
        let not_better = share(&|d| !(d < -margin));
        doubts.push(if told {
            [not_worse, not_better]
        } else {
            [1.0; 2]
        });
        out.push(Group {
            key: group.key.clone(),
            tendons: group.tendons,
            robots: group.robots,
            creep: match alone || told {
                true => median_and_95(draws.coefficients.iter().map(level).collect()),
                false => [f64::NAN; 3],
            },
            ratio: match told {
                true => median_and_95(apart).map(f64::exp),
                false => [f64::NAN; 3],
            },
            probability_worse: if told { 1.0 - not_worse } else { f64::NAN },
            verdict: match (alone, told) {
                (true, _) => Verdict::Alone,
                (_, true) => Verdict::CantTell,
                _ => Verdict::TiedTo(group.tied_to.clone()),
            },
        });
    }
    if draws.have_come_together() {
        claim(&mut out, &doubts);
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

/// Claims the surest first, while the probabilities of being wrong add up to no more than [`WRONG`]: so probable is it at
/// most that any of the claims is wrong.
fn claim(groups: &mut [Group], doubts: &[[f64; 2]]) {
    let mut claims: Vec<(f64, usize, Verdict)> = Vec::new();
    for (g, [not_worse, not_better]) in doubts.iter().enumerate() {
        claims.push((*not_worse, g, Verdict::Worse));
        claims.push((*not_better, g, Verdict::Better));
    }
    claims.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    for (doubt, g, verdict) in claims {
        sum += doubt;
        if sum > WRONG {
            return;
        }
        groups[g].verdict = verdict;
    }
}
