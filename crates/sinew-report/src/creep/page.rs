//! The report of a creep test, for a customer.

use super::answers::{of_analyses, of_fits, of_ranks, of_withheld};
use super::isochronous::isochronous_figure;
use super::page_tables::{
    coverage_table, fit_blocks, forecast_table, group_table, isochrone_table, odd_blocks,
    rank_table, reading_blocks, recovery_table, result_table, source_blocks, test_table,
};
use super::picture::{Plotted, figure, plotted};
use super::terminal::NOTHING_FORECAST;
use sinew_creep::{
    AnalyzeReport, CompareReport, Conditions, Failure, FitReport, Joint, Scatter, Source, Tests,
    WithheldReport, scatter,
};
use sinew_figure::plot::Figure;
use sinew_figure::{Block, Headline, Page};

/// Specimens beyond which readings are left to the table file.
const READINGS_OF: usize = 12;

/// The report of analyses: curves, readings, moduli, isochrones.
pub fn analyze_page(report: &AnalyzeReport, tests: &Tests) -> Page {
    let mut figures = curves(&plotted(tests), "");
    if let Some(figure) = isochronous_figure(&report.isochrones) {
        let caption = "Isochronous curves: load over strain after the same time under load; one point per specimen.";
        figures.push((figure, caption.into()));
    }
    let answers = of_analyses(&tests.analyses);
    let mut page = begin("Creep test", answers, &report.conditions, tests, figures);
    page = repeats(page, &report.groups);
    page = readings(page, tests);
    if !report.isochrones.is_empty() {
        let table = isochrone_table(&report.isochrones);
        page = page.section("Isochronous curves", vec![table.into()]);
    }
    end(page, &report.sources, &report.failures, tests)
}

/// The report of a comparison.
pub fn compare_page(report: &CompareReport, tests: &Tests, conditions: &Conditions) -> Page {
    // Specimens of no group are ropes of their own, not repeats.
    let grouped = tests.analyses.iter().filter(|a| a.group.is_some());
    let figures = vec![(figure("", &plotted(tests), false), String::new())];
    let mut page = begin(
        "Creep of ropes compared",
        of_ranks(&report.ranks),
        conditions,
        tests,
        figures,
    );
    if !report.ranks.is_empty() {
        page = page.section("Ranking", vec![rank_table(&report.ranks).into()]);
    }
    page = readings(repeats(page, &scatter(grouped)), tests);
    end(page, &report.sources, &report.failures, tests)
}

/// The report of fits; where every specimen was fitted alone, curves show law and forecast.
pub fn fit_page(report: &FitReport, tests: &Tests, joint: Joint, conditions: &Conditions) -> Page {
    let mut all = plotted(tests);
    if joint == Joint::None {
        for p in &mut all {
            let Some(set) = report.fits.iter().find(|f| f.name == p.name) else {
                continue;
            };
            let best = set.laws.first();
            p.fitted = best.map(|best| best.strain(0, &p.curve.time_s));
            p.forecast.clone_from(&set.forecast);
        }
    }
    let caption = "Dashed: the law of smallest AICc. Shaded: where a reading lies.";
    let answers = of_fits(&report.fits, &tests.analyses);
    let mut page = begin(
        "Creep test",
        answers,
        conditions,
        tests,
        curves(&all, caption),
    );
    if let Some(table) = forecast_table(&report.fits) {
        page = page.section("Forecast", vec![table.into()]);
    }
    page = readings(page, tests);
    if tests.analyses.len() <= READINGS_OF {
        for set in &report.fits {
            let line = format!("{} laws, best first, with their parameters", set.laws.len());
            let laws = Block::Folded(line, fit_blocks(&set.laws));
            page = page.section(format!("Laws: {}", set.name), vec![laws]);
        }
    }
    end(page, &report.sources, &report.failures, tests)
}

/// The report of forecasts held against withheld ends.
pub fn withhold_page(report: &WithheldReport, tests: &Tests, conditions: &Conditions) -> Page {
    let answers = of_withheld(&report.withheld);
    let page = begin("Creep test", answers, conditions, tests, Vec::new());
    let mut blocks = vec![
        Block::Paragraph(
            "The end of every test was hidden from the fit; a share of 95 % inside would be right."
                .into(),
        ),
        coverage_table(&report.withheld).into(),
    ];
    if !report.forecasts_any() {
        blocks.push(Block::Notice(NOTHING_FORECAST.into()));
    }
    let page = readings(page, tests).section("Forecast held against withheld readings", blocks);
    end(page, &report.sources, &report.failures, tests)
}

/// Curves over time and over its logarithm.
fn curves(plotted: &[Plotted<'_>], caption: &str) -> Vec<(Figure, String)> {
    vec![
        (figure("", plotted, false), caption.to_owned()),
        (figure("", plotted, true), String::new()),
    ]
}

/// The answers, the curves with the line under each figure, what was tested.
fn begin(
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
    blocks.push(result_table(analyses).into());
    if !answers.is_empty() {
        page = page.section("", vec![Block::Headlines(answers)]);
    }
    page.section("Creep", blocks)
        .section("Test", vec![test_table(conditions, analyses).into()])
}

/// How specimens of a group differ, where one has several.
fn repeats(page: Page, groups: &[Scatter]) -> Page {
    if groups.iter().any(|g| g.specimens > 1) {
        page.section("Groups", vec![group_table(groups).into()])
    } else {
        page
    }
}

/// Readings of a few specimens, and what came back when the load fell.
fn readings(mut page: Page, tests: &Tests) -> Page {
    let blocks = reading_blocks(&tests.analyses);
    if tests.analyses.len() <= READINGS_OF && !blocks.is_empty() {
        page = page.section("Readings", blocks);
    }
    match recovery_table(&tests.analyses) {
        Some(table) => page.section("Recovery", vec![table.into()]),
        None => page,
    }
}

/// What is odd, and the raw data.
fn end(mut page: Page, sources: &[Source], failures: &[Failure], tests: &Tests) -> Page {
    let odd = odd_blocks(failures, &tests.analyses);
    if !odd.is_empty() {
        page = page.section("What is odd about the records", odd);
    }
    page.section("Raw data", source_blocks(sources))
}
