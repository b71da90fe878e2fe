//! Creep curves in one figure, with slopes in the legend, as the paper's Figs. 1 and 2.

use super::analyze::{Analysis, SLOPE_FROM_S};
use super::curve::Curve;
use super::forecast::Forecast;
use sinew_figure::plot::{Band, Colour, Dash, Figure, Line, Panel};

/// Curves beyond which a legend tells nobody anything.
const NAMED: usize = 12;

/// A curve to draw.
#[derive(Debug, Clone)]
pub struct Plotted<'a> {
    /// Name in the legend.
    pub name: String,
    /// Readings.
    pub curve: &'a Curve,
    /// Its analysis; gives the slope in the legend.
    pub analysis: &'a Analysis,
    /// A fitted law's strain, at the times of the readings.
    pub fitted: Option<Vec<f64>>,
    /// What a law says about later.
    pub forecast: Option<Forecast>,
}

/// Strain over time; `logarithmic`: over the decadic logarithm of time.
pub fn figure(title: &str, plotted: &[Plotted<'_>], logarithmic: bool) -> Figure {
    let longest = plotted
        .iter()
        .filter_map(|p| {
            let ahead = p.forecast.as_ref().and_then(|f| f.time_s.last());
            ahead.or(p.curve.time_s.last())
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
    let place = |t: f64| {
        if logarithmic { t.log10() } else { t / seconds }
    };
    let percent = |v: &[f64]| -> Vec<f64> { v.iter().map(|e| 100.0 * e).collect() };
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
        let name = if plotted.len() > NAMED {
            String::new()
        } else {
            match p.analysis.slope_percent_per_h {
                Some(s) => format!("{}  m_{{E}} = {} %/h", p.name, short(s.value)),
                None => p.name.clone(),
            }
        };
        if let Some(f) = &p.forecast {
            let time: Vec<f64> = f.time_s.iter().map(|t| place(*t)).collect();
            panel = panel
                .band(
                    Band::new(
                        "",
                        time.clone(),
                        percent(&f.reading_low),
                        percent(&f.reading_high),
                    )
                    .colour(colour),
                )
                .line(
                    Line::new("", time, percent(&f.strain))
                        .colour(colour)
                        .dash(Dash::Dotted),
                );
        }
        // A logarithm starts at the first positive time.
        let (time, strain): (Vec<f64>, Vec<f64>) = p
            .curve
            .time_s
            .iter()
            .zip(&p.curve.strain)
            .filter(|(t, _)| !logarithmic || **t > 0.0)
            .map(|(t, e)| (place(*t), 100.0 * e))
            .unzip();
        panel = panel.line(Line::new(name, time, strain).colour(colour).dash(dash));
        if let Some(fitted) = &p.fitted {
            let (time, strain): (Vec<f64>, Vec<f64>) = p
                .curve
                .time_s
                .iter()
                .zip(fitted)
                .filter(|(t, _)| !logarithmic || **t > 0.0)
                .map(|(t, e)| (place(*t), 100.0 * e))
                .unzip();
            panel = panel.line(
                Line::new("", time, strain)
                    .colour(Colour::Black)
                    .dash(Dash::Dashed)
                    .width(1.0),
            );
        }
    }
    if !logarithmic && SLOPE_FROM_S < 0.5 * longest && plotted.len() > 1 {
        panel = panel.event(SLOPE_FROM_S / seconds, "20 min");
    }
    Figure::new(title).size(820.0, 400.0).panel(panel)
}

/// Three significant digits, with a power of ten where decimals would hide them.
pub(super) fn short(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let size = value.abs();
    let text = if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    };
    text.replace('-', "−")
}
