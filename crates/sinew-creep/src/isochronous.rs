//! Isochronous stress–strain points: strain of specimens under different loads at the same times.

use super::analyze::{Analysis, Interval};
use super::page_tables::duration;
use super::student::student_quantile;
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};

/// Specimens of one group at one time under load.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Isochrone {
    /// Group.
    pub group: String,
    /// Time under the whole load, s.
    pub time_s: f64,
    /// Specimen, load (MPa with a cross-section, else N) and strain (%), by rising load.
    pub points: Vec<(String, f64, f64)>,
    /// Whether loads are stresses.
    pub stress: bool,
    /// Load over strain at the middle of the loads, per %: the curve's secant.
    pub secant: f64,
    /// `p` of `ε ∝ σ^p`: 1 where strain is proportional to load, with its interval.
    pub exponent: Interval,
}

/// Fewest specimens of a curve.
const FEWEST: usize = 3;
/// Loads must differ by this factor.
const APART: f64 = 1.2;

/// Isochrones of every group with at least three specimens at loads that differ by a fifth, at
/// the reading times of ISO 899-1 that they reach.
///
/// `ln ε = a + p ln σ` by least squares; specimens with a strain that isn't positive are left out.
pub fn isochrones(analyses: &[(String, &Analysis)], level: f64) -> Vec<Isochrone> {
    let mut groups: Vec<&str> = Vec::new();
    for (group, _) in analyses {
        if !groups.contains(&group.as_str()) {
            groups.push(group);
        }
    }
    let mut found = Vec::new();
    for group in groups {
        let own: Vec<&Analysis> = analyses
            .iter()
            .filter(|(g, _)| g == group)
            .map(|(_, a)| *a)
            .collect();
        let stress = own.iter().all(|a| a.stress_mpa.is_some());
        let mut times: Vec<f64> = own
            .iter()
            .flat_map(|a| a.readings.iter().map(|r| r.time_s))
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        for time_s in times {
            found.extend(isochrone(group, &own, stress, time_s, level));
        }
    }
    found
}

fn isochrone(
    group: &str,
    members: &[&Analysis],
    stress: bool,
    time_s: f64,
    level: f64,
) -> Option<Isochrone> {
    let mut points: Vec<(String, f64, f64)> = members
        .iter()
        .filter_map(|a| {
            let load = if stress { a.stress_mpa } else { a.force_n }?;
            let reading = a.readings.iter().find(|r| r.time_s == time_s)?;
            (load > 0.0 && reading.strain_percent > 0.0)
                .then(|| (a.name.clone(), load, reading.strain_percent))
        })
        .collect();
    points.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (first, last) = (points.first()?.1, points.last()?.1);
    if points.len() < FEWEST || last < APART * first {
        return None;
    }
    let n = points.len() as f64;
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.1.ln(), p.2.ln())).unzip();
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xx: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let xy: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    let p = xy / xx;
    let squares = |(x, y): (&f64, &f64)| (y - my - p * (x - mx)).powi(2);
    let left: f64 = x.iter().zip(&y).map(squares).sum();
    let half = student_quantile(n - 2.0, level) * (left / (n - 2.0) / xx).sqrt();
    Some(Isochrone {
        group: group.to_owned(),
        time_s,
        points,
        stress,
        secant: (mx - my).exp(),
        exponent: Interval {
            value: p,
            low: p - half,
            high: p + half,
        },
    })
}

/// Isochronous curves of up to six groups, a panel each: points joined, the power law dashed.
pub fn isochronous_figure(isochrones: &[Isochrone]) -> Option<Figure> {
    /// Groups beyond which panels are too small.
    const PANELS: usize = 6;
    /// Curves of a panel.
    const CURVES: usize = 4;
    let mut groups: Vec<&str> = isochrones.iter().map(|i| i.group.as_str()).collect();
    groups.dedup();
    if groups.is_empty() || groups.len() > PANELS {
        return None;
    }
    let columns = groups.len().min(2);
    let rows = groups.len().div_ceil(columns);
    let mut figure = Figure::new("")
        .size(820.0, 360.0 * rows as f64)
        .columns(columns);
    for group in groups {
        let own: Vec<&Isochrone> = isochrones.iter().filter(|i| i.group == group).collect();
        let load = if own[0].stress {
            "stress (MPa)"
        } else {
            "load (N)"
        };
        let title = if group == "all" { "" } else { group };
        let mut panel = Panel::new(title, "strain (%)", load);
        let every = own.len().div_ceil(CURVES);
        for (k, curve) in own.iter().step_by(every).enumerate() {
            let colour = Colour::CYCLE[k % Colour::CYCLE.len()];
            let mut points: Vec<(f64, f64)> = curve.points.iter().map(|p| (p.2, p.1)).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
            panel = panel.line(Line::new(duration(curve.time_s), x, y).colour(colour));
            let (x, y) = curve.power_law();
            panel = panel.line(
                Line::new("", x, y)
                    .colour(colour)
                    .dash(Dash::Dashed)
                    .width(1.0),
            );
        }
        figure = figure.panel(panel);
    }
    Some(figure)
}

impl Isochrone {
    /// The fitted power law over the loads: strain, %, and load.
    fn power_law(&self) -> (Vec<f64>, Vec<f64>) {
        const POINTS: i32 = 30;
        let (low, high) = (self.points[0].1, self.points[self.points.len() - 1].1);
        let middle = self.points.iter().map(|p| p.1.ln()).sum::<f64>() / self.points.len() as f64;
        // The secant is the load over the strain at the middle.
        let strain = middle.exp() / self.secant;
        (0..=POINTS)
            .map(|i| {
                let load = low * (high / low).powf(f64::from(i) / f64::from(POINTS));
                (
                    strain * (load / middle.exp()).powf(self.exponent.value),
                    load,
                )
            })
            .unzip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyzeOptions, PrepareOptions, analyze, prepare};
    use sinew_log::{Specimen, TestQuantity};

    #[test]
    fn the_exponent_of_the_load_comes_back() {
        // ε = 1e-4 σ^1.4 (1 + ln(1 + t/60)), σ = F/2 mm²; no noise, so to rounding.
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
        let named: Vec<(String, &Analysis)> = analyses.iter().map(|a| ("g".into(), a)).collect();
        let found = isochrones(&named, 0.95);
        // 1, 3, 6, 12, 30 min and 1 h.
        assert_eq!(found.len(), 6);
        for curve in &found {
            assert!(curve.stress && curve.points.len() == 4);
            assert!((curve.exponent.value - 1.4).abs() < 1e-3, "{curve:?}");
        }
        let same = vec![("g".to_owned(), &analyses[0]); 4];
        assert!(isochrones(&same, 0.95).is_empty());
    }
}
