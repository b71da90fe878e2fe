//! Ropes in order of their strain, with intervals.

use rand_distr::{Distribution, StudentT};

use super::analyze::{Analysis, Interval};
use super::record::Prepared;
use super::sample::quantile;
use super::scan::median;
use rand::SeedableRng;

/// One rope's place.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Rank {
    /// 1 stretches least. Ropes whose intervals overlap with the one before share its rank.
    pub rank: usize,
    /// Rope.
    pub name: String,
    /// Repeats.
    pub specimens: usize,
    /// Time at which strains are compared, s: the longest that all reach.
    pub at_s: f64,
    /// Strain then, %. From repeats where there are several; for one specimen the interval knows
    /// the scatter of its readings only, not that between specimens.
    pub strain_percent: Interval,
    /// Slope, %/h.
    pub slope_percent_per_h: Option<Interval>,
}

/// Ranks groups; specimens without a group (`all`) each count as a rope.
pub fn rank(
    prepared: &[Prepared],
    analyses: &[Analysis],
    groups: &[String],
    level: f64,
) -> Vec<Rank> {
    let at_s = analyses
        .iter()
        .map(|a| a.duration_s)
        .fold(f64::INFINITY, f64::min);
    let single = groups.iter().all(|g| g == "all");
    let mut ropes: Vec<(String, Vec<usize>)> = Vec::new();
    for i in 0..analyses.len() {
        let name = if single {
            &analyses[i].name
        } else {
            &groups[i]
        };
        match ropes.iter_mut().find(|(n, _)| n == name) {
            Some((_, members)) => members.push(i),
            None => ropes.push((name.clone(), vec![i])),
        }
    }
    let mut ranks: Vec<Rank> = ropes
        .into_iter()
        .map(|(name, members)| {
            let own: Vec<Interval> = members
                .iter()
                .map(|&i| strain_at(&prepared[i], at_s, level))
                .collect();
            let slopes: Vec<Interval> = members
                .iter()
                .filter_map(|&i| analyses[i].slope_percent_per_h)
                .collect();
            Rank {
                rank: 0,
                name,
                specimens: members.len(),
                at_s,
                strain_percent: pooled(&own, level),
                slope_percent_per_h: (!slopes.is_empty()).then(|| pooled(&slopes, level)),
            }
        })
        .collect();
    ranks.sort_by(|a, b| a.strain_percent.value.total_cmp(&b.strain_percent.value));
    for i in 0..ranks.len() {
        ranks[i].rank = if i > 0 && ranks[i].strain_percent.low <= ranks[i - 1].strain_percent.high
        {
            ranks[i - 1].rank
        } else {
            i + 1
        };
    }
    ranks
}

/// Strain at a time: straight line in the logarithm of time through the readings within a third
/// of a decade before and after, with the scatter about it.
fn strain_at(prepared: &Prepared, at_s: f64, level: f64) -> Interval {
    let start = prepared.stages.first().map_or(0.0, |s| s.start_s);
    let end = prepared.stages.first().map_or(f64::INFINITY, |s| s.end_s);
    let reach = 10.0_f64.powf(1.0 / 3.0);
    let (x, y): (Vec<f64>, Vec<f64>) = prepared
        .curve
        .time_s
        .iter()
        .zip(&prepared.curve.strain)
        .filter(|(t, _)| **t <= end + 1e-9)
        .map(|(t, e)| (t - start, 100.0 * e))
        .filter(|(t, _)| *t >= at_s / reach && *t <= at_s * reach)
        .map(|(t, e)| ((t / at_s).ln(), e))
        .unzip();
    if x.len() < 3 {
        let value = y.last().copied().unwrap_or(f64::NAN);
        return Interval {
            value,
            low: value,
            high: value,
        };
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
    let half = t_quantile(n - 2.0, level) * error;
    Interval {
        value,
        low: value - half,
        high: value + half,
    }
}

/// Mean of repeats with Student's interval of their scatter; a single one keeps its own.
fn pooled(own: &[Interval], level: f64) -> Interval {
    let n = own.len() as f64;
    if own.len() < 2 {
        return own.first().copied().unwrap_or(Interval {
            value: f64::NAN,
            low: f64::NAN,
            high: f64::NAN,
        });
    }
    let values: Vec<f64> = own.iter().map(|o| o.value).collect();
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // Three repeats may agree by chance: not better than one of them is known.
    let least = median(
        &own.iter()
            .map(|o| 0.5 * (o.high - o.low))
            .collect::<Vec<_>>(),
    ) / n.sqrt();
    let half = (t_quantile(n - 1.0, level) * (variance / n).sqrt()).max(least);
    Interval {
        value: mean,
        low: mean - half,
        high: mean + half,
    }
}

/// Two-sided quantile of Student's distribution from 40 000 draws with a fixed seed: within 3 %
/// for two degrees of freedom and more.
fn t_quantile(freedom: f64, level: f64) -> f64 {
    const DRAWS: usize = 40_000;
    let Ok(student) = StudentT::new(freedom) else {
        return f64::NAN;
    };
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut draws: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let t: f64 = student.sample(&mut random);
            t.abs()
        })
        .collect();
    draws.sort_by(f64::total_cmp);
    quantile(&draws, level)
}
