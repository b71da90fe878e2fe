//! Creep curves with slopes in the legend, as in Figs. 1 and 2 of the paper.

use super::messages::short;
use super::specimen::answer;
use sinew_creep::{Analysis, Curve, Forecast, PERCENT_PER_H, SLOPE_FROM_S, Tests};
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel};

/// Maximum number of curves with a legend entry.
const MAX_LEGEND: usize = 12;

/// Curve of a creep test in a figure.
#[derive(Debug, Clone)]
pub struct Plotted<'a> {
    /// Name in the legend.
    pub name: String,
    /// Measurements of the test.
    pub curve: &'a Curve,
    /// Analysis of the test; gives the slope in the legend.
    pub analysis: &'a Analysis,
    /// Strain of a fitted law at the times of the measurements.
    pub fitted: Option<Vec<f64>>,
    /// Forecast of the strain.
    pub forecast: Option<Forecast>,
}

/// Returns the curves of all tests with their analyses.
pub fn plotted(tests: &Tests) -> Vec<Plotted<'_>> {
    let pairs = tests.prepared.iter().zip(&tests.analyses);
    pairs
        .map(|(prepared, analysis)| Plotted {
            name: prepared.name.clone(),
            curve: &prepared.curve,
            analysis,
            fitted: None,
            forecast: None,
        })
        .collect()
}

/// Plots strain over time, or over the decadic logarithm of time if `logarithmic`.
pub fn figure(title: &str, plotted: &[Plotted<'_>], logarithmic: bool) -> Figure {
    let longest = plotted
        .iter()
        .filter_map(|p| {
            let end = p.forecast.as_ref().and_then(|f| f.time_s.last());
            end.or(p.curve.time_s.last())
        })
        .fold(0.0_f64, |m, t| m.max(*t));
    let (unit, seconds) = match longest {
        t if t > 5.0 * 86_400.0 => ("d", 86_400.0),
        t if t > 3.0 * 3600.0 => ("h", 3600.0),
        t if t > 600.0 => ("min", 60.0),
        _ => ("s", 1.0),
    };
    let label = if logarithmic {
        "time".to_owned()
    } else {
        format!("time ({unit})")
    };
    let position = |t: f64| {
        if logarithmic { t.log10() } else { t / seconds }
    };
    // A logarithm starts at the first positive time.
    let line = |name: &str, time_s: &[f64], strain: &[f64]| {
        let points = time_s.iter().zip(strain);
        let (time, strain) = points
            .filter(|(t, _)| !logarithmic || **t > 0.0)
            .map(|(t, e)| (position(*t), 100.0 * e))
            .unzip();
        Line::new(name, time, strain)
    };
    let percent = |v: &[f64]| v.iter().map(|e| 100.0 * e).collect();
    let mut panel = Panel::new("", label, "strain (%)");
    if logarithmic {
        panel = panel.x_times();
    }
    for (index, p) in plotted.iter().enumerate() {
        let colour = Colour::CYCLE[index % Colour::CYCLE.len()];
        let dash = match index / Colour::CYCLE.len() {
            0 => Dash::Solid,
            1 => Dash::Dashed,
            _ => Dash::Dotted,
        };
        let name = if plotted.len() > MAX_LEGEND {
            String::new()
        } else {
            match p.analysis.slope_per_s {
                Some(s) => format!(
                    "{}  m_{{E}} = {} %/h",
                    p.name,
                    short(PERCENT_PER_H * s.value)
                ),
                None => p.name.clone(),
            }
        };
        if let Some(f) = &p.forecast {
            let time: Vec<f64> = f.time_s.iter().map(|t| position(*t)).collect();
            let low = percent(&f.reading_low_strain_ratio);
            let high = percent(&f.reading_high_strain_ratio);
            let middle = Line::new("", time.clone(), percent(&f.strain_ratio));
            panel = panel
                .band(Band::new("", time, low, high).colour(colour))
                .line(middle.colour(colour).dash(Dash::Dotted));
        }
        let time_s = &p.curve.time_s;
        let curve = line(&name, time_s, &p.curve.strain);
        panel = panel.line(curve.colour(colour).dash(dash));
        if let Some(fitted) = &p.fitted {
            let law = line("", time_s, fitted).colour(Colour::Black);
            panel = panel.line(law.dash(Dash::Dashed).width(1.0));
        }
    }
    if !logarithmic && SLOPE_FROM_S < 0.5 * longest && plotted.len() > 1 {
        panel = panel.event(SLOPE_FROM_S / seconds, "20 min");
    }
    let sentences = plotted
        .iter()
        .take(MAX_LEGEND)
        .map(|p| answer(p.analysis).text);
    Figure::new(title)
        .seen(sentences.collect::<Vec<_>>().join(". "))
        .size(820.0, 400.0)
        .panel(panel)
}
