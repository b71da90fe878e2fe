//! Isochrones as table and figure.

use super::messages::{duration, group, measurement_time};
use crate::text::short;
use sinew_creep::{Isochrone, LoadQuantity};
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};
use sinew_figure::{Columns, Table};

/// Tabulates exponent and secant per group and time.
pub(super) fn isochrones<'a>(all: impl IntoIterator<Item = &'a Isochrone>) -> Table {
    Columns::of(all)
        .words("group", |i| group(&i.group))
        .column("after", |i| measurement_time(i.time_s))
        .column("n", |i| i.points.len())
        .column("load per %", |i| match i.quantity {
            LoadQuantity::Stress => format!("{} MPa", short(1e-8 * i.secant)),
            LoadQuantity::Force => format!("{} N", short(0.01 * i.secant)),
        })
        .column("p", |i| short(i.exponent.value))
        .column("95 % interval", |i| {
            format!("{} … {}", short(i.exponent.low), short(i.exponent.high))
        })
        .table()
}

/// Plots the isochrones of up to six groups, one panel each; the fitted power law is dashed.
pub(super) fn isochronous_figure(isochrones: &[Isochrone]) -> Option<Figure> {
    /// Maximum number of panels.
    const MAX_PANELS: usize = 6;
    /// Maximum number of curves per panel.
    const MAX_CURVES: usize = 4;
    let mut groups: Vec<&Option<String>> = isochrones.iter().map(|i| &i.group).collect();
    groups.dedup();
    if groups.is_empty() || groups.len() > MAX_PANELS {
        return None;
    }
    let columns = groups.len().min(2);
    let rows = groups.len().div_ceil(columns);
    let mut figure = Figure::new("")
        .size(820.0, 360.0 * rows as f64)
        .columns(columns);
    for name in groups {
        let own: Vec<&Isochrone> = isochrones.iter().filter(|i| i.group == *name).collect();
        let load = match own[0].quantity {
            LoadQuantity::Stress => "stress (MPa)",
            LoadQuantity::Force => "load (N)",
        };
        let title = name.as_deref().unwrap_or("");
        let mut panel = Panel::new(title, "strain (%)", load);
        let every = own.len().div_ceil(MAX_CURVES);
        for (k, curve) in own.iter().step_by(every).enumerate() {
            let colour = Colour::CYCLE[k % Colour::CYCLE.len()];
            let mut points = points(curve);
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
            panel = panel.line(Line::new(duration(curve.time_s), x, y).colour(colour));
            let (x, y) = power_law(curve);
            let law = Line::new("", x, y).colour(colour).dash(Dash::Dashed);
            panel = panel.line(law.width(1.0));
        }
        figure = figure.panel(panel);
    }
    Some(figure)
}

/// Returns strain (%) and load (N or MPa) of every specimen.
fn points(curve: &Isochrone) -> Vec<(f64, f64)> {
    let unit = match curve.quantity {
        LoadQuantity::Stress => 1e-6,
        LoadQuantity::Force => 1.0,
    };
    let points = curve.points.iter();
    points
        .map(|p| (100.0 * p.strain_ratio, unit * p.load))
        .collect()
}

/// Evaluates the fitted power law: strain (%) and load (N or MPa).
fn power_law(curve: &Isochrone) -> (Vec<f64>, Vec<f64>) {
    const POINTS: i32 = 30;
    let load: Vec<f64> = points(curve).iter().map(|p| p.1).collect();
    let (low, high) = (load[0], load[load.len() - 1]);
    let middle = load.iter().map(|load| load.ln()).sum::<f64>() / load.len() as f64;
    // The secant is load over strain at the geometric mean of the loads.
    let unit = match curve.quantity {
        LoadQuantity::Stress => 1e-8,
        LoadQuantity::Force => 0.01,
    };
    let strain = middle.exp() / (unit * curve.secant);
    (0..=POINTS)
        .map(|i| {
            let load = low * (high / low).powf(f64::from(i) / f64::from(POINTS));
            (
                strain * (load / middle.exp()).powf(curve.exponent.value),
                load,
            )
        })
        .unzip()
}
