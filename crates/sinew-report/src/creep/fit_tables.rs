//! Fits as terminal tables.

use super::words::{ahead, interval_kind, not_converged, open, parameter_name, why_fixed};
use crate::text::{paragraph, plain, short, table};
use sinew_creep::{CreepError, Fit, FitReport, FitSet, Law};

/// Fits beyond which parameters go to the table file only.
const SHOWN: usize = 3;

/// Laws with their criteria, the best one's parameters, forecasts and failures.
pub fn fit_table(report: &FitReport) -> String {
    let fits = &report.fits;
    let mut out = String::new();
    if fits.len() > SHOWN {
        out.push_str(&laws(fits));
    } else {
        for set in fits {
            out.push_str(&one(set));
        }
    }
    for set in fits.iter().filter(|s| s.forecast.is_some()).take(SHOWN) {
        if let Some(text) = end(set) {
            out.push_str(&paragraph(&plain(&text), 2));
        }
    }
    for failure in report.failures.iter().take(20) {
        let what = match failure.reason {
            CreepError::NoForecast { .. } => "",
            _ => "not fitted: ",
        };
        out.push_str(&paragraph(&plain(&format!("- {what}{failure}")), 2));
    }
    if report.failures.len() > 20 {
        out.push_str(&format!(
            "- and {} more (--json)\n",
            report.failures.len() - 20
        ));
    }
    out
}

/// One line per law over many specimens.
fn laws(fits: &[FitSet]) -> String {
    let mut rows = Vec::new();
    for law in Law::ALL.into_iter().chain([Law::Rope]) {
        let own: Vec<&Fit> = fits
            .iter()
            .filter_map(|f| f.laws.iter().find(|fit| fit.law == law))
            .collect();
        if own.is_empty() {
            continue;
        }
        let best = fits.iter().filter(|f| f.laws[0].law == law).count();
        let mut residuals: Vec<f64> = own.iter().map(|f| f.residual_strain_ratio).collect();
        residuals.sort_by(f64::total_cmp);
        let undecided = own
            .iter()
            .filter(|f| f.parameters.iter().any(|p| p.not_identifiable.is_some()))
            .count();
        rows.push(vec![
            law.name().to_owned(),
            own.len().to_string(),
            best.to_string(),
            short(100.0 * residuals[residuals.len() / 2]),
            undecided.to_string(),
        ]);
    }
    let head = [
        "law",
        "fitted",
        "smallest AICc",
        "median residual, %",
        "with untold parameters",
    ];
    table(&head, rows, 1)
}

/// The laws of one specimen or group, and the parameters of the best.
fn one(set: &FitSet) -> String {
    let best = &set.laws[0];
    let rows = set.laws.iter().map(|f| {
        vec![
            f.law.name().to_owned(),
            f.law.equation().to_owned(),
            format!("{:.1}", f.aicc - best.aicc),
            format!("{:.2}", f.weight),
            short(100.0 * f.residual_strain_ratio),
        ]
    });
    let mut out = format!("{}\n", paragraph(&plain(&set.name), 0));
    let head = ["law", "strain", "ΔAICc", "weight", "residual, %"];
    out.push_str(&table(&head, rows.collect(), 2));
    out.push_str(&format!("\n{}:\n", best.law.name()));
    let rows = best.parameters.iter().map(|p| {
        vec![
            plain(&parameter_name(p)),
            short(p.value),
            short(p.std_error),
            format!("{} … {}", short(p.low), short(p.high)),
            p.unit.clone(),
        ]
    });
    let head = ["parameter", "value", "std. error", "interval", "unit"];
    out.push_str(&table(&head, rows.collect(), 1));
    let kind = best.parameters.first();
    out.push_str(&format!(
        "std. errors from the covariance, intervals by {}\n",
        kind.map_or("", |p| interval_kind(p.interval))
    ));
    let fixed = best.fixed.iter().map(|h| {
        let why = why_fixed(h.why);
        format!("- {} is held at {}: {why}", h.name, short(h.value))
    });
    let undecided = best.parameters.iter().filter_map(|p| {
        let why = open(p.not_identifiable?, &p.unit);
        Some(format!(
            "- {} is not identifiable from this record: {why}",
            p.name
        ))
    });
    let unfinished = set.laws.iter().filter_map(|f| {
        let how = not_converged(f)?;
        Some(format!("- {}: {how}", f.law.name()))
    });
    for text in fixed.chain(undecided).chain(unfinished) {
        out.push_str(&paragraph(&text, 2));
    }
    out + "\n"
}

/// Where a forecast ends, and under what.
fn end(set: &FitSet) -> Option<String> {
    let (f, conditions) = (set.forecast.as_ref()?, set.forecast_conditions.as_ref()?);
    let last = f.time_s.len().checked_sub(1)?;
    Some(format!(
        "{}: after {} h {} % ({} to {} %) under {}; all laws weighed, the interval widened by how far they missed the record's own end and, beyond three times its length, by what every decade of it brought",
        set.name,
        short(f.time_s[last] / 3600.0),
        short(100.0 * f.strain_ratio[last]),
        short(100.0 * f.reading_low_strain_ratio[last]),
        short(100.0 * f.reading_high_strain_ratio[last]),
        ahead(conditions)
    ))
}
