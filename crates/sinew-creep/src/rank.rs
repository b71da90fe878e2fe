//! Ranking of ropes by their strain, with intervals.

use super::analyze::Analysis;
use super::artefacts::median;
use super::record::Prepared;
use super::student::{normal_quantile, student_quantile};
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// Assumed standard deviation between specimens, as a share of the value, if no rope of the
/// comparison has repeats. It cannot be estimated from one specimen.
pub const SCATTER_GUESS: f64 = 0.10;

/// Source of the scatter between specimens of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ScatterSource {
    /// Repeats of the rope itself.
    Repeats,
    /// Pooled repeats of the other ropes in the comparison.
    OtherRopes,
    /// Specified by the user.
    Stated,
    /// Assumed value ([`SCATTER_GUESS`]).
    Assumed,
}

/// Rank of one rope.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rank {
    /// One plus the number of ropes whose interval lies completely below; 1 if no rope has a
    /// significantly smaller strain.
    pub rank: usize,
    /// Name of the rope.
    pub name: String,
    /// Number of repeats.
    pub specimens: usize,
    /// Time at which strains are compared, s: the longest that all records reach.
    pub at_s: f64,
    /// Strain at that time, m/m, with the interval of the rope's mean.
    pub strain_ratio: Bounded,
    /// Slope of the strain, 1/s.
    pub slope_per_s: Option<Bounded>,
    /// Standard deviation between specimens on which the intervals are based, over the strain.
    pub scatter_share: f64,
    /// Source of that scatter.
    pub scatter_source: ScatterSource,
}

/// Ranks groups; without groups each specimen counts as a rope.
///
/// `scatter`: standard deviation between specimens as a share of the value, for ropes with a single
/// specimen; `None` for that of the other ropes' repeats, otherwise [`SCATTER_GUESS`].
pub fn rank(
    prepared: &[Prepared],
    analyses: &[Analysis],
    level: f64,
    scatter: Option<f64>,
) -> Vec<Rank> {
    let at_s = analyses
        .iter()
        .map(|a| a.duration_s)
        .fold(f64::INFINITY, f64::min);
    let single = analyses.iter().all(|a| a.group.is_none());
    let mut ropes: Vec<(String, Vec<usize>)> = Vec::new();
    for i in 0..analyses.len() {
        let name = match &analyses[i].group {
            Some(group) => group,
            None if single => &analyses[i].name,
            None => "all",
        };
        match ropes.iter_mut().find(|(n, _)| n == name) {
            Some((_, members)) => members.push(i),
            None => ropes.push((name.to_owned(), vec![i])),
        }
    }
    let strains: Vec<Vec<Bounded>> = ropes
        .iter()
        .map(|(_, members)| {
            let at = |&i: &usize| strain_at(&prepared[i], at_s, level);
            members.iter().map(at).collect()
        })
        .collect();
    let slopes: Vec<Vec<Bounded>> = ropes
        .iter()
        .map(|(_, members)| {
            let of = |&i: &usize| analyses[i].slope_per_s;
            members.iter().filter_map(of).collect()
        })
        .collect();
    let (of_strain, of_slope) = (Prior::of(&strains, scatter), Prior::of(&slopes, scatter));
    let mut ranks: Vec<Rank> = ropes
        .into_iter()
        .enumerate()
        .map(|(i, (name, members))| {
            let (strain_ratio, scatter_share, scatter_source) =
                of_strain.pooled(&strains[i], level);
            Rank {
                rank: 0,
                name,
                specimens: members.len(),
                at_s,
                strain_ratio,
                slope_per_s: (!slopes[i].is_empty()).then(|| of_slope.pooled(&slopes[i], level).0),
                scatter_share,
                scatter_source,
            }
        })
        .collect();
    ranks.sort_by(|a, b| a.strain_ratio.value.total_cmp(&b.strain_ratio.value));
    number(&mut ranks);
    ranks
}

/// Assigns the ranks: one plus the number of intervals that lie completely below.
fn number(ranks: &mut [Rank]) {
    let highs: Vec<f64> = ranks.iter().map(|r| r.strain_ratio.high).collect();
    for rank in ranks {
        let below = highs.iter().filter(|high| **high < rank.strain_ratio.low);
        rank.rank = 1 + below.count();
    }
}

/// Strain at a time: straight line over the logarithm of time through the measurements within a
/// third of a decade before and after, with the scatter about it.
fn strain_at(prepared: &Prepared, at_s: f64, level: f64) -> Bounded {
    let start = prepared.stages.first().map_or(0.0, |s| s.start_s);
    let end = prepared.stages.first().map_or(f64::INFINITY, |s| s.end_s);
    let reach = 10.0_f64.powf(1.0 / 3.0);
    let (x, y): (Vec<f64>, Vec<f64>) = prepared
        .curve
        .time_s
        .iter()
        .zip(&prepared.curve.strain)
        .filter(|(t, _)| **t <= end + 1e-9)
        .map(|(t, e)| (t - start, *e))
        .filter(|(t, _)| *t >= at_s / reach && *t <= at_s * reach)
        .map(|(t, e)| ((t / at_s).ln(), e))
        .unzip();
    if x.len() < 3 {
        let value = y.last().copied().unwrap_or(f64::NAN);
        return Bounded::even(value, 0.0);
    }
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let xy: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let slope = xy / xx;
    let value = my - slope * mx;
    let left: f64 = x
        .iter()
        .zip(&y)
        .map(|(x, y)| (y - value - slope * x).powi(2))
        .sum();
    let error = (left / (n - 2.0) * (1.0 / n + mx * mx / xx)).sqrt();
    let half = student_quantile(n - 2.0, level) * error;
    Bounded::even(value, half)
}

