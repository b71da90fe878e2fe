//! Table I: the ropes as published, and their simulated creep tests.

use super::PaperError;
use super::assessment::assumptions;
use super::creep::{LOAD_N, MINUTES, Test, test};
use super::data::{FigureName, PaperFigure, given};
use super::sentence::{Sentence, Unit};
use sinew_figure::Table;
use sinew_figure::plot::{Colour, Figure, Line, Panel};
use sinew_rope::draws::bounded;
use sinew_rope::law::entry::CatalogueEntry;
use sinew_rope::{Catalogue, CatalogueRope};

/// Table I with the simulated creep test of every rope.
///
/// # Errors
/// [`PaperError`].
pub fn table1(catalogue: &Catalogue) -> Result<PaperFigure, PaperError> {
    let printed = Catalogue::paper()?;
    let rows = printed.ropes().iter().map(published).collect();
    let tests = printed
        .names()
        .iter()
        .map(|name| test(catalogue, name, 23.0))
        .collect::<Result<Vec<_>, _>>()?;
    let sentences = vec![as_printed(printed.ropes())];
    Ok(PaperFigure {
        about: vec![format!(
            "As published, with a simulated creep test of every rope: {LOAD_N} N, 23 °C, {MINUTES} min; bars are 95 % of the draws."
        )],
        sentences,
        given: given(&["The printed values of Table I equal those of the catalogue."]),
        tables: vec![
            table("Table I as printed", &PUBLISHED, rows),
            table(
                "Simulated; brackets are 95 % of the draws",
                &SIMULATED,
                tests.iter().map(simulated).collect(),
            ),
        ],
        assumptions: assumptions(),
        ..PaperFigure::new(
            FigureName::Table1,
            "Table I: the ropes, and their simulated creep test",
            figure(&tests),
        )
    })
}

/// Checks that the catalogue contains the number of values that Table I prints.
fn as_printed(ropes: &[CatalogueRope]) -> Sentence {
    let count = |has: &dyn Fn(&CatalogueEntry) -> bool| {
        ropes.iter().filter(|rope| has(&rope.entry)).count()
    };
    let loads = count(&|e| e.breaking_load_n.is_some());
    let weights = count(&|e| e.weight_g_per_m.is_some());
    let plaits = count(&|e| e.plait.is_some());
    let holds = (ropes.len(), loads, weights, plaits) == (9, 7, 5, 5);
    Sentence::added(
        "Nine ropes, with breaking load, plait and weight if published.",
        format!("Expected from the printed table: 9 ropes, 7 with a breaking load, 5 with a weight, 5 with a plait; found: {loads}, {weights} and {plaits}. A test compares every value with the printed table"),
        ropes.len() as f64,
        Unit::Ropes,
        holds,
    )
    .of_paper()
}

const PUBLISHED: [&str; 6] = [
    "rope",
    "fibre",
    "diameter, mm",
    "breaking load, N",
    "plait",
    "weight, g/m",
];

fn published(rope: &CatalogueRope) -> Vec<String> {
    let e = &rope.entry;
    let number = |v: &Option<sinew_rope::law::entry::Value>, digits: usize| {
        v.as_ref()
            .map_or_else(|| "–".into(), |v| format!("{:.digits$}", v.value))
    };
    vec![
        format!("{} {}", e.manufacturer, e.product),
        format!("{}, {}", e.fibre, e.material.name()),
        number(&e.diameter_mm, 2),
        number(&e.breaking_load_n, 0),
        e.plait.clone().unwrap_or_else(|| "–".into()),
        number(&e.weight_g_per_m, 2),
    ]
}

const SIMULATED: [&str; 3] = ["rope", "strain at the end, %", "m_E, %/h"];

fn simulated(t: &Test) -> Vec<String> {
    let interval = |values: &[f64], digits: usize| {
        let i = bounded(values[0], &values[1..]);
        format!(
            "{:.digits$} ({:.digits$} to {:.digits$})",
            i.value, i.low, i.high
        )
    };
    vec![
        t.product.clone(),
        interval(&t.end, 2),
        interval(&t.slope, 3),
    ]
}

fn table(caption: &str, head: &[&str], rows: Vec<Vec<String>>) -> Table {
    Table {
        caption: caption.into(),
        head: head.iter().map(|h| (*h).to_owned()).collect(),
        rows,
        ..Table::default()
    }
}

/// Final strain and slope of every rope with their intervals.
fn figure(tests: &[Test]) -> Figure {
    // The first row is drawn at the top, as in the table.
    let names: Vec<(f64, String)> = tests
        .iter()
        .enumerate()
        .map(|(i, t)| ((tests.len() - i) as f64, t.product.clone()))
        .collect();
    let panel = |label: &str, of: &dyn Fn(&Test) -> sinew_model::Bounded| {
        let mut panel = Panel::new("", label, "").y_names(names.clone());
        let mut right = 0.0f64;
        for (i, t) in tests.iter().enumerate() {
            let (y, v) = ((tests.len() - i) as f64, of(t));
            right = right.max(v.high);
            panel = panel
                .line(
                    Line::new("", vec![v.low, v.high], vec![y, y])
                        .colour(Colour::Blue)
                        .width(1.2),
                )
                .line(
                    Line::new("", vec![v.value, v.value], vec![y - 0.2, y + 0.2])
                        .colour(Colour::Blue)
                        .width(4.0),
                );
        }
        panel
            .x_range(0.0, 1.05 * right)
            .y_range(0.3, tests.len() as f64 + 0.7)
    };
    let end = |t: &Test| bounded(t.end[0], &t.end[1..]);
    let slope = |t: &Test| bounded(t.slope[0], &t.slope[1..]);
    Figure::new("The ropes of Table I in a simulated creep test")
        .subtitle(format!(
            "{LOAD_N} N, 23 °C, {MINUTES} min; bars are 95 % of the draws"
        ))
        .size(1100.0, 440.0)
        .columns(2)
        .panel(panel("strain at the end (%)", &end))
        .panel(panel("slope m_{E} (%/h)", &slope))
}
