//! Observations of the model: logarithm of the creep of each tendon, its variance, and the usual scatter of its kind.

use super::CreepUnit;
use super::factor::{Factor, level, numbered};
use crate::gather::CreepingTendon;
use sinew_model::statistics::quantile;
use std::collections::BTreeMap;

/// Limit of the deviation from the median of a kind, in units of its usual scatter; larger deviations are clipped.
const MAX_DEVIATION: f64 = 3.5;
/// Prior weight of the mean of all kinds for kinds of few tendons, as a number of tendons.
const SHRINKAGE_TENDONS: f64 = 10.0;

/// Logarithm of the creep per decade of each tendon, and its variance.
///
/// `c = e^z` has the standard deviation `s`. For `c > 2 s`, `z = ln c` with standard deviation `s/c`. Otherwise `e^z` is
/// linearised at `z₀`, the most probable `z` with the usual value of its kind as prior: `z₀ + (c − e^z₀) e^−z₀` with standard
/// deviation `s e^−z₀`. A tendon with unknown or no creep therefore has little weight.
pub(super) fn logarithms(
    tendons: &[&CreepingTendon],
    kinds: &[usize],
) -> (Vec<(f64, f64)>, CreepUnit) {
    let unit = match tendons.iter().all(|t| t.strain_per_rad.is_some()) {
        true => CreepUnit::Strain,
        false => CreepUnit::Offset,
    };
    let creeps: Vec<(f64, f64)> = (tendons.iter())
        .map(|t| {
            let factor = match unit {
                CreepUnit::Strain => t.strain_per_rad.unwrap_or(1.0),
                CreepUnit::Offset => 1.0,
            };
            (factor * t.creep.per_decade_rad, factor * t.creep.std_rad)
        })
        .collect();
    let mut by_kind: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (&(c, s), &kind) in creeps.iter().zip(kinds) {
        by_kind.entry(kind).or_default().push(c.max(s).ln());
    }
    let mut usual = BTreeMap::new();
    for (kind, mut logs) in by_kind {
        logs.sort_by(f64::total_cmp);
        let half_width = 0.5 * (quantile(&logs, 0.84) - quantile(&logs, 0.16));
        usual.insert(kind, (quantile(&logs, 0.5), half_width.max(0.3)));
    }
    let values = creeps.iter().zip(kinds);
    let values = values.map(|(&(c, s), kind)| {
        let (middle, width) = usual[kind];
        let at = match c > 2.0 * s {
            true => c.ln(),
            false => most_probable(c, s, middle, width),
        };
        let slope = (-at).exp();
        (at + (c - at.exp()) * slope, (s * slope).powi(2))
    });
    (values.collect(), unit)
}

/// Values clipped to [`MAX_DEVIATION`] times the usual scatter around the median of their kind, so that an outlier does not
/// determine its group.
pub(super) fn drawn_in(values: &[f64], kinds: &[usize]) -> Vec<f64> {
    let mut by_kind: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (value, kind) in values.iter().zip(kinds) {
        by_kind.entry(*kind).or_default().push(*value);
    }
    for of in by_kind.values_mut() {
        of.sort_by(f64::total_cmp);
    }
    let widths = widths(values, kinds);
    let one = |((value, kind), width): ((&f64, &usize), f64)| {
        let middle = quantile(&by_kind[kind], 0.5);
        value.clamp(
            middle - MAX_DEVIATION * width,
            middle + MAX_DEVIATION * width,
        )
    };
    values.iter().zip(kinds).zip(widths).map(one).collect()
}

