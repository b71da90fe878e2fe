//! Fits of creep laws: criteria, parameters and forecasts.

use super::messages::{
    bracketed, duration, fixed_reason, forecast_conditions, interval_kind, not_converged,
    parameter_name, short, unidentified_range,
};
use super::page::{self, MAX_MEASURED};
use super::picture::plotted;
use super::specimen::answer;
use crate::data::Data;
use crate::text::{self, TerminalText};
use sinew_creep::{
    Analysis, Conditions, CreepError, Fit, FitReport, FitSet, ForecastConditions, Joint, Law,
    Parameter, Tests,
};
use sinew_figure::{Block, Columns, Headline, Page, Table};
use sinew_model::Bounded;

/// Maximum number of fits whose parameters are shown on the terminal.
const MAX_SHOWN: usize = 3;
/// Maximum number of failures that are listed on the terminal.
const MAX_FAILURES: usize = 20;
/// Maximum number of fits with a headline in the report.
const MAX_HEADLINES: usize = 6;

/// Renders the fits for a terminal: criteria, parameters of the best law, forecasts and failures.
pub fn fit_table(report: &FitReport) -> String {
    let fits = &report.fits;
    let mut out = TerminalText::default();
    if fits.len() > MAX_SHOWN {
        out.table(laws(fits));
    } else {
        for set in fits {
            one(&mut out, set);
        }
    }
    let ends = fits.iter().filter_map(|set| Some((set, end(set)?)));
    for (set, (conditions, time_s, strain)) in ends.take(MAX_SHOWN) {
        let hours = text::short(time_s / 3600.0);
        let [percent, low, high] = [strain.value, strain.low, strain.high].map(text::short);
        let (name, under) = (&set.name, forecast_conditions(conditions));
        out.paragraph(format!(
            "{name}: forecast strain after {hours} h {percent} % (95 % prediction interval {low} to {high} %) under {under}; weighted mean of all laws; interval widened by their error at the end of the record, and beyond three times its duration by the creep per decade"
        ));
    }
    for failure in report.failures.iter().take(MAX_FAILURES) {
        let what = match failure.reason {
            CreepError::NoForecast { .. } => "",
            _ => "not fitted: ",
        };
        out.paragraph(format!("- {what}{failure}"));
    }
    if report.failures.len() > MAX_FAILURES {
        let more = report.failures.len() - MAX_FAILURES;
        out.add(format!("- and {more} more (--json)\n"));
    }
    out.0
}

/// Tabulates the laws over many specimens.
fn laws(fits: &[FitSet]) -> Table {
    let of = |law: Law| -> Vec<&Fit> {
        let own = fits
            .iter()
            .filter_map(|f| f.laws.iter().find(|fit| fit.law == law));
        own.collect()
    };
    let tried = Law::ALL.into_iter().chain([Law::Rope]);
    let unidentified = |f: &&&Fit| f.parameters.iter().any(|p| p.not_identifiable.is_some());
    Columns::of(
        tried
            .map(|law| (law, of(law)))
            .filter(|(_, own)| !own.is_empty()),
    )
    .words("law", |(law, _)| law.name())
    .column("fitted", |(_, own)| own.len())
    .column("smallest AICc", |(law, _)| {
        fits.iter().filter(|f| f.laws[0].law == *law).count()
    })
    .column("median residual (%)", |(_, own)| {
        let mut residuals: Vec<f64> = own.iter().map(|f| f.residual_strain_ratio).collect();
        residuals.sort_by(f64::total_cmp);
        text::short(100.0 * residuals[residuals.len() / 2])
    })
    .column("not identifiable", |(_, own)| {
        own.iter().filter(unidentified).count()
    })
    .table()
}

