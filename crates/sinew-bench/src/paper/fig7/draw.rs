//! The drawing: added, difference, relaxed, and why it decreases.

use super::super::data::PanelData;
use super::super::staircase::LENGTH_S;
use super::super::trial::{Trial, difference};
use super::tendency::Tendency;
use super::{ADDED_RAD, Runs};
use sinew_figure::plot::{Colour, Dash, Figure, Line, Panel};

pub(super) fn panels(
    trial: &Trial,
    paper: &Runs,
    matched: &Runs,
    tendency: &Tendency,
) -> Vec<PanelData> {
    let of = |curves: &[(&str, &[f64])]| {
        curves
            .iter()
            .map(|(name, curve)| trial.series(name, curve))
            .collect()
    };
    let added = difference(&paper.added, &paper.first);
    let added_matched = difference(&matched.added, &matched.first);
    vec![
        PanelData {
            title: "10 mrad added".into(),
            series: of(&[("unchanged", &paper.first), ("10 mrad added", &paper.added)]),
        },
        PanelData {
            title: "Difference".into(),
            series: of(&[
                ("paper's comparison", &added),
                ("Sinew's, matched", &added_matched),
            ]),
        },
        PanelData {
            title: "Rope relaxed by 0.5 mm, re-tensioned".into(),
            series: of(&[
                ("unchanged", &paper.first),
                ("relaxed", &paper.relaxed),
                ("re-tensioned", &paper.again),
            ]),
        },
        PanelData {
            title: "Causes of the decrease (added by Sinew)".into(),
            series: tendency
                .variants()
                .iter()
                .map(|v| trial.series(v.name, &v.curve))
                .collect(),
        },
    ]
}

pub(super) fn figure(panels: &[PanelData], relaxed_rad: f64) -> Figure {
    let mut figure = Figure::new("Offset estimate of a simulated “real” elbow")
        .subtitle("Errors of the model, friction, quantisation and elasticity that the estimator does not model; the paper's comparison unless noted")
        .size(1120.0, 760.0)
        .columns(2);
    let colours: [&[Colour]; 4] = [
        &[Colour::Black, Colour::Blue],
        &[Colour::Sky, Colour::Green],
        &[Colour::Black, Colour::Orange, Colour::Sky],
        &Colour::CYCLE,
    ];
    for (i, (data, colours)) in panels.iter().zip(colours).enumerate() {
        let label = if i == 1 {
            "difference (mrad)"
        } else {
            "estimate (mrad)"
        };
        let x_label = if i < 2 { "" } else { "time (s)" };
        let mut panel = Panel::new(data.title.clone(), x_label, label).x_range(0.0, LENGTH_S);
        if i == 1 {
            panel = panel.reference(1e3 * ADDED_RAD, "added");
        }
        if i == 2 {
            panel = panel.reference(1e3 * relaxed_rad, "0.5 mm");
        }
        for ((series, colour), dash) in data.series.iter().zip(colours).zip(Dash::CYCLE) {
            panel = panel.line(
                Line::new(series.name.clone(), series.time_s.clone(), series.drawn())
                    .colour(*colour)
                    .dash(dash)
                    .width(1.3),
            );
        }
        figure = figure.panel(panel);
    }
    figure
}
