//! Sections common to all reports of creep tests.

use super::messages::{artefact, duration, short};
use super::picture::{Plotted, figure};
use super::specimen::{groups, readings as readings_of, recovery, specimens};
use crate::text::or_dash;
use sinew_creep::{Analysis, Conditions, Failure, Scatter, Source, Span, Tests};
use sinew_figure::plot::Figure;
use sinew_figure::{Block, Columns, Headline, Page, Table};

/// Maximum number of specimens whose measurements are in the report.
pub(super) const MAX_MEASURED: usize = 12;

/// Plots the curves over time, and over its logarithm.
pub(super) fn curves(plotted: &[Plotted<'_>], caption: &str) -> Vec<(Figure, String)> {
    vec![
        (figure("", plotted, false), caption.to_owned()),
        (figure("", plotted, true), String::new()),
    ]
}

/// Starts a report with headlines, curves with captions, and test conditions.
pub(super) fn begin(
    title: &str,
    answers: Vec<Headline>,
    conditions: &Conditions,
    tests: &Tests,
    figures: Vec<(Figure, String)>,
) -> Page {
    let analyses = &tests.analyses;
    let mut page = Page::new(title);
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    page.subtitle = format!(
        "{} from {}",
        plural(analyses.len(), "specimen"),
        plural(tests.sources.len(), "file")
    );
    page.footer = format!("Sinew {}", env!("CARGO_PKG_VERSION"));
    let figures = figures.into_iter();
    let mut blocks: Vec<Block> = figures
        .map(|(figure, caption)| Block::Figure(Box::new(figure), caption))
        .collect();
    let results = specimens(analyses, |percent| format!("{percent:.4}"))
        .column("95 % of creep", |a| or_dash(a.saturation_s, duration))
        .captioned("m_E: slope of a straight line from 20 min (default), with its 95 % interval for correlated residuals. 95 % of creep: time at which 95 % of the final creep was reached.");
    blocks.push(results.into());
    if !answers.is_empty() {
        page = page.section("", vec![Block::Headlines(answers)]);
    }
    page.section("Creep", blocks)
        .section("Test", vec![circumstances(conditions, analyses).into()])
}

/// Tabulates load, temperature and the conditions specified by the laboratory.
fn circumstances(conditions: &Conditions, analyses: &[Analysis]) -> Table {
    let specified =
        |text: &Option<String>| text.clone().unwrap_or_else(|| "not specified".to_owned());
    let of = |unit: &str, pick: &dyn Fn(&Analysis) -> Option<f64>| {
        let values: Vec<f64> = analyses.iter().filter_map(pick).collect();
        span(&values, unit)
    };
    let humidity = |pick: fn(&Span) -> f64| {
        let all = analyses.iter();
        all.filter_map(move |a| a.humidity_percent.as_ref().map(pick))
    };
    let moist: Vec<f64> = humidity(|h| h.low).chain(humidity(|h| h.high)).collect();
    Table::facts([
        ("Standard", conditions.standard.clone()),
        ("Load", of("N", &|a| a.force_n)),
        ("Preload", of("N", &|a| a.preload_n)),
        ("Stress", of("MPa", &|a| a.stress_pa.map(|s| s * 1e-6))),
        (
            "Temperature",
            of("°C", &|a| a.temperature_c.map(|t| t.mean)),
        ),
        ("Humidity or moisture", span(&moist, "%")),
        ("Time under load", of("h", &|a| Some(a.duration_s / 3600.0))),
        ("Preconditioning", specified(&conditions.preconditioning)),
        ("Conditions", specified(&conditions.conditions)),
    ])
}

fn span(values: &[f64], unit: &str) -> String {
    if values.is_empty() {
        return "not recorded".to_owned();
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if high - low < 1e-3 * high.abs() {
        format!("{} {unit}", short(low))
    } else {
        format!("{} to {} {unit}", short(low), short(high))
    }
}

/// Adds the scatter between the specimens of groups with repeats.
pub(super) fn repeats(page: Page, all: &[Scatter]) -> Page {
    if !all.iter().any(|g| g.specimens > 1) {
        return page;
    }
    let table = groups(all)
        .column("outliers", |g| g.apart.join(", "))
        .captioned("Mean values; scatter: standard deviation between specimens.");
    page.section("Groups", vec![table.into()])
}

/// Adds the measurements of a few specimens, and their recovery.
pub(super) fn readings(mut page: Page, tests: &Tests) -> Page {
    let analyses = &tests.analyses;
    let read = analyses.iter().filter(|a| !a.readings.is_empty());
    let blocks: Vec<Block> = read.map(|a| readings_of(a).into()).collect();
    if analyses.len() <= MAX_MEASURED && !blocks.is_empty() {
        page = page.section("Measurements", blocks);
    }
    let recovered: Vec<String> = (analyses.iter())
        .flat_map(|a| recovery(a).map(|text| format!("{}: {text}", a.name)))
        .collect();
    match recovered.is_empty() {
        true => page,
        false => page.section("Recovery", vec![Block::List(recovered)]),
    }
}

/// Ends a report with artefacts and raw data: files with checksums and column mapping.
pub(super) fn end(mut page: Page, sources: &[Source], failures: &[Failure], tests: &Tests) -> Page {
    /// Maximum number of listed artefacts.
    const MAX_LISTED: usize = 60;
    let mut artefacts: Vec<String> = failures.iter().map(ToString::to_string).collect();
    for a in &tests.analyses {
        artefacts.extend(
            a.artefacts
                .iter()
                .map(|f| format!("{}: {}", a.name, artefact(f))),
        );
    }
    let more = artefacts.len().saturating_sub(MAX_LISTED);
    artefacts.truncate(MAX_LISTED);
    if more > 0 {
        artefacts.push(format!("and {more} more (see the table file)"));
    }
    if !artefacts.is_empty() {
        page = page.section("Artefacts and failures", vec![Block::List(artefacts)]);
    }
    let files = Columns::of(sources)
        .column("file", |s| &s.file)
        .column("SHA-256", |s| &s.sha256)
        .captioned("The checksum identifies the file.");
    let mut notes = Vec::new();
    for s in sources {
        let columns = s.columns.iter();
        let used =
            columns.map(|c| format!("{} from '{}' in {}", c.quantity.name(), c.column, c.unit));
        let used: Vec<String> = used.collect();
        notes.push(format!("{}: {}", s.file, used.join(", ")));
        notes.extend(s.notes.iter().map(|n| format!("{}: {n}", s.file)));
    }
    page.section("Raw data", vec![files.into(), Block::List(notes)])
}