/// Builds the columns with the criteria of the laws of a specimen or group.
fn criteria(laws: &[Fit]) -> Columns<&Fit> {
    let least = laws.iter().map(|f| f.aicc).fold(f64::INFINITY, f64::min);
    Columns::of(laws)
        .words("law", |f| f.law.name())
        .words("strain", |f| f.law.equation())
        .column("ΔAICc", |f| format!("{:.1}", f.aicc - least))
        .column("weight", |f| format!("{:.2}", f.weight))
        .column("residual (%)", |f| {
            text::short(100.0 * f.residual_strain_ratio)
        })
}

/// Builds the columns with the parameters of a law.
fn parameters(fit: &Fit, number: fn(f64) -> String) -> Columns<&Parameter> {
    Columns::of(&fit.parameters)
        .words("parameter", |p| parameter_name(p))
        .column("value", |p| number(p.value))
        .column("std. error", |p| number(p.std_error))
        .column("95 % interval", |p| {
            format!("{} … {}", number(p.low), number(p.high))
        })
        .column("unit", |p| &p.unit)
}

/// States the origin of standard errors and intervals.
fn interval_legend(fit: &Fit) -> String {
    let kind = fit
        .parameters
        .first()
        .map_or("", |p| interval_kind(p.interval));
    format!("std. error: from the covariance; intervals: {kind}")
}

/// Lists the fixed and the not identifiable parameters of a law.
fn restrictions(fit: &Fit) -> Vec<String> {
    let fixed = fit.fixed.iter().map(|h| {
        let (value, reason) = (text::short(h.value), fixed_reason(h.reason));
        format!("{} fixed at {value}: {reason}", h.name)
    });
    let undecided = fit.parameters.iter().filter_map(|p| {
        let reason = unidentified_range(p.not_identifiable?, &p.unit);
        Some(format!(
            "{} not identifiable from this record: {reason}",
            p.name
        ))
    });
    fixed.chain(undecided).collect()
}

/// Renders the laws of a specimen or group, and the parameters of the best law.
fn one(out: &mut TerminalText, set: &FitSet) {
    let best = &set.laws[0];
    out.flat(&set.name);
    out.add("\n");
    out.table(criteria(&set.laws).table());
    out.add(format!("\n{}:\n", best.law.name()));
    out.table(parameters(best, text::short).table());
    out.add(format!("{}\n", interval_legend(best)));
    let unfinished = set.laws.iter().filter_map(|f| {
        let how = not_converged(f)?;
        Some(format!("{}: {how}", f.law.name()))
    });
    for text in restrictions(best).into_iter().chain(unfinished) {
        out.paragraph(format!("- {text}"));
    }
    out.add("\n");
}

/// Returns conditions, end time and strain (%) with prediction interval of a forecast.
fn end(set: &FitSet) -> Option<(&ForecastConditions, f64, Bounded)> {
    let (f, conditions) = (set.forecast.as_ref()?, set.forecast_conditions.as_ref()?);
    let last = f.time_s.len().checked_sub(1)?;
    let strain = Bounded {
        value: f.strain_ratio[last],
        low: f.reading_low_strain_ratio[last],
        high: f.reading_high_strain_ratio[last],
    };
    Some((conditions, f.time_s[last], strain.scaled(100.0)))
}

/// Builds the report of fits; curves show law and forecast if every specimen was fitted alone.
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
    let caption = "Dashed: law with the smallest AICc. Shaded: 95 % prediction interval.";
    let answers = answers(&report.fits, &tests.analyses);
    let curves = page::curves(&all, caption);
    let mut page = page::begin("Creep test", answers, conditions, tests, curves);
    let ends = report.fits.iter().filter_map(|set| Some((set, end(set)?)));
    let forecasts = Columns::of(ends)
        .column("specimen", |(set, _)| &set.name)
        .column("conditions", |(_, end)| forecast_conditions(end.0))
        .column("after", |(_, end)| format!("{} h", short(end.1 / 3600.0)))
        .column("strain (%)", |(_, end)| short(end.2.value))
        .column("from", |(_, end)| short(end.2.low))
        .column("to", |(_, end)| short(end.2.high))
        .captioned("Weighted mean of all laws, 95 % prediction interval; widened by the error of the laws at the end of the record, and beyond three times its duration by the creep per decade.");
    if !forecasts.rows.is_empty() {
        page = page.section("Forecast", vec![forecasts.into()]);
    }
    page = page::readings(page, tests);
    if tests.analyses.len() <= MAX_MEASURED {
        for set in &report.fits {
            let line = format!("{} laws with their parameters, best first", set.laws.len());
            let laws = Block::Folded(line, blocks(&set.laws));
            page = page.section(format!("Laws: {}", set.name), vec![laws]);
        }
    }
    page::end(page, &report.sources, &report.failures, tests)
}

