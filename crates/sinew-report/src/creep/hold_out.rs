//! Hold-out validation of creep forecasts.

use super::messages::short;
use super::page;
use crate::data::Data;
use crate::text::{TerminalText, or_dash};
use sinew_creep::{Conditions, Coverage, Forecaster, HoldOutReport, Tests};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table};

/// Message if no law could be validated.
const NO_FORECAST: &str = "No forecast: the remaining record is too short for every law. Hold out a smaller share, or test longer.";

/// States the held-out share, and explains the columns of the table.
fn legend(report: &HoldOutReport) -> String {
    format!(
        "Last {:.0} % of the time held out; {:.0} % prediction intervals. Error and half-width: median at the end of the test, in % of its creep.",
        100.0 * report.held_out_share,
        100.0 * report.level
    )
}

/// Tabulates coverage, error and half-width per law; a dash without a forecast.
fn coverage(held_out: &[Coverage]) -> Table {
    let percent = |share: Option<f64>| or_dash(share, |s| format!("{:.1} %", 100.0 * s));
    // A law may have no interval.
    let forecast = |c: &Coverage, ratio: f64| {
        let ratio = c.ends_share().map(|_| ratio);
        percent(ratio.filter(|r| r.is_finite()))
    };
    Columns::of(held_out)
        .words("law", |c| c.forecaster.name())
        .column("tests", |c| c.tests)
        .column("failed", |c| c.failed)
        .column("coverage", |c| percent(c.readings_share()))
        .column("coverage at end", |c| percent(c.ends_share()))
        .column("error", |c| forecast(c, c.end_error_ratio))
        .column("half-width", |c| forecast(c, c.end_half_width_ratio))
        .table()
}

/// Renders the coverage of the forecasts for a terminal.
pub fn hold_out_table(report: &HoldOutReport) -> String {
    let mut out = TerminalText::default();
    out.flat(legend(report));
    out.add("\n");
    out.table(coverage(&report.held_out));
    if !report.forecasts_any() {
        out.add("\n");
        out.flat(NO_FORECAST);
    }
    out.0
}

/// Builds the report of a hold-out validation.
pub fn hold_out_page(report: &HoldOutReport, tests: &Tests, conditions: &Conditions) -> Page {
    let answers = answers(&report.held_out);
    let page = page::begin("Creep test", answers, conditions, tests, Vec::new());
    let mut blocks = vec![
        Block::Paragraph(legend(report) + " The nominal coverage is 95 %."),
        coverage(&report.held_out).into(),
    ];
    if !report.forecasts_any() {
        blocks.push(Block::Notice(NO_FORECAST.into()));
    }
    let page = page::readings(page, tests).section("Hold-out validation", blocks);
    page::end(page, &report.sources, &report.failures, tests)
}

/// Makes the headline: coverage of the combined forecast.
fn answers(held_out: &[Coverage]) -> Vec<Headline> {
    /// Minimum acceptable coverage of 95 % intervals.
    const MIN_COVERAGE: f64 = 0.9;
    let all = held_out
        .iter()
        .find(|c| c.forecaster == Forecaster::Combined);
    let Some((c, share)) = all.and_then(|c| Some((c, c.readings_share()?))) else {
        return Vec::new();
    };
    let level = if share >= MIN_COVERAGE {
        Level::Good
    } else {
        Level::Watch
    };
    let (percent, tests) = (short(100.0 * share), c.tests);
    let text = format!(
        "Coverage of the 95 % prediction intervals: {percent} % of the held-out measurements ({tests} tests)"
    );
    vec![Headline::new(level, text)]
}

/// Tabulates the validation, one row per law.
pub fn hold_out_csv(report: &HoldOutReport) -> sinew_log::Table {
    let ratio = |c: &Coverage, ratio: f64| c.ends_share().map(|_| ratio);
    Data::of(&report.held_out)
        .text("law", |c| c.forecaster.name())
        .integer("tests", |c| c.tests)
        .integer("failed", |c| c.failed)
        .integer("readings", |c| c.readings)
        .integer("readings_inside", |c| c.readings_inside)
        .integer("ends_inside", |c| c.ends_inside)
        .number("end_error_ratio", |c| ratio(c, c.end_error_ratio))
        .number("end_half_width_ratio", |c| ratio(c, c.end_half_width_ratio))
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(readings_inside: usize) -> Coverage {
        Coverage {
            forecaster: Forecaster::Combined,
            tests: 3,
            failed: 0,
            readings: 100,
            readings_inside,
            ends_inside: 3,
            end_error_ratio: 0.01,
            end_half_width_ratio: f64::NAN,
        }
    }

    #[test]
    fn headline_states_coverage_missing_interval_is_dash() {
        let answer = |inside| answers(&[of(inside)]).remove(0);
        assert_eq!(
            answer(93).text,
            "Coverage of the 95 % prediction intervals: 93.0 % of the held-out measurements (3 tests)"
        );
        assert_eq!(
            (answer(93).level, answer(60).level),
            (Level::Good, Level::Watch)
        );
        let table = Block::Table(coverage(&[of(93)]));
        let page = Page::new("").section("", vec![table]).html();
        assert!(page.contains(">–</td>") && !page.contains("NaN"), "{page}");
    }
}
