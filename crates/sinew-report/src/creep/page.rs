//! The report of a creep test, for a customer.

use super::isochronous::isochronous_figure;
use super::page_tables::{
    coverage_table, fit_blocks, group_table, isochrone_table, odd_blocks, rank_table,
    reading_blocks, recovery_table, result_table, source_blocks, test_table,
};
use super::picture::{Plotted, figure, plotted};
use sinew_creep::{
    Analysis, AnalyzeReport, CompareReport, Conditions, Coverage, Failure, FitReport, FitSet,
    Isochrone, Joint, Rank, Scatter, Source, Tests, WithheldReport, scatter,
};
use sinew_figure::plot::Figure;
use sinew_figure::{Block, Page};

/// Specimens beyond which readings are left to the table file.
const READINGS_OF: usize = 12;

/// What a report shows; empty lists leave their section out.
#[derive(Debug, Default)]
struct Contents<'a> {
    /// Heading.
    title: String,
    /// Raw data.
    sources: &'a [Source],
    /// What the laboratory states.
    conditions: Conditions,
    /// Specimens.
    analyses: &'a [Analysis],
    /// Ropes in the order of their strain.
    ranks: &'a [Rank],
    /// Repeats.
    groups: &'a [Scatter],
    /// Strain against load at the same times.
    isochrones: &'a [Isochrone],
    /// Laws fitted, per specimen or group.
    fits: &'a [FitSet],
    /// Forecasts held against withheld readings.
    withheld: &'a [Coverage],
    /// What couldn't be analysed, with the reason.
    failures: &'a [Failure],
    /// Figures with the line under them.
    figures: Vec<(Figure, String)>,
}

/// The report of analyses: curves, readings, moduli, isochrones.
pub fn analyze_page(report: &AnalyzeReport, tests: &Tests) -> Page {
    let mut figures = curves(&plotted(tests), "");
    if let Some(figure) = isochronous_figure(&report.isochrones) {
        let caption = "Isochronous curves: load over strain after the same time under load; one point per specimen.";
        figures.push((figure, caption.into()));
    }
    page(Contents {
        title: "Creep test".to_owned(),
        sources: &report.sources,
        conditions: report.conditions.clone(),
        analyses: &report.specimens,
        groups: &report.groups,
        isochrones: &report.isochrones,
        failures: &report.failures,
        figures,
        ..Contents::default()
    })
}

/// The report of a comparison.
pub fn compare_page(report: &CompareReport, tests: &Tests, conditions: Conditions) -> Page {
    // Specimens of no group are ropes of their own, not repeats.
    let repeats = tests.analyses.iter().filter(|a| a.group.is_some());
    page(Contents {
        title: "Creep of ropes compared".to_owned(),
        sources: &report.sources,
        conditions,
        analyses: &tests.analyses,
        ranks: &report.ranks,
        groups: &scatter(repeats),
        failures: &report.failures,
        figures: vec![(figure("", &plotted(tests), false), String::new())],
        ..Contents::default()
    })
}

/// The report of fits; where every specimen was fitted alone, curves show law and forecast.
pub fn fit_page(report: &FitReport, tests: &Tests, joint: Joint, conditions: Conditions) -> Page {
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
    page(Contents {
        title: "Creep test".to_owned(),
        sources: &report.sources,
        conditions,
        analyses: &tests.analyses,
        fits: &report.fits,
        failures: &report.failures,
        figures: curves(
            &all,
            "Dashed: the law of smallest AICc. Shaded: where a reading lies.",
        ),
        ..Contents::default()
    })
}

/// The report of forecasts held against withheld ends.
pub fn withhold_page(report: &WithheldReport, tests: &Tests, conditions: Conditions) -> Page {
    page(Contents {
        title: "Creep test".to_owned(),
        sources: &report.sources,
        conditions,
        analyses: &tests.analyses,
        withheld: &report.withheld,
        failures: &report.failures,
        ..Contents::default()
    })
}

/// Curves over time and over its logarithm.
fn curves(plotted: &[Plotted<'_>], caption: &str) -> Vec<(Figure, String)> {
    vec![
        (figure("", plotted, false), caption.to_owned()),
        (figure("", plotted, true), String::new()),
    ]
}

/// Builds the page.
fn page(contents: Contents<'_>) -> Page {
    let Contents {
        title,
        sources,
        conditions,
        analyses,
        ranks,
        groups,
        isochrones,
        fits,
        withheld,
        failures,
        figures,
    } = contents;
    let mut page = Page::new(title);
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    page.subtitle = format!(
        "{} from {}",
        plural(analyses.len(), "specimen"),
        plural(sources.len(), "file")
    );
    page.footer = format!("Sinew {}", env!("CARGO_PKG_VERSION"));
    page = page.section(
        "Test",
        vec![Block::Table(test_table(&conditions, analyses))],
    );
    let mut blocks: Vec<Block> = figures
        .into_iter()
        .map(|(figure, caption)| Block::Figure(Box::new(figure), caption))
        .collect();
    blocks.push(Block::Table(result_table(analyses)));
    page = page.section("Creep", blocks);
    if !ranks.is_empty() {
        page = page.section("Ranking", vec![Block::Table(rank_table(ranks))]);
    }
    if groups.iter().any(|g| g.specimens > 1) {
        page = page.section("Groups", vec![Block::Table(group_table(groups))]);
    }
    if analyses.len() <= READINGS_OF {
        let blocks = reading_blocks(analyses);
        if !blocks.is_empty() {
            page = page.section("Readings", blocks);
        }
    }
    if let Some(table) = recovery_table(analyses) {
        page = page.section("Recovery", vec![Block::Table(table)]);
    }
    if !isochrones.is_empty() {
        page = page.section(
            "Isochronous curves",
            vec![Block::Table(isochrone_table(isochrones))],
        );
    }
    if analyses.len() <= READINGS_OF {
        for set in fits {
            page = page.section(format!("Laws: {}", set.name), fit_blocks(&set.laws));
        }
    }
    if !withheld.is_empty() {
        page = page.section("Forecast held against withheld readings", vec![
            Block::Paragraph("The end of every test was hidden from the fit; a share of 95 % inside would be right.".into()),
            Block::Table(coverage_table(withheld)),
        ]);
    }
    let odd = odd_blocks(failures, analyses);
    if !odd.is_empty() {
        page = page.section("What is odd about the records", odd);
    }
    page.section("Raw data", source_blocks(sources))
}
