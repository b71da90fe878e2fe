//! How often forecasts held the end that was hidden from them.

use super::page;
use super::words::short;
use crate::data::Data;
use crate::text::{Told, or_dash};
use sinew_creep::{Conditions, Coverage, Forecaster, Tests, WithheldReport};
use sinew_figure::{Block, Columns, Headline, Level, Page, Table};

/// Said where no law could be held against anything.
const NOTHING_FORECAST: &str = "Nothing was forecast: what is left before the hidden end is too short for every law. Hide a smaller share, or test for longer.";

/// What was hidden, and what the table's numbers are.
fn hidden(report: &WithheldReport) -> String {
    format!(
        "Last {:.0} % of the time hidden; {:.0} % intervals for readings. Error and half width: median at the end, in % of the test's creep.",
        100.0 * report.hidden_share,
        100.0 * report.level
    )
}

/// Shares inside, error and half width; a dash where nothing was forecast.
fn coverage(withheld: &[Coverage]) -> Table {
    let percent = |share: Option<f64>| or_dash(share, |s| format!("{:.1} %", 100.0 * s));
    // A law may have had no interval to be half as wide as.
    let forecast = |c: &Coverage, ratio: f64| {
        let ratio = c.ends_share().map(|_| ratio);
        percent(ratio.filter(|r| r.is_finite()))
    };
    Columns::of(withheld)
        .words("law", |c| c.forecaster.name())
        .column("tests", |c| c.tests)
        .column("too few", |c| c.failed)
        .column("readings inside", |c| percent(c.readings_share()))
        .column("ends inside", |c| percent(c.ends_share()))
        .column("error", |c| forecast(c, c.end_error_ratio))
        .column("half width", |c| forecast(c, c.end_half_width_ratio))
        .table()
}

/// How often forecasts held the hidden end.
pub fn withhold_table(report: &WithheldReport) -> String {
    let mut out = Told::default();
    out.flat(hidden(report));
    out.add("\n");
    out.table(coverage(&report.withheld));
    if !report.forecasts_any() {
        out.add("\n");
        out.flat(NOTHING_FORECAST);
    }
    out.0
}

/// The report of forecasts held against withheld ends.
pub fn withhold_page(report: &WithheldReport, tests: &Tests, conditions: &Conditions) -> Page {
    let answers = answers(&report.withheld);
    let page = page::begin("Creep test", answers, conditions, tests, Vec::new());
    let mut blocks = vec![
        Block::Paragraph(hidden(report) + " A share of 95 % inside would be right."),
        coverage(&report.withheld).into(),
    ];
    if !report.forecasts_any() {
        blocks.push(Block::Notice(NOTHING_FORECAST.into()));
    }
    let page =
        page::readings(page, tests).section("Forecast held against withheld readings", blocks);
    page::end(page, &report.sources, &report.failures, tests)
}

/// How often forecasts held what was hidden from them.
fn answers(withheld: &[Coverage]) -> Vec<Headline> {
    /// A share from here on is as promised.
    const HELD: f64 = 0.9;
    let all = withheld
        .iter()
        .find(|c| c.forecaster == Forecaster::Combined);
    let Some((c, share)) = all.and_then(|c| Some((c, c.readings_share()?))) else {
        return Vec::new();
    };
    let level = if share >= HELD {
        Level::Good
    } else {
        Level::Watch
    };
    let (percent, tests) = (short(100.0 * share), c.tests);
    let text = format!(
        "Of the hidden readings {percent} % lie within the forecasts' 95 % intervals ({tests} tests)"
    );
    vec![Headline::new(level, text)]
}

/// One row per law.
pub fn withhold_csv(report: &WithheldReport) -> sinew_log::Table {
    let percent = |c: &Coverage, ratio: f64| c.ends_share().map(|_| 100.0 * ratio);
    Data::of(&report.withheld)
        .text("law", |c| c.forecaster.name())
        .integer("tests", |c| c.tests)
        .integer("failed", |c| c.failed)
        .number("readings_percent", |c| {
            c.readings_share().map(|s| 100.0 * s)
        })
        .number("end_percent", |c| c.ends_share().map(|s| 100.0 * s))
        .number("end_error_percent", |c| percent(c, c.end_error_ratio))
        .number("end_half_width_percent", |c| {
            percent(c, c.end_half_width_ratio)
        })
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
    fn what_forecasts_held_is_the_answer_and_no_interval_is_a_dash() {
        let answer = |inside| answers(&[of(inside)]).remove(0);
        assert_eq!(
            answer(93).text,
            "Of the hidden readings 93.0 % lie within the forecasts' 95 % intervals (3 tests)"
        );
        assert_eq!(
            (answer(93).level, answer(60).level),
            (Level::Good, Level::Watch)
        );
        let table = Block::Table(coverage(&[of(93)]));
        let page = Page::new("").section("", vec![table]).html();
        assert!(
            page.contains("<td>–</td>") && !page.contains("NaN"),
            "{page}"
        );
    }
}
