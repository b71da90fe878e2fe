//! Report of a series as one HTML file.

use super::outcome::Outcome;
use super::rejection::millimetres;
use super::summary::Summary;
use sinew_figure::plot::{Band, Colour, Figure, Line, Panel, Points};
use sinew_figure::{Block, Headline, Page, Table, rounded};
use sinew_files::number::Z95;

/// Maximum number of frames shown as dots.
const MAX_DOTS: usize = 200;
/// Maximum number of points of a figure; more are not distinguishable in print.
const MAX_POINTS: usize = 2000;

/// Renders the report as HTML that loads no external data.
pub fn html(outcome: &Outcome, title: &str, version: &str) -> String {
    let summary = Summary::of(outcome);
    let scale = &summary.scale;
    let mut page = Page::new(title);
    page.subtitle = format!(
        "Elongation measured by camera on a graduated scale: {} of {} frames used",
        summary.frames_used, summary.frames
    );
    page.footer = format!("sinew {version}");
    let mut first = vec![Block::Headlines(
        [
            format!(
                "Elongation: {} mm from the first to the last used frame, {} s later",
                rounded(1e3 * summary.elongation_last_m, 4),
                rounded(summary.time_to_s - summary.time_from_s, 4)
            ),
            format!(
                "Accuracy of one frame: ± {:.4} mm (95 %)",
                1e3 * Z95 * summary.elongation_std_rms_m
            ),
        ]
        .map(Headline::from)
        .to_vec(),
    )];
    first.extend(summary.notes.iter().cloned().map(Block::Notice));
    first.push(Block::Figure(
        Box::new(figure(outcome)),
        "Each frame relative to the first used frame. Band: 95 % interval from the scatter within a \
         frame."
            .into(),
    ));
    page = page.section("Elongation", first);
    let mut facts = vec![
        (
            "pitch",
            format!(
                "{} mm = {:.3} px",
                millimetres(scale.pitch_m),
                scale.pitch_px
            ),
        ),
        (
            "resolution",
            format!("{:.2} px/mm", 1e-3 * summary.px_per_m),
        ),
        (
            "direction",
            if scale.upright { "upright" } else { "lying" }.into(),
        ),
        ("tilt", format!("{:.2}°", scale.tilt_rad.to_degrees())),
        (
            "change of pitch along the scale",
            format!("{} %", rounded(100.0 * scale.pitch_change_ratio, 2)),
        ),
        ("visible lines", scale.lines.to_string()),
        (
            "longer lines",
            scale
                .longer_every
                .map_or("none".into(), |n| format!("every {n}")),
        ),
        ("reference frame", summary.reference_frame.clone()),
        (
            "elongation per movement",
            format!("{}", summary.elongation_per_movement),
        ),
        (
            "longest step",
            format!("{} mm", rounded(1e3 * summary.step_max_m, 3)),
        ),
        ("lowest quality used", rounded(summary.quality_min, 2)),
    ];
    for (name, unit, value) in [
        ("force", "N", outcome.conditions.force_n),
        (
            "gauge length",
            "mm",
            outcome.conditions.gauge_length_m.map(millimetres),
        ),
        ("temperature", "°C", outcome.conditions.temperature_c),
    ] {
        if let Some(value) = value {
            facts.push((name, format!("{value} {unit}")));
        }
    }
    page = page.section("Scale and camera", vec![Block::Table(Table::facts(facts))]);
    if !summary.rejected.is_empty() {
        let rows = summary
            .rejected
            .iter()
            .map(|r| vec![r.reason.to_string(), r.frames.to_string(), r.first.clone()]);
        page = page.section(
            "Frames not used",
            vec![Block::Table(Table::new(
                &["reason", "frames", "first"],
                rows,
            ))],
        );
    }
    page.section(
        "Method",
        vec![Block::Paragraph(
            "The phase of the graduation is measured in blocks of eight rows by eight graduations \
             under a Hann window, compared with the reference frame's map of phases, and averaged \
             with robust weights. Whole graduations are counted by comparing the pattern \
             of longer lines and numbers with all earlier lines. A millimetre is a \
             millimetre of the printed scale; pixels are not used. Not corrected: an angle between \
             scale and movement (0.015 % at 1°), and errors of the print."
                .into(),
        )],
    )
    .html()
}

/// Returns time, s, elongation and its standard deviation, mm, and quality.
type Row = (f64, f64, f64, f64);

fn figure(outcome: &Outcome) -> Figure {
    let all: Vec<Row> = outcome
        .used()
        .map(|(_, frame, reading)| {
            let (elongation_m, std_m) = outcome.elongation_m(reading);
            let (mm, std_mm) = (1e3 * elongation_m, 1e3 * std_m);
            (frame.time_s, mm, std_mm, reading.quality)
        })
        .collect();
    let every = all.len().div_ceil(MAX_POINTS).max(1);
    let all: Vec<_> = all.into_iter().step_by(every).collect();
    let time: Vec<f64> = all.iter().map(|v| v.0).collect();
    let column = |of: &dyn Fn(&Row) -> f64| all.iter().map(of).collect::<Vec<f64>>();
    let dots = match time.len() > MAX_DOTS {
        true => Vec::new(),
        false => time.clone(),
    };
    Figure::new("")
        .size(720.0, 420.0)
        .panel(
            Panel::new("", "", "elongation (mm)")
                .weight(3.0)
                .band(Band::new(
                    "95 %",
                    time.clone(),
                    column(&|v| v.1 - Z95 * v.2),
                    column(&|v| v.1 + Z95 * v.2),
                ))
                .line(Line::new("elongation", time.clone(), column(&|v| v.1)).colour(Colour::Blue))
                .points(Points::new("", dots, column(&|v| v.1)).size(4.5)),
        )
        .panel(
            Panel::new("", "time (s)", "quality")
                .y_range(0.0, 1.05)
                .line(Line::new("quality", time, column(&|v| v.3))),
        )
}
