//! Comparison of ropes by strain.

use super::messages::{bracketed, duration, scatter_source, slope};
use super::page;
use super::picture::{figure, plotted};
use crate::data::Data;
use crate::text::{TerminalText, short};
use sinew_creep::{CompareReport, Conditions, Rank, ScatterSource, Tests, scatter};
use sinew_figure::{Columns, Headline, Level, Page};
use sinew_log::Table;

/// Builds the columns with rank, strain and slope of the ropes.
fn ranks(ranks: &[Rank]) -> Columns<&Rank> {
    Columns::of(ranks)
        .words("rank", |r| r.rank)
        .words("rope", |r| &r.name)
        .column("n", |r| r.specimens)
        .columns(["strain (%)", "95 % interval"], |r| {
            let strain = r.strain_ratio.scaled(100.0);
            let (low, high) = (strain.low, strain.high);
            [
                format!("{:.4}", strain.value),
                format!("{low:.4} … {high:.4}"),
            ]
        })
        .columns(["m_E (%/h)", "95 % interval"], |r| slope(r.slope_per_s))
}

/// Renders the ranking for a terminal, and the assumption for the intervals of single specimens.
pub fn compare_table(report: &CompareReport) -> String {
    let at = report.ranks.first().map_or(f64::NAN, |r| r.at_s / 60.0);
    let mut out = TerminalText(format!(
        "strain after {} min, in ascending order\n\n",
        short(at)
    ));
    out.table(ranks(&report.ranks).table());
    if let Some(single) = report.ranks.iter().find(|r| r.specimens == 1) {
        let from = match single.scatter_source {
            ScatterSource::OtherRopes => "from the repeats of the other ropes",
            ScatterSource::Stated => "as specified",
            _ => "assumed; specify --scatter, or test repeats",
        };
        let percent = short(100.0 * single.scatter_share);
        out.add("\n");
        out.flat(format!(
            "n = 1: the interval includes a scatter between specimens of {percent} %, {from}."
        ));
    }
    out.0
}

/// Builds the report of a comparison.
pub fn compare_page(report: &CompareReport, tests: &Tests, conditions: &Conditions) -> Page {
    // Specimens without a group are different ropes, not repeats.
    let grouped = tests.analyses.iter().filter(|a| a.group.is_some());
    let figures = vec![(figure("", &plotted(tests), false), String::new())];
    let title = "Creep comparison";
    let mut page = page::begin(title, answers(&report.ranks), conditions, tests, figures);
    if let Some(first) = report.ranks.first() {
        let between = |r: &&Rank| {
            let source = scatter_source(r.scatter_source);
            format!("{} %, {source}", short(100.0 * r.scatter_share))
        };
        let table = ranks(&report.ranks)
            .column("scatter", between)
            .captioned(format!(
                "Strain after {} min with the 95 % interval of the mean of a rope. Rank: one plus the number of ropes whose whole interval is below.",
                short(first.at_s / 60.0)
            ));
        page = page.section("Ranking", vec![table.into()]);
    }
    page = page::readings(page::repeats(page, &scatter(grouped)), tests);
    page::end(page, &report.sources, &report.failures, tests)
}

/// Returns the headlines, which list the ropes with the smallest strain that are not distinguishable by their
/// intervals.
fn answers(ranks: &[Rank]) -> Vec<Headline> {
    let first: Vec<&Rank> = ranks.iter().filter(|r| r.rank == 1).collect();
    let percent = |r: &Rank| bracketed(r.strain_ratio.scaled(100.0));
    let after = first.first().map_or(String::new(), |r| duration(r.at_s));
    let answer = match first.as_slice() {
        [] => return Vec::new(),
        [one] => Headline::new(
            Level::Good,
            format!(
                "{}: smallest strain, {} % after {after} (95 % interval in brackets)",
                one.name,
                percent(one)
            ),
        ),
        _ => {
            let strain = |r: &&Rank| format!("{}: {} %", r.name, percent(r));
            let strains: Vec<String> = first.iter().map(strain).collect();
            let (n, strains) = (first.len(), strains.join("; "));
            Headline::new(
                Level::Open,
                format!(
                    "Smallest strain inconclusive among {n} ropes: {strains} after {after} (95 % intervals in brackets)"
                ),
            )
        }
    };
    let mut out = vec![answer];
    let assumed = |r: &&Rank| r.scatter_source == ScatterSource::Assumed;
    if first.iter().any(assumed) {
        out.push(Headline::new(
            Level::Open,
            "Scatter between specimens is assumed; test repeats of each rope",
        ));
    }
    out
}

/// Tabulates the comparison in SI units, one row per rope.
pub fn compare_csv(report: &CompareReport) -> Table {
    let strain = ["strain_ratio", "strain_low_ratio", "strain_high_ratio"];
    let slope = ["slope_per_s", "slope_low_per_s", "slope_high_per_s"];
    Data::of(&report.ranks)
        .integer("rank", |r| r.rank)
        .text("rope", |r| r.name.as_str())
        .integer("specimens", |r| r.specimens)
        .bounded(strain, |r| Some(r.strain_ratio))
        .bounded(slope, |r| r.slope_per_s)
        .number("scatter_share", |r| r.scatter_share)
        .text("scatter_source", |r| scatter_source(r.scatter_source))
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_model::Bounded;

    #[test]
    fn headline_overlapping_intervals_is_inconclusive() {
        let rank = |name: &str, rank| Rank {
            rank,
            name: name.into(),
            specimens: 3,
            at_s: 3600.0,
            strain_ratio: Bounded {
                value: 0.005,
                low: 0.004,
                high: 0.006,
            },
            slope_per_s: None,
            scatter_share: 0.1,
            scatter_source: ScatterSource::Repeats,
        };
        let distinct = answers(&[rank("A", 1), rank("B", 2)]);
        assert_eq!(
            distinct[0].text,
            "A: smallest strain, 0.500 (0.400 to 0.600) % after 60.0 min (95 % interval in brackets)"
        );
        let equal = answers(&[rank("A", 1), rank("B", 1)]);
        assert_eq!((equal.len(), equal[0].level), (1, Level::Open));
        assert!(equal[0].text.contains("inconclusive"), "{}", equal[0].text);
    }
}
