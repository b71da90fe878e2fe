//! Fig. 3: the routings of the bending bench, as we read the paper's words.

use super::PaperError;
use super::bending::bench;
use super::data::{FigureName, PaperFigure, given};
use sinew_figure::Table;
use sinew_figure::plot::{Colour, Figure, Line, Panel};
use sinew_rope::bench::Bench;
use sinew_rope::bench::alternatives::ROUTINGS;
use sinew_rope::bench::routings::{
    self, CLOSE_WRAP_DEG, FRICTION, JOINT_FRICTION, LARGE_WRAP_DEG, SIDE_WRAP_DEG, SMALL_WRAP_DEG,
};
use sinew_rope::law::routing::portions;

/// Fig. 3: passes over the guiding pulleys along a strand, for each routing.
///
/// # Errors
/// [`PaperError`].
pub fn fig3() -> Result<PaperFigure, PaperError> {
    let title = "Fig. 3: routings of the bending bench, as we read the words";
    let mut figure = Figure::new(title)
        .subtitle(
            "passes over guiding pulleys along a strand; shaded: rope on a pulley, with its wrap",
        )
        .size(900.0, 620.0)
        .columns(2);
    for name in ROUTINGS {
        figure = figure.panel(panel(name, &bench(name)?)?);
    }
    Ok(PaperFigure {
        about: vec![
            "The paper's drawing was not available. Its words: \"three guiding pulleys in different arrangements from low to high rope bending\"; small wraps, further apart than the rope travels, in (B); one of the three wrapped by more than 180° in (C); the three close together, so that one portion passes each, in (D).".into(),
            "A bench file (`sinew bench simulate FILE`) replaces this geometry: one table `[[guide]]` for each pulley and strand.".into(),
        ],
        tables: vec![ranges()],
        given: given(&[
            "200 N on the carriage, about 100 mm of rope unrolled; one pulley of (C) is wrapped more than 180°.",
        ]),
        assumptions: vec![
            "Wraps, positions, radius and friction are assumed; whether one strand is guided or both is unknown, and the drawn values hold for each guided strand.".into(),
        ],
        ..PaperFigure::new(FigureName::Fig3, title, figure)
    })
}

/// Passes along a strand of one routing, with its pulleys.
fn panel(name: &str, bench: &Bench) -> Result<Panel, PaperError> {
    let pulleys = &bench.strands[0].pulleys;
    let portions = portions(bench.strand_m, bench.stroke_m, pulleys)
        .map_err(|e| PaperError::Rope(format!("{name}: {e}")))?;
    let (mut at_mm, mut passes) = (Vec::new(), Vec::new());
    for portion in portions {
        for side in [-0.5, 0.5] {
            at_mm.push(1e3 * (portion.middle_m + side * portion.length_m));
            passes.push(portion.passes);
        }
    }
    let wraps: Vec<String> = pulleys
        .iter()
        .map(|p| format!("{:.0}°", p.wrap_rad.to_degrees()))
        .collect();
    let mut panel = Panel::new(
        format!("({name}) {}", wraps.join(", ")),
        "distance from the drive (mm)",
        "passes",
    )
    .line(Line::new("", at_mm, passes).colour(Colour::Blue))
    .x_range(0.0, 1e3 * bench.strand_m)
    .y_range(0.0, 3.5);
    for p in pulleys {
        let ends = [p.at_m, p.at_m + p.contact_m()].map(|m| 1e3 * m);
        panel = panel.span(ends[0], ends[1], format!("{:.0}°", p.wrap_rad.to_degrees()));
    }
    Ok(panel)
}

/// Ranges of the geometry.
fn ranges() -> Table {
    let range = |[low, high]: [f64; 2], unit: &str| format!("{low} to {high}{unit}");
    let row = |name: &str, value: String| vec![name.to_string(), value];
    let rows = vec![
        row("strand", format!("{:.0} mm", 1e3 * routings::STRAND_M)),
        row("stroke", format!("{:.0} mm", 1e3 * routings::STROKE_M)),
        row(
            "pulley radius",
            format!("{:.0} mm", 1e3 * routings::RADIUS_M),
        ),
        row("wraps of (B)", range(SMALL_WRAP_DEG, "°")),
        row(
            "large wrap of (C), on any of the three",
            range(LARGE_WRAP_DEG, "°"),
        ),
        row("other wraps of (C)", range(SIDE_WRAP_DEG, "°")),
        row("wraps of (D)", range(CLOSE_WRAP_DEG, "°")),
        row(
            "friction of rope on guide, log-uniform",
            range(FRICTION, ""),
        ),
        row(
            "logarithm of the tension ratio at the joint pulley",
            range(JOINT_FRICTION, ""),
        ),
        row("guided strands", "one or both, equally likely".into()),
    ];
    Table::new(&["assumed", "range"], rows)
        .worded(&["range"])
        .captioned("Geometry and friction that fig4 draws from")
}
