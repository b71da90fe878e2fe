//! Ropes in the order of their strain.

use super::page;
use super::picture::{figure, plotted};
use super::words::{bracketed, duration, scatter_source, slope};
use crate::data::Data;
use crate::text::{Told, short};
use sinew_creep::{CompareReport, Conditions, PERCENT_PER_H, Rank, ScatterSource, Tests, scatter};
use sinew_figure::{Columns, Headline, Level, Page};
use sinew_log::Table;

/// Ropes by their strain.
fn ranks(ranks: &[Rank]) -> Columns<&Rank> {
    Columns::of(ranks)
        .words("rank", |r| r.rank)
        .words("rope", |r| &r.name)
        .column("n", |r| r.specimens)
        .columns(["strain, %", "interval"], |r| {
            let strain = r.strain_ratio.scaled(100.0);
            let (low, high) = (strain.low, strain.high);
            [
                format!("{:.4}", strain.value),
                format!("{low:.4} … {high:.4}"),
            ]
        })
        .columns(["m_E, %/h", "interval"], |r| slope(r.slope_per_s))
}

/// Ropes by their strain, and what the intervals of single specimens rest on.
pub fn compare_table(report: &CompareReport) -> String {
    let at = report.ranks.first().map_or(f64::NAN, |r| r.at_s / 60.0);
    let mut out = Told(format!("strain after {} min, least first\n\n", short(at)));
    out.table(ranks(&report.ranks).table());
    if let Some(single) = report.ranks.iter().find(|r| r.specimens == 1) {
        let from = match single.scatter_source {
            ScatterSource::OtherRopes => "that of the other ropes' repeats",
            ScatterSource::Stated => "as stated",
            _ => "a starting guess; --scatter states your own, repeats measure it",
        };
        let percent = short(100.0 * single.scatter_share);
        out.add("\n");
        out.flat(format!(
            "One specimen can't tell how specimens differ: where n is 1 the interval takes {percent} % between specimens, {from}."
        ));
    }
    out.0
}

/// The report of a comparison.
pub fn compare_page(report: &CompareReport, tests: &Tests, conditions: &Conditions) -> Page {
    // Specimens of no group are ropes of their own, not repeats.
    let grouped = tests.analyses.iter().filter(|a| a.group.is_some());
    let figures = vec![(figure("", &plotted(tests), false), String::new())];
    let title = "Creep of ropes compared";
    let mut page = page::begin(title, answers(&report.ranks), conditions, tests, figures);
    if let Some(first) = report.ranks.first() {
        let between = |r: &&Rank| {
            let source = scatter_source(r.scatter_source);
            format!("{} %, {source}", short(100.0 * r.scatter_share))
        };
        let table = ranks(&report.ranks)
            .column("between specimens", between)
            .captioned(format!(
                "Strain after {} min; intervals are 95 % of a rope's mean. A rank is one more than the ropes whose whole interval lies below.",
                short(first.at_s / 60.0)
            ));
        page = page.section("Ranking", vec![table.into()]);
    }
    page = page::readings(page::repeats(page, &scatter(grouped)), tests);
    page::end(page, &report.sources, &report.failures, tests)
}

/// Which ropes stretched least, as far as that is shown.
fn answers(ranks: &[Rank]) -> Vec<Headline> {
    let first: Vec<&Rank> = ranks.iter().filter(|r| r.rank == 1).collect();
    let percent = |r: &Rank| bracketed(r.strain_ratio.scaled(100.0));
    let after = first.first().map_or(String::new(), |r| duration(r.at_s));
    let answer = match first.as_slice() {
        [] => return Vec::new(),
        [one] => Headline::new(
            Level::Good,
            format!(
                "{} stretched least: {} % after {after} (95 % in brackets)",
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
                    "Which of {n} ropes stretches least can't be told: {strains} after {after} (95 % in brackets)"
                ),
            )
        }
    };
    let mut out = vec![answer];
    let guess = |r: &&Rank| r.scatter_source == ScatterSource::StartingGuess;
    if first.iter().any(guess) {
        out.push(Headline::new(
            Level::Open,
            "How much specimens of a rope differ is a guess: test repeats of each",
        ));
    }
    out
}

/// One row per rope.
pub fn compare_csv(report: &CompareReport) -> Table {
    Data::of(&report.ranks)
        .integer("rank", |r| r.rank)
        .text("rope", |r| r.name.as_str())
        .integer("specimens", |r| r.specimens)
        .bounded(["strain_percent", "strain_low", "strain_high"], |r| {
            Some(r.strain_ratio.scaled(100.0))
        })
        .bounded(["slope_percent_per_h", "slope_low", "slope_high"], |r| {
            r.slope_per_s.map(|s| s.scaled(PERCENT_PER_H))
        })
        .number("scatter_share", |r| r.scatter_share)
        .text("scatter_source", |r| scatter_source(r.scatter_source))
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_model::Bounded;

    #[test]
    fn ropes_that_cannot_be_told_apart_are_not_ranked_in_the_headline() {
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
        let apart = answers(&[rank("A", 1), rank("B", 2)]);
        assert_eq!(
            apart[0].text,
            "A stretched least: 0.500 (0.400 to 0.600) % after 60.0 min (95 % in brackets)"
        );
        let alike = answers(&[rank("A", 1), rank("B", 1)]);
        assert_eq!((alike.len(), alike[0].level), (1, Level::Open));
        assert!(alike[0].text.contains("can't be told"), "{}", alike[0].text);
    }
}
