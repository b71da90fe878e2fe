//! What creep tests show: strain, slope, readings, faults, isochrones.

use super::isochronous::{isochrones, isochronous_figure};
use super::page;
use super::picture::plotted;
use super::specimen::{answer, groups, readings, recovery, specimens};
use super::words::{fault, group, short};
use crate::data::Data;
use crate::text::{self, Told};
use sinew_creep::{Analysis, AnalyzeReport, PERCENT_PER_H, Scatter, Tests, scatter};
use sinew_figure::{Block, Headline, Page};

/// Specimens beyond which the terminal shows groups only.
const SHOWN: usize = 24;
/// Specimens beyond which the terminal leaves readings to the table file.
const READINGS_OF: usize = 3;
/// Faults that the terminal lists.
const FAULTS: usize = 20;
/// Specimens beyond which groups answer.
const FEW: usize = 6;

/// Specimens, groups, readings, faults and isochrones.
pub fn analyze_table(report: &AnalyzeReport) -> String {
    let analyses = &report.specimens;
    let mut out = Told::default();
    if analyses.len() <= SHOWN {
        out.table(specimens(analyses, text::short).table());
    }
    if report.groups.len() > 1 || analyses.len() > SHOWN {
        out.add("\n");
        out.table(
            groups(&report.groups)
                .column("apart", |g| g.apart.len())
                .table(),
        );
    }
    if analyses.len() <= READINGS_OF {
        for a in analyses {
            let table = readings(a);
            out.add("\n");
            out.flat(&table.caption);
            out.table(table);
            for text in recovery(a) {
                out.say(text);
            }
        }
    }
    faults(&mut out, analyses);
    /// Readings of every group that the terminal shows: the times of a decade each.
    const TIMES: [f64; 5] = [60.0, 720.0, 3600.0, 36_000.0, 360_000.0];
    let decades = report.isochrones.iter();
    let table = isochrones(decades.filter(|i| TIMES.contains(&i.time_s)));
    if !table.rows.is_empty() {
        out.add("\nisochronous: strain against load at the same time, strain ∝ load^p\n\n");
        out.table(table);
    }
    out.0
}

/// Faults; one that every record has is listed once.
fn faults(out: &mut Told, analyses: &[Analysis]) {
    let mut listed: Vec<(String, usize)> = Vec::new();
    for a in analyses {
        for f in &a.faults {
            let text = match f.time_s() {
                None => fault(f),
                Some(_) => format!("{}: {}", a.name, fault(f)),
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
    for (text, count) in listed.iter().take(FAULTS) {
        out.say(match count {
            1 => format!("- {text}"),
            _ => format!("- {text} ({count} specimens)"),
        });
    }
    if listed.len() > FAULTS {
        let more = listed.len() - FAULTS;
        out.add(format!("- and {more} more (--csv, --json)\n"));
    }
}

/// The report of analyses: curves, readings, moduli, isochrones.
pub fn analyze_page(report: &AnalyzeReport, tests: &Tests) -> Page {
    let mut figures = page::curves(&plotted(tests), "");
    if let Some(figure) = isochronous_figure(&report.isochrones) {
        let caption = "Isochronous curves: load over strain after the same time under load; one point per specimen.";
        figures.push((figure, caption.into()));
    }
    let answers = answers(&tests.analyses);
    let mut page = page::begin("Creep test", answers, &report.conditions, tests, figures);
    page = page::readings(page::repeats(page, &report.groups), tests);
    if !report.isochrones.is_empty() {
        let table = isochrones(&report.isochrones).captioned("Strain of a group's specimens after the same time under different loads, ε ∝ σ^p; p = 1: strain is proportional to load; n: specimens. Load per %: secant at the middle of the loads.");
        page = page.section("Isochronous curves", vec![Block::Table(table)]);
    }
    page::end(page, &report.sources, &report.failures, tests)
}

/// How far each specimen, or of many each group, stretched, and whether it goes on.
fn answers(analyses: &[Analysis]) -> Vec<Headline> {
    if analyses.len() <= FEW {
        return analyses.iter().map(answer).collect();
    }
    let of_group = |g: &Scatter| {
        let (name, n) = (group(&g.group), g.specimens);
        let end = short(100.0 * g.end_strain_ratio);
        Headline::from(format!("{name}: {end} % at the end, mean of {n}"))
    };
    let groups = scatter(analyses);
    groups.iter().take(FEW).map(of_group).collect()
}

/// One row per specimen; %, h and °C as laboratories write them.
pub fn analyze_csv(report: &AnalyzeReport) -> sinew_log::Table {
    let faults = |a: &&Analysis| {
        let all: Vec<String> = a.faults.iter().map(fault).collect();
        all.join("; ")
    };
    Data::of(&report.specimens)
        .text("specimen", |a| a.name.as_str())
        .text("group", |a| group(&a.group))
        .number("force_n", |a| a.force_n)
        .number("stress_mpa", |a| a.stress_pa.map(|s| s * 1e-6))
        .number("temperature_c", |a| a.temperature_c.map(|t| t.mean))
        .number("humidity_percent", |a| a.humidity_percent.map(|h| h.mean))
        .number("duration_s", |a| a.duration_s)
        .number("end_percent", |a| 100.0 * a.end_strain_ratio)
        .number("creep_percent", |a| 100.0 * a.creep_strain_ratio)
        .bounded(["slope_percent_per_h", "slope_low", "slope_high"], |a| {
            a.slope_per_s.map(|s| s.scaled(PERCENT_PER_H))
        })
        .number("saturation_s", |a| a.saturation_s)
        .text("saturated", |a| a.saturated.map(|s| s.to_string()))
        .text("faults", faults)
        .table()
}