/// Scatter between specimens without the repeats of the rope itself.
struct Prior {
    /// Standard deviation as a share of the value.
    share: f64,
    /// Degrees of freedom; infinite if specified or assumed.
    freedom: f64,
    source: ScatterSource,
}

impl Prior {
    fn of(ropes: &[Vec<Bounded>], stated: Option<f64>) -> Self {
        if let Some(share) = stated {
            return Self {
                share,
                freedom: f64::INFINITY,
                source: ScatterSource::Stated,
            };
        }
        let (mut squares, mut freedom) = (0.0, 0.0);
        for own in ropes.iter().filter(|own| own.len() > 1) {
            let (mean, variance) = moments(own);
            let n = own.len() as f64;
            if mean.abs() > 0.0 {
                squares += (n - 1.0) * variance / (mean * mean);
                freedom += n - 1.0;
            }
        }
        if freedom > 0.0 && squares > 0.0 {
            return Self {
                share: (squares / freedom).sqrt(),
                freedom,
                source: ScatterSource::OtherRopes,
            };
        }
        Self {
            share: SCATTER_GUESS,
            freedom: f64::INFINITY,
            source: ScatterSource::Assumed,
        }
    }

    /// Mean of repeats with Student's interval of their scatter; for a single specimen the prior
    /// scatter combined with that of its measurements.
    fn pooled(&self, own: &[Bounded], level: f64) -> (Bounded, f64, ScatterSource) {
        let readings = median(
            &own.iter()
                .map(|o| 0.5 * (o.high - o.low))
                .collect::<Vec<_>>(),
        );
        let (mean, variance) = moments(own);
        let n = own.len() as f64;
        let (half, share, source) = if own.len() < 2 {
            let quantile = if self.freedom.is_finite() {
                student_quantile(self.freedom, level)
            } else {
                normal_quantile(0.5 + 0.5 * level)
            };
            let between = quantile * self.share * mean.abs();
            (between.hypot(readings), self.share, self.source)
        } else {
            let between = student_quantile(n - 1.0, level) * (variance / n).sqrt();
            // Three repeats may agree by chance: lower bound by the error of one of them.
            let half = between.max(readings / n.sqrt());
            (half, variance.sqrt() / mean.abs(), ScatterSource::Repeats)
        };
        (Bounded::even(mean, half), share, source)
    }
}

/// Mean and variance of the values.
fn moments(own: &[Bounded]) -> (f64, f64) {
    let n = own.len() as f64;
    let mean = own.iter().map(|o| o.value).sum::<f64>() / n;
    let squares: f64 = own.iter().map(|o| (o.value - mean).powi(2)).sum();
    (mean, squares / (n - 1.0).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(value: f64) -> Bounded {
        Bounded::even(value, 0.0)
    }

    #[test]
    fn rank_counts_ropes_with_smaller_strain() {
        let rank = |low: f64, high: f64| Rank {
            rank: 0,
            name: String::new(),
            specimens: 1,
            at_s: 1.0,
            strain_ratio: Bounded {
                value: 0.5 * (low + high),
                low,
                high,
            },
            slope_per_s: None,
            scatter_share: 0.0,
            scatter_source: ScatterSource::Stated,
        };
        let numbers = |mut ranks: Vec<Rank>| {
            number(&mut ranks);
            ranks.iter().map(|r| r.rank).collect::<Vec<_>>()
        };
        // A chain: the first and the last are separate although each overlaps its neighbour.
        assert_eq!(
            numbers(vec![rank(1.0, 2.0), rank(1.8, 3.0), rank(2.5, 4.0)]),
            [1, 1, 2]
        );
        // A wide interval in front: the last overlaps it, and lies above the narrow one.
        assert_eq!(
            numbers(vec![rank(0.0, 5.0), rank(2.6, 2.7), rank(3.0, 4.0)]),
            [1, 1, 2]
        );
    }

    #[test]
    fn single_specimen_uses_pooled_scatter() {
        // Two ropes with repeats that scatter by 10 % about 1 and 5 % about 2.
        let ropes = [
            vec![exact(0.9), exact(1.0), exact(1.1)],
            vec![exact(1.9), exact(2.0), exact(2.1)],
            vec![exact(3.0)],
        ];
        let prior = Prior::of(&ropes, None);
        // √((2·0.01 + 2·0.0025)/4), four degrees of freedom.
        assert!((prior.share - 0.00625_f64.sqrt()).abs() < 1e-12);
        let (interval, _, source) = prior.pooled(&ropes[2], 0.95);
        assert_eq!(source, ScatterSource::OtherRopes);
        let half = 2.776_4 * prior.share * 3.0;
        assert!((interval.high - 3.0 - half).abs() < 1e-3, "{interval:?}");
        let (own, share, source) = prior.pooled(&ropes[0], 0.95);
        assert_eq!(source, ScatterSource::Repeats);
        assert!((share - 0.1).abs() < 1e-12);
        assert!((own.high - 1.0 - 4.302_7 * 0.1 / 3.0_f64.sqrt()).abs() < 1e-3);
    }

    #[test]
    fn assumed_scatter_applies_without_repeats() {
        let ropes = [vec![exact(1.0)], vec![exact(1.1)]];
        let guess = Prior::of(&ropes, None);
        let (interval, share, source) = guess.pooled(&ropes[0], 0.95);
        assert_eq!((share, source), (SCATTER_GUESS, ScatterSource::Assumed));
        assert!((interval.high - 1.196).abs() < 1e-4, "{interval:?}");
        let stated = Prior::of(&ropes, Some(0.02));
        assert_eq!(stated.pooled(&ropes[0], 0.95).2, ScatterSource::Stated);
    }
}
