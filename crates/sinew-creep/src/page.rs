//! The report of a creep test, for a customer.

use super::analyze::{Analysis, Scatter};
use super::fit::Fit;
use super::isochronous::Isochrone;
use super::page_tables::{
    coverage_table, fit_blocks, group_table, isochrone_table, odd_blocks, rank_table,
    reading_blocks, recovery_table, result_table, source_blocks, test_table,
};
use super::rank::Rank;
use super::withhold::Coverage;
use sinew_figure::plot::Figure;
use sinew_figure::{Block, Page};

/// What the file can't say, as the laboratory states it.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct Conditions {
    /// Standard followed.
    pub standard: String,
    /// What was done to the specimens before.
    pub preconditioning: Option<String>,
    /// Atmosphere, conditioning time, grips, how extension was measured.
    pub conditions: Option<String>,
}

/// A raw data file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Source {
    /// File as named.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Columns used: quantity, header, unit.
    pub columns: Vec<[String; 3]>,
    /// Assumptions made when reading it.
    pub notes: Vec<String>,
}

/// Specimens beyond which readings are left to the table file.
const READINGS_OF: usize = 12;

/// What a report tells; empty lists leave their section out.
#[derive(Debug, Default)]
pub struct Contents<'a> {
    /// Heading.
    pub title: String,
    /// Raw data.
    pub sources: &'a [Source],
    /// What the laboratory states.
    pub conditions: Conditions,
    /// Specimens.
    pub analyses: &'a [Analysis],
    /// Ropes in the order of their strain.
    pub ranks: &'a [Rank],
    /// Repeats.
    pub groups: &'a [Scatter],
    /// Strain against load at the same times.
    pub isochrones: &'a [Isochrone],
    /// Laws fitted, per specimen or group.
    pub fits: &'a [(String, Vec<Fit>)],
    /// Forecasts held against withheld readings.
    pub withheld: &'a [Coverage],
    /// What couldn't be analysed, with the reason.
    pub failures: &'a [String],
    /// Figures with the line under them.
    pub figures: Vec<(Figure, String)>,
}

/// Builds the page.
pub fn page(contents: Contents<'_>) -> Page {
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
        for (name, fits) in fits {
            page = page.section(format!("Laws: {name}"), fit_blocks(fits));
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
