//! Fits of creep laws: criteria, parameters, forecasts.

use super::page::{self, READINGS_OF};
use super::picture::plotted;
use super::specimen::answer;
use super::words::{
    ahead, bracketed, duration, interval_kind, not_converged, open, parameter_name, short,
    why_fixed,
};
use crate::data::Data;
use crate::text::{self, Told};
use sinew_creep::{
    Analysis, Conditions, CreepError, Fit, FitReport, FitSet, ForecastConditions, Joint, Law,
    Parameter, Tests,
};
use sinew_figure::{Block, Columns, Headline, Page, Table};
use sinew_model::Bounded;

/// Fits beyond which the terminal leaves parameters to the table file.
const SHOWN: usize = 3;
/// Failures that the terminal lists.
const FAILURES: usize = 20;
/// Fits that answer.
const FEW: usize = 6;

/// Laws with their criteria, the best one's parameters, forecasts and failures.
pub fn fit_table(report: &FitReport) -> String {
    let fits = &report.fits;
    let mut out = Told::default();
    if fits.len() > SHOWN {
        out.table(laws(fits));
    } else {
        for set in fits {
            one(&mut out, set);
        }
    }
    let ends = fits.iter().filter_map(|set| Some((set, end(set)?)));
    for (set, (conditions, time_s, strain)) in ends.take(SHOWN) {
        let hours = text::short(time_s / 3600.0);
        let [percent, low, high] = [strain.value, strain.low, strain.high].map(text::short);
        let (name, under) = (&set.name, ahead(conditions));
        out.say(format!(
            "{name}: after {hours} h {percent} % ({low} to {high} %) under {under}; all laws weighed, the interval widened by how far they missed the record's own end and, beyond three times its length, by what every decade of it brought"
        ));
    }
    for failure in report.failures.iter().take(FAILURES) {
        let what = match failure.reason {
            CreepError::NoForecast { .. } => "",
            _ => "not fitted: ",
        };
        out.say(format!("- {what}{failure}"));
    }
    if report.failures.len() > FAILURES {
        let more = report.failures.len() - FAILURES;
        out.add(format!("- and {more} more (--json)\n"));
    }
    out.0
}

/// One line per law over many specimens.
fn laws(fits: &[FitSet]) -> Table {
    let of = |law: Law| -> Vec<&Fit> {
        let own = fits
            .iter()
            .filter_map(|f| f.laws.iter().find(|fit| fit.law == law));
        own.collect()
    };
    let tried = Law::ALL.into_iter().chain([Law::Rope]);
    let untold = |f: &&&Fit| f.parameters.iter().any(|p| p.not_identifiable.is_some());
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
    .column("median residual, %", |(_, own)| {
        let mut residuals: Vec<f64> = own.iter().map(|f| f.residual_strain_ratio).collect();
        residuals.sort_by(f64::total_cmp);
        text::short(100.0 * residuals[residuals.len() / 2])
    })
    .column("with untold parameters", |(_, own)| {
        own.iter().filter(untold).count()
    })
    .table()
}

/// The laws of one specimen or group.
fn criteria(laws: &[Fit]) -> Columns<&Fit> {
    let least = laws.iter().map(|f| f.aicc).fold(f64::INFINITY, f64::min);
    Columns::of(laws)
        .words("law", |f| f.law.name())
        .words("strain", |f| f.law.equation())
        .column("ΔAICc", |f| format!("{:.1}", f.aicc - least))
        .column("weight", |f| format!("{:.2}", f.weight))
        .column("residual, %", |f| {
            text::short(100.0 * f.residual_strain_ratio)
        })
}

/// The parameters of a law.
fn parameters(fit: &Fit, number: fn(f64) -> String) -> Columns<&Parameter> {
    Columns::of(&fit.parameters)
        .words("parameter", |p| parameter_name(p))
        .column("value", |p| number(p.value))
        .column("std. error", |p| number(p.std_error))
        .column("interval", |p| {
            format!("{} … {}", number(p.low), number(p.high))
        })
        .column("unit", |p| &p.unit)
}

/// What the parameters' errors and intervals are.
fn by_what(fit: &Fit) -> String {
    let kind = fit
        .parameters
        .first()
        .map_or("", |p| interval_kind(p.interval));
    format!("std. errors from the covariance, intervals by {kind}")
}