/// Lists laws with their criteria and parameters.
fn blocks(laws: &[Fit]) -> Vec<Block> {
    let bic = |f: &&Fit| format!("{:.1}", f.bic).replace('-', "−");
    let table = criteria(laws).column("BIC", bic);
    let mut blocks = vec![
        table
            .captioned("A smaller AICc is better; a difference above 10 is decisive.")
            .into(),
    ];
    for fit in laws {
        let (law, what) = (fit.law.name(), interval_legend(fit));
        let noise = short(100.0 * fit.residual_strain_ratio);
        let (slow, memory) = (100.0 * fit.noise.share, short(fit.noise.memory.exp()));
        let table = parameters(fit, short).captioned(format!(
            "{law}: {what}; measurement noise {noise} %, {slow:.0} % of its variance correlated (correlated over a factor of {memory} in time)"
        ));
        blocks.push(table.worded(&["unit"]).into());
        if let Some(how) = not_converged(fit) {
            blocks.push(Block::Notice(format!("{law}: {how}.")));
        }
        let restrictions = restrictions(fit);
        if !restrictions.is_empty() {
            blocks.push(Block::List(restrictions));
        }
    }
    blocks
}

/// Makes the headlines: forecast strain, or measured strain and best law.
fn answers(fits: &[FitSet], analyses: &[Analysis]) -> Vec<Headline> {
    let of = |set: &FitSet| {
        let name = &set.name;
        if let Some((conditions, time_s, strain)) = end(set) {
            let (percent, after, under) = (
                bracketed(strain),
                duration(time_s),
                forecast_conditions(conditions),
            );
            return Some(format!(
                "{name}: forecast strain {percent} % after {after} under {under} (95 % prediction interval in brackets)"
            ));
        }
        let best = set.laws.first()?.law.name();
        let measured = analyses.iter().find(|a| a.name == *name);
        let measured = measured.map_or_else(|| name.clone(), |a| answer(a).text);
        Some(format!("{measured}; best law: {best}"))
    };
    let all = fits.iter().take(MAX_HEADLINES).filter_map(of);
    all.map(Headline::from).collect()
}

/// Tabulates the fits, one row per parameter of every law.
pub fn fit_csv(report: &FitReport) -> sinew_log::Table {
    let sets = report.fits.iter();
    let fits = sets.flat_map(|set| set.laws.iter().map(move |fit| (set, fit)));
    Data::of(fits.flat_map(|(set, fit)| fit.parameters.iter().map(move |p| (set, fit, p))))
        .text("name", |(set, _, _)| set.name.as_str())
        .text("law", |(_, fit, _)| fit.law.name())
        .number("aicc", |(_, fit, _)| fit.aicc)
        .number("bic", |(_, fit, _)| fit.bic)
        .text("parameter", |(_, _, p)| p.name.as_str())
        .text("specimen", |(_, _, p)| p.specimen.as_deref())
        .text("unit", |(_, _, p)| p.unit.as_str())
        .number("value", |(_, _, p)| p.value)
        .number("std_error", |(_, _, p)| p.std_error)
        .number("low", |(_, _, p)| p.low)
        .number("high", |(_, _, p)| p.high)
        .text("interval", |(_, _, p)| interval_kind(p.interval))
        .text("not_identifiable", |(_, _, p)| {
            p.not_identifiable
                .map(|what| unidentified_range(what, &p.unit))
        })
        .table()
}
