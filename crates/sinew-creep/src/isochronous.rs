//! Isochronous stress–strain points: strain of specimens under different loads at the same times.

use super::analyze::Analysis;
use super::scatter::by_group;
use super::student::student_quantile;
use serde::{Deserialize, Serialize};
use sinew_model::Bounded;

/// Specimens of one group at one time under load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Isochrone {
    /// Name of the group; `None` for specimens without a group.
    pub group: Option<String>,
    /// Time under the full load, s.
    pub time_s: f64,
    /// Quantity of the loads.
    pub quantity: LoadQuantity,
    /// Specimens by increasing load.
    pub points: Vec<IsochronePoint>,
    /// Load over strain at the middle of the loads, N or Pa: secant of the curve.
    pub secant: f64,
    /// Exponent `p` of `ε ∝ σ^p`: 1 if strain is proportional to load.
    pub exponent: Bounded,
}

/// Quantity by which loads are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum LoadQuantity {
    /// Forces in newtons.
    Force,
    /// Stresses in Pa: every specimen's cross-section is known.
    Stress,
}

/// Specimen of an isochrone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IsochronePoint {
    /// Name of the specimen.
    pub specimen: String,
    /// Load of the specimen, N or Pa.
    pub load: f64,
    /// Strain at that time, m/m.
    pub strain_ratio: f64,
}

/// Minimum number of specimens of a curve.
const MIN_SPECIMENS: usize = 3;
/// Minimum ratio of the largest to the smallest load.
const MIN_LOAD_RATIO: f64 = 1.2;

/// Isochrones of every group with at least three specimens at loads that differ by a fifth, at the
/// standard times of ISO 899-1 within their duration.
///
/// `ln ε = a + p ln σ` by least squares; specimens with a strain that is not positive are excluded.
pub fn isochrones(analyses: &[Analysis], level: f64) -> Vec<Isochrone> {
    let mut found = Vec::new();
    for (group, members) in by_group(analyses) {
        let quantity = if members.iter().all(|a| a.stress_pa.is_some()) {
            LoadQuantity::Stress
        } else {
            LoadQuantity::Force
        };
        let mut times: Vec<f64> = members
            .iter()
            .flat_map(|a| a.readings.iter().map(|r| r.time_s))
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        for time_s in times {
            found.extend(isochrone(group, &members, quantity, time_s, level));
        }
    }
    found
}

fn isochrone(
    group: Option<&str>,
    members: &[&Analysis],
    quantity: LoadQuantity,
    time_s: f64,
    level: f64,
) -> Option<Isochrone> {
    let mut points: Vec<IsochronePoint> = members
        .iter()
        .filter_map(|a| {
            let load = match quantity {
                LoadQuantity::Stress => a.stress_pa,
                LoadQuantity::Force => a.force_n,
            }?;
            let reading = a.readings.iter().find(|r| r.time_s == time_s)?;
            (load > 0.0 && reading.strain_ratio > 0.0).then(|| IsochronePoint {
                specimen: a.name.clone(),
                load,
                strain_ratio: reading.strain_ratio,
            })
        })
        .collect();
    points.sort_by(|a, b| a.load.total_cmp(&b.load));
    let (first, last) = (points.first()?.load, points.last()?.load);
    if points.len() < MIN_SPECIMENS || last < MIN_LOAD_RATIO * first {
        return None;
    }
    let n = points.len() as f64;
    // In MPa or N, and %: only differences of logarithms matter.
    let unit = match quantity {
        LoadQuantity::Stress => 1e-6,
        LoadQuantity::Force => 1.0,
    };
    let (x, y): (Vec<f64>, Vec<f64>) = points
        .iter()
        .map(|p| ((unit * p.load).ln(), (100.0 * p.strain_ratio).ln()))
        .unzip();
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let xy: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let p = xy / xx;
    let squares = |(x, y): (&f64, &f64)| (y - my - p * (x - mx)).powi(2);
    let left: f64 = x.iter().zip(&y).map(squares).sum();
    let half = student_quantile(n - 2.0, level) * (left / (n - 2.0) / xx).sqrt();
    Some(Isochrone {
        group: group.map(str::to_owned),
        time_s,
        quantity,
        points,
        secant: 100.0 / unit * (mx - my).exp(),
        exponent: Bounded::even(p, half),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_file::{Specimen, TestQuantity};
    use crate::{AnalyzeOptions, PrepareOptions, analyze, prepare};

    #[test]
    fn load_exponent_is_recovered() {
        // ε = 1e-4 σ^1.4 (1 + ln(1 + t/60)), σ = F/2 mm²; no noise, so exact except for rounding.
        let analyses: Vec<Analysis> = [20.0, 40.0, 60.0, 90.0]
            .into_iter()
            .map(|force: f64| {
                let time: Vec<f64> = (0..=1000).map(|i| 4.0 * f64::from(i)).collect();
                let size = 1e-4 * (force / 2.0).powf(1.4);
                let strain = time
                    .iter()
                    .map(|t| size * (1.0 + (t / 60.0).ln_1p()))
                    .collect();
                let mut specimen = Specimen::default();
                specimen.name = format!("{force} N");
                specimen.set_column(TestQuantity::Force, vec![force; time.len()]);
                specimen.set_column(TestQuantity::Strain, strain);
                specimen.set_column(TestQuantity::Time, time);
                let options = PrepareOptions {
                    area_m2: Some(2e-6),
                    ..PrepareOptions::default()
                };
                let prepared = prepare(&specimen, &options).unwrap();
                analyze(&prepared, &AnalyzeOptions::default()).unwrap()
            })
            .collect();
        let found = isochrones(&analyses, 0.95);
        // 1, 3, 6, 12, 30 min and 1 h.
        assert_eq!(found.len(), 6);
        for curve in &found {
            assert_eq!(curve.quantity, LoadQuantity::Stress);
            assert_eq!(curve.points.len(), 4);
            assert!((curve.exponent.value - 1.4).abs() < 1e-3, "{curve:?}");
        }
        let same = vec![analyses[0].clone(); 4];
        assert!(isochrones(&same, 0.95).is_empty());
    }
}
