//! Plot of the figure: three assumed models in the comparison of the paper, in the matched comparison, and as
//! difference.

use super::super::data::{Curve, PanelData};
use super::super::staircase::LENGTH_S;
use super::super::trial::{Trial, difference};
use super::{Case, OFFSETS};
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};
use sinew_sim::injected;

const NAMES: [&str; 3] = ["no offset", "10 mrad added", "15 mrad added"];

pub(super) fn panels(trial: &Trial, shoulder: usize, cases: &[Case]) -> Vec<PanelData> {
    let panel = |title: String, curves: &[Vec<f64>]| PanelData {
        title,
        series: (NAMES.iter().zip(curves))
            .map(|(name, curve)| trial.series(name, curve))
            .collect(),
    };
    let paper = cases.iter().map(|c| panel(c.title.into(), &c.paper));
    let matched = cases.iter();
    let matched = matched.map(|c| panel(format!("{}, matched", c.title), &c.matched));
    let mut panels: Vec<PanelData> = paper.chain(matched).collect();
    for case in cases {
        let mut paper = difference(&case.paper[2], &case.paper[1]);
        for (value, theta) in paper.iter_mut().zip(&trial.theta) {
            let added = |offset: f64| injected(theta[shoulder], offset) != theta[shoulder];
            if added(OFFSETS[1]) != added(OFFSETS[2]) {
                *value = f64::NAN;
            }
        }
        panels.push(PanelData {
            title: format!("{}, difference", case.title),
            series: vec![trial.series("15 − 10 mrad", &paper)],
        });
    }
    panels
}

pub(super) fn figure(panels: &[PanelData]) -> Figure {
    let mut figure = Figure::new("Offset estimate of the shoulder, simulated")
        .subtitle("Offsets of 0, 10 and 15 mrad are added to the recorded motor position; grey: the added offset")
        .size(1120.0, 860.0)
        .columns(3);
    let (low, high) = mrad_range(&panels[..panels.len().min(6)]);
    for (i, data) in panels.iter().enumerate() {
        let (row, column) = (i / 3, i % 3);
        let y_label = match (row, column) {
            (0, 0) => "paper's comparison (mrad)",
            (1, 0) => "Sinew's, matched (mrad)",
            (2, 0) => "difference (mrad)",
            _ => "",
        };
        let x_label = if row == 2 { "time (s)" } else { "" };
        let title = data.title.replace(", difference", "");
        let title = if row == 0 { title } else { String::new() };
        let mut panel = Panel::new(title, x_label, y_label)
            .x_range(0.0, LENGTH_S)
            .weight(if row == 2 { 0.6 } else { 1.0 });
        panel = if row == 2 {
            panel.y_range(-0.5, 6.0).reference(5.0, "")
        } else {
            panel
                .y_range(low, high)
                .reference(10.0, "")
                .reference(15.0, "")
        };
        const STYLES: [(Colour, Dash); 3] = [
            (Colour::Black, Dash::Solid),
            (Colour::Blue, Dash::LongDashed),
            (Colour::Orange, Dash::Dotted),
        ];
        for (series, (colour, dash)) in data.series.iter().zip(STYLES) {
            let colour = if row == 2 { Colour::Green } else { colour };
            // The first column contains the only legend.
            let name = if column == 0 && row != 1 {
                series.name.clone()
            } else {
                String::new()
            };
            panel = panel.line(
                Line::new(name, series.time_s.clone(), series.drawn())
                    .colour(colour)
                    .dash(dash)
                    .width(1.4),
            );
        }
        figure = figure.panel(panel);
    }
    figure
}

/// Returns the range of all curves of some panels, with a margin of one tenth, mrad.
fn mrad_range(panels: &[PanelData]) -> (f64, f64) {
    let values = panels
        .iter()
        .flat_map(|p| &p.series)
        .flat_map(|s| match &s.curve {
            Curve::AngleRad(values) | Curve::StrainRatio(values) => values,
        })
        .filter(|v| v.is_finite());
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
    let room = 0.1 * (high - low);
    (1e3 * (low - room), 1e3 * (high + room))
}
