//! Analysis of creep tests: strain, slope, measurements, artefacts, isochrones.

use super::isochronous::{isochrones, isochronous_figure};
use super::messages::{artefact, group, short};
use super::page;
use super::picture::plotted;
use super::specimen::{answer, groups, readings, recovery, specimens};
use crate::data::Data;
use crate::text::{self, TerminalText};
use sinew_creep::{Analysis, AnalyzeReport, Scatter, Tests, scatter};
use sinew_figure::{Block, Headline, Page};

/// Maximum number of specimens that are shown individually on the terminal.
const MAX_SHOWN: usize = 24;
/// Maximum number of specimens whose measurements are shown on the terminal.
const MAX_MEASURED: usize = 3;
/// Maximum number of artefacts that are listed on the terminal.
const MAX_FAULTS: usize = 20;
/// Maximum number of specimens or groups with a headline in the report.
const MAX_HEADLINES: usize = 6;

/// Renders specimens, groups, measurements, artefacts and isochrones for a terminal.
pub fn analyze_table(report: &AnalyzeReport) -> String {
    let analyses = &report.specimens;
    let mut out = TerminalText::default();
    if analyses.len() <= MAX_SHOWN {
        out.table(specimens(analyses, text::short).table());
    }
    if report.groups.len() > 1 || analyses.len() > MAX_SHOWN {
        out.add("\n");
        out.table(
            groups(&report.groups)
                .column("outliers", |g| g.apart.len())
                .table(),
        );
    }
    if analyses.len() <= MAX_MEASURED {
        for a in analyses {
            let table = readings(a);
            out.add("\n");
            out.flat(&table.caption);
            out.table(table);
            for text in recovery(a) {
                out.paragraph(text);
            }
        }
    }
    artefacts(&mut out, analyses);
    /// Times of the isochrones on the terminal, s: one per decade.
    const TIMES: [f64; 5] = [60.0, 720.0, 3600.0, 36_000.0, 360_000.0];
    let decades = report.isochrones.iter();
    let table = isochrones(decades.filter(|i| TIMES.contains(&i.time_s)));
    if !table.rows.is_empty() {
        out.add("\nisochrones: strain over load at the same time, strain ∝ load^p\n\n");
        out.table(table);
    }
    out.0
}

/// Lists artefacts; one without a time is listed once for all specimens.
fn artefacts(out: &mut TerminalText, analyses: &[Analysis]) {
    let mut listed: Vec<(String, usize)> = Vec::new();
    for a in analyses {
        for f in &a.artefacts {
            let text = match f.time_s() {
                None => artefact(f),
                Some(_) => format!("{}: {}", a.name, artefact(f)),
            };
            match listed.iter_mut().find(|(t, _)| *t == text) {
                Some((_, count)) => *count += 1,
                None => listed.push((text, 1)),
            }
        }
    }
    if !listed.is_empty() {
        out.add("\n");
    }
    for (text, count) in listed.iter().take(MAX_FAULTS) {
        out.paragraph(match count {
            1 => format!("- {text}"),
            _ => format!("- {text} ({count} specimens)"),
        });
    }
    if listed.len() > MAX_FAULTS {
        let more = listed.len() - MAX_FAULTS;
        out.add(format!("- and {more} more (--csv, --json)\n"));
    }
}

/// Builds the report of an analysis: curves, measurements, moduli, isochrones.
pub fn analyze_page(report: &AnalyzeReport, tests: &Tests) -> Page {
    let mut figures = page::curves(&plotted(tests), "");
    if let Some(figure) = isochronous_figure(&report.isochrones) {
        let caption =
            "Isochrones: load over strain after the same time under load; one point per specimen.";
        figures.push((figure, caption.into()));
    }
    let answers = answers(&tests.analyses);
    let mut page = page::begin("Creep test", answers, &report.conditions, tests, figures);
    page = page::readings(page::repeats(page, &report.groups), tests);
    if !report.isochrones.is_empty() {
        let table = isochrones(&report.isochrones).captioned("Strain of the specimens of a group after the same time under different loads, ε ∝ σ^p; p = 1: strain is proportional to load; n: specimens. Load per %: secant at the mean load.");
        page = page.section("Isochrones", vec![Block::Table(table)]);
    }
    page::end(page, &report.sources, &report.failures, tests)
}

/// Makes the headlines: strain of each specimen, or of each group if there are many.
fn answers(analyses: &[Analysis]) -> Vec<Headline> {
    if analyses.len() <= MAX_HEADLINES {
        return analyses.iter().map(answer).collect();
    }
    let of_group = |g: &Scatter| {
        let (name, n) = (group(&g.group), g.specimens);
        let end = short(100.0 * g.end_strain_ratio);
        Headline::from(format!(
            "{name}: final strain {end} %, mean of {n} specimens"
        ))
    };
    let groups = scatter(analyses);
    groups.iter().take(MAX_HEADLINES).map(of_group).collect()
}

/// Tabulates the analysis in SI units, one row per specimen.
pub fn analyze_csv(report: &AnalyzeReport) -> sinew_log::Table {
    let artefacts = |a: &&Analysis| {
        let all: Vec<String> = a.artefacts.iter().map(artefact).collect();
        all.join("; ")
    };
    Data::of(&report.specimens)
        .text("specimen", |a| a.name.as_str())
        .text("group", |a| group(&a.group))
        .number("force_n", |a| a.force_n)
        .number("stress_pa", |a| a.stress_pa)
        .number("temperature_c", |a| a.temperature_c.map(|t| t.mean))
        .number("humidity_percent", |a| a.humidity_percent.map(|h| h.mean))
        .number("duration_s", |a| a.duration_s)
        .number("end_strain_ratio", |a| a.end_strain_ratio)
        .number("creep_strain_ratio", |a| a.creep_strain_ratio)
        .bounded(
            ["slope_per_s", "slope_low_per_s", "slope_high_per_s"],
            |a| a.slope_per_s,
        )
        .number("saturation_s", |a| a.saturation_s)
        .text("saturated", |a| a.saturated.map(|s| s.to_string()))
        .text("artefacts", artefacts)
        .table()
}