/// Standard deviation of the kind of each tendon relative to that of all, within kind, site and batch. Kinds of few tendons
/// are shrunk towards the value of all.
pub(super) fn spreads(values: &[f64], kinds: &[usize], tendons: &[&CreepingTendon]) -> Vec<f64> {
    let mut cells: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for ((value, kind), tendon) in values.iter().zip(kinds).zip(tendons) {
        let cell = (*kind, &tendon.site, &tendon.fit.batch);
        cells.entry(cell).or_default().push(*value);
    }
    // Of each kind the sum of squares about the means of its cells, and its degrees of freedom.
    let mut sums: BTreeMap<usize, [f64; 2]> = kinds.iter().map(|k| (*k, [0.0; 2])).collect();
    for ((kind, ..), of) in cells {
        let n = of.len() as f64;
        let mean = of.iter().sum::<f64>() / n;
        let [squares, freedom] = sums.entry(kind).or_default();
        *squares += of.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        *freedom += n - 1.0;
    }
    let all = sums
        .values()
        .fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    let mean = all[0] / all[1];
    let of = |kind: &usize| match mean > 0.0 {
        true => ((sums[kind][0] / mean + SHRINKAGE_TENDONS) / (sums[kind][1] + SHRINKAGE_TENDONS))
            .sqrt(),
        false => 1.0,
    };
    kinds.iter().map(of).collect()
}

/// Usual deviation of the kind of each tendon, without measurement errors.
///
/// * `departures`: deviation of each tendon, and the variance of its measurement.
pub(crate) fn usual_widths(departures: &[(f64, f64)], tendons: &[CreepingTendon]) -> Vec<f64> {
    let names: Vec<String> = tendons.iter().map(|t| level(t, Factor::Kind)).collect();
    let numbers = numbered(names.iter().cloned());
    let kinds: Vec<usize> = names.iter().map(|n| numbers[n]).collect();
    let alone: Vec<f64> = departures.iter().map(|d| d.0).collect();
    let mut variances: Vec<f64> = departures.iter().map(|d| d.1).collect();
    variances.sort_by(f64::total_cmp);
    let measured = quantile(&variances, 0.5);
    // The width without measurement errors is at least half of the total.
    let own = |w: f64| (w * w - measured).max(0.25 * w * w).sqrt();
    widths(&alone, &kinds).into_iter().map(own).collect()
}

/// Half of the central 68 % range of the kind of each value. Kinds of few tendons are shrunk towards the mean of all
/// with the weight of ten tendons.
fn widths(values: &[f64], kinds: &[usize]) -> Vec<f64> {
    let mut by_kind: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (value, kind) in values.iter().zip(kinds) {
        by_kind.entry(*kind).or_default().push(*value);
    }
    let squares: BTreeMap<usize, (f64, f64)> = (by_kind.into_iter())
        .map(|(kind, mut of)| {
            of.sort_by(f64::total_cmp);
            let half = 0.5 * (quantile(&of, 0.84) - quantile(&of, 0.16));
            (kind, (half * half, of.len() as f64))
        })
        .collect();
    let all: f64 = squares.values().map(|(square, n)| square * n).sum();
    let mean = all / values.len().max(1) as f64;
    let of = |kind: &usize| {
        let (square, n) = squares[kind];
        ((square * n + mean * SHRINKAGE_TENDONS) / (n + SHRINKAGE_TENDONS)).sqrt()
    };
    kinds.iter().map(of).collect()
}

/// The most probable `z` where `e^z` is `c ± s` and `z` is `middle ± width` before: Newton's method on a sum of two squares,
/// each step no longer than 1.
fn most_probable(c: f64, s: f64, middle: f64, width: f64) -> f64 {
    let mut z = middle;
    for _ in 0..60 {
        let e = z.exp();
        let slope = (e - c) * e / (s * s) + (z - middle) / (width * width);
        let curvature = e * e / (s * s) + 1.0 / (width * width);
        let step = (slope / curvature).clamp(-1.0, 1.0);
        z -= step;
        if step.abs() < 1e-10 {
            break;
        }
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_precise_creep_is_logarithm() {
        let z = most_probable(5.0, 0.01, 0.0, 1.0);
        assert!((z - 5.0_f64.ln()).abs() < 1e-4, "{z}");
    }

    #[test]
    fn logarithms_imprecise_creep_stays_near_kind() {
        let z = most_probable(-3.0, 50.0, 1.0, 0.8);
        assert!((z - 1.0).abs() < 0.05, "{z}");
        // None at all, and known well: far below, yet a number.
        let none = most_probable(0.0, 0.1, 1.0, 0.8);
        assert!((-4.0..-1.0).contains(&none), "{none}");
    }
}