/// What a law's parameters were not free to be, and what the record leaves open of them.
fn restrictions(fit: &Fit) -> Vec<String> {
    let fixed = fit.fixed.iter().map(|h| {
        let (value, why) = (text::short(h.value), why_fixed(h.why));
        format!("{} is held at {value}: {why}", h.name)
    });
    let undecided = fit.parameters.iter().filter_map(|p| {
        let why = open(p.not_identifiable?, &p.unit);
        Some(format!(
            "{} is not identifiable from this record: {why}",
            p.name
        ))
    });
    fixed.chain(undecided).collect()
}

/// The laws of one specimen or group, and the parameters of the best.
fn one(out: &mut Told, set: &FitSet) {
    let best = &set.laws[0];
    out.flat(&set.name);
    out.add("\n");
    out.table(criteria(&set.laws).table());
    out.add(format!("\n{}:\n", best.law.name()));
    out.table(parameters(best, text::short).table());
    out.add(format!("{}\n", by_what(best)));
    let unfinished = set.laws.iter().filter_map(|f| {
        let how = not_converged(f)?;
        Some(format!("{}: {how}", f.law.name()))
    });
    for text in restrictions(best).into_iter().chain(unfinished) {
        out.say(format!("- {text}"));
    }
    out.add("\n");
}

/// Where a forecast ends, under what, and the percent that a reading will then show.
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
    let answers = answers(&report.fits, &tests.analyses);
    let curves = page::curves(&all, caption);
    let mut page = page::begin("Creep test", answers, conditions, tests, curves);
    let ends = report.fits.iter().filter_map(|set| Some((set, end(set)?)));
    let forecasts = Columns::of(ends)
        .column("specimen", |(set, _)| &set.name)
        .column("under", |(_, end)| ahead(end.0))
        .column("after", |(_, end)| format!("{} h", short(end.1 / 3600.0)))
        .column("strain, %", |(_, end)| short(end.2.value))
        .column("from", |(_, end)| short(end.2.low))
        .column("to", |(_, end)| short(end.2.high))
        .captioned("All laws weighed; the interval of a reading, widened by how far the laws missed the record's own end. Beyond three times its length it grows by what every decade of the record brought.");
    if !forecasts.rows.is_empty() {
        page = page.section("Forecast", vec![forecasts.into()]);
    }
    page = page::readings(page, tests);
    if tests.analyses.len() <= READINGS_OF {
        for set in &report.fits {
            let line = format!("{} laws, best first, with their parameters", set.laws.len());
            let laws = Block::Folded(line, blocks(&set.laws));
            page = page.section(format!("Laws: {}", set.name), vec![laws]);
        }
    }
    page::end(page, &report.sources, &report.failures, tests)
}

/// Laws with their criteria and parameters.
fn blocks(laws: &[Fit]) -> Vec<Block> {
    let bic = |f: &&Fit| format!("{:.1}", f.bic).replace('-', "−");
    let table = criteria(laws).column("BIC", bic);
    let mut blocks = vec![
        table
            .captioned("Smaller AICc is better; a difference above 10 leaves no doubt.")
            .into(),
    ];
    for fit in laws {
        let (law, what) = (fit.law.name(), by_what(fit));
        let noise = short(100.0 * fit.residual_strain_ratio);
        let (slow, memory) = (100.0 * fit.noise.share, short(fit.noise.memory.exp()));
        let table = parameters(fit, short).captioned(format!(
            "{law}: {what}; noise of the readings {noise} %, {slow:.0} % of its variance slow (memory: time times {memory})"
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

/// Where forecasts end; without one, what was seen and which law fits best.
fn answers(fits: &[FitSet], analyses: &[Analysis]) -> Vec<Headline> {
    let of = |set: &FitSet| {
        let name = &set.name;
        if let Some((conditions, time_s, strain)) = end(set) {
            let (percent, after, under) = (bracketed(strain), duration(time_s), ahead(conditions));
            return Some(format!(
                "{name}: {percent} % after {after} under {under} (95 % in brackets)"
            ));
        }
        let best = set.laws.first()?.law.name();
        let seen = analyses.iter().find(|a| a.name == *name);
        let seen = seen.map_or_else(|| name.clone(), |a| answer(a).text);
        Some(format!("{seen}; of the laws tried, {best} fits best"))
    };
    let all = fits.iter().take(FEW).filter_map(of);
    all.map(Headline::from).collect()
}

/// One row per parameter of every law.
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
            p.not_identifiable.map(|what| open(what, &p.unit))
        })
        .table()
}
