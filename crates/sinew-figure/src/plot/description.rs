//! Text alternative of a figure, for screen readers.

use super::axis::x_extent;
use super::label::plain;
use super::{Annotation, Figure, Panel, Series, XValues};
use crate::rounded;
use sinew_files::date::{DAY_S, day_of};

/// Maximum number of curves, and of annotations, that are described individually.
const MAX_DESCRIBED: usize = 8;

/// Returns the text alternative of the figure, followed by a description of every curve.
pub(super) fn description(figure: &Figure) -> String {
    let mut sentences: Vec<String> = Vec::new();
    let seen = figure.seen.trim();
    if !seen.is_empty() {
        let stop = if seen.ends_with(['.', '?', '!']) {
            ""
        } else {
            "."
        };
        sentences.push(format!("{seen}{stop}"));
    }
    for panel in &figure.panels {
        sentences.extend(of_panel(panel));
    }
    sentences.join(" ")
}

fn of_panel(panel: &Panel) -> Vec<String> {
    let (low, high) = x_extent(panel);
    let label = plain(&panel.y_label);
    let subject = match (panel.title.is_empty(), label.is_empty()) {
        (true, _) => label.clone(),
        (false, true) => plain(&panel.title),
        (false, false) => format!("{}, {label}", plain(&panel.title)),
    };
    let x_label = match (panel.x_values, panel.x_label.is_empty()) {
        (XValues::Plain, false) => format!(", {}", plain(&panel.x_label)),
        _ => String::new(),
    };
    let from_to = format!("from {} to {}", at(panel, low), at(panel, high));
    let mut out = vec![format!("{subject}{x_label} {from_to}:")];
    let curves: Vec<String> = panel.series.iter().filter_map(of_series).collect();
    let more = curves.len().saturating_sub(MAX_DESCRIBED);
    let mut described = curves[..curves.len() - more].join("; ");
    if more > 0 {
        described += &format!("; and {more} more");
    }
    out.push(if described.is_empty() {
        "no data.".into()
    } else {
        described + "."
    });
    out.extend(of_marks(panel));
    out
}

/// Formats a horizontal value.
fn at(panel: &Panel, x: f64) -> String {
    match panel.x_values {
        XValues::Plain => number(x),
        XValues::LogSeconds => duration_text(10f64.powf(x)),
        XValues::DaysSince { utc_s } => day_of(utc_s + x * DAY_S),
    }
}

fn number(v: f64) -> String {
    if v != 0.0 && v.abs() < 1e-3 {
        format!("{v:.1e}").replace('-', "−")
    } else {
        rounded(v, 3)
    }
}

fn duration_text(s: f64) -> String {
    const UNITS: [(f64, &str); 6] = [
        (31_557_600.0, "years"),
        (2_629_800.0, "months"),
        (86_400.0, "days"),
        (3600.0, "h"),
        (60.0, "min"),
        (1.0, "s"),
    ];
    let unit = UNITS.iter().find(|u| s >= 0.999 * u.0).unwrap_or(&UNITS[5]);
    format!("{} {}", rounded(s / unit.0, 2), unit.1)
}

fn of_series(series: &Series) -> Option<String> {
    let finite =
        |ys: &[f64]| -> Vec<f64> { ys.iter().copied().filter(|y| y.is_finite()).collect() };
    let all: Vec<f64> = series.ys().flat_map(finite).collect();
    let low = all.iter().copied().reduce(f64::min)?;
    let high = all.iter().copied().reduce(f64::max)?;
    let name = plain(series.name());
    let name = |other: &str| {
        if name.is_empty() {
            other.to_owned()
        } else {
            name.clone()
        }
    };
    Some(match series {
        Series::Line(line) => {
            let y = finite(&line.y);
            let (first, last) = (*y.first()?, *y.last()?);
            let trajectory = format!(
                "{} goes from {} to {}",
                name("the curve"),
                number(first),
                number(last)
            );
            // Extremes near the end points are not repeated.
            let beyond = 0.02 * (high - low);
            let outside = low < first.min(last) - beyond || high > first.max(last) + beyond;
            let extremes = format!(", lowest {}, highest {}", number(low), number(high));
            if outside {
                trajectory + &extremes
            } else {
                trajectory
            }
        }
        Series::Band(_) => format!(
            "{} spans {} to {}",
            name("the band"),
            number(low),
            number(high)
        ),
        Series::Points(points) => {
            let measurements = finite(&points.y);
            let (count, s) = (
                measurements.len(),
                if measurements.len() == 1 { "" } else { "s" },
            );
            format!(
                "{}: {count} measurement{s}, {} to {}",
                name("dots"),
                number(low),
                number(high)
            )
        }
    })
}

/// Lists the annotations with their positions; frequent labels are counted.
fn of_marks(panel: &Panel) -> Option<String> {
    let mut described: Vec<(String, Vec<String>)> = Vec::new();
    for mark in &panel.marks {
        let (label, place) = match mark {
            Annotation::Reference { y, label } => (label, format!("at {}", number(*y))),
            Annotation::Event { x, label } => (label, format!("at {}", at(panel, *x))),
            Annotation::Span { from, to, label } => (
                label,
                format!("from {} to {}", at(panel, *from), at(panel, *to)),
            ),
            // Notes refer to data that are already described.
            Annotation::Note { .. } => continue,
        };
        if label.is_empty() {
            continue;
        }
        match described.iter_mut().find(|(listed, _)| listed == label) {
            Some((_, places)) => places.push(place),
            None => described.push((label.clone(), vec![place])),
        }
    }
    let words: Vec<String> = described
        .into_iter()
        .map(|(label, places)| match places.as_slice() {
            few if few.len() <= 3 => format!("{} {}", plain(&label), few.join(", ")),
            many => format!("{} {} times", plain(&label), many.len()),
        })
        .take(MAX_DESCRIBED)
        .collect();
    (!words.is_empty()).then(|| format!("Marked: {}.", words.join("; ")))
}
