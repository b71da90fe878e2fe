//! Fits as tables, JSON and CSV.

use super::super::creep_files::{Tests, csv_line, short};
use crate::text::{paragraph, plain, table};
use sinew_creep::Law;

/// Fits beyond which parameters go to the table file only.
const SHOWN: usize = 3;

pub(super) fn told(
    fits: &[(String, Vec<sinew_creep::Fit>)],
    forecasts: &[(String, sinew_creep::Forecast)],
    failures: &[String],
) -> String {
    let mut out = String::new();
    if fits.len() > SHOWN {
        let mut rows = Vec::new();
        for law in Law::ALL.into_iter().chain([Law::Rope]) {
            let own: Vec<&sinew_creep::Fit> = fits
                .iter()
                .filter_map(|f| f.1.iter().find(|fit| fit.law == law))
                .collect();
            if own.is_empty() {
                continue;
            }
            let best = fits.iter().filter(|f| f.1[0].law == law).count();
            let mut residuals: Vec<f64> = own.iter().map(|f| f.residual_percent).collect();
            residuals.sort_by(f64::total_cmp);
            let untold = own
                .iter()
                .filter(|f| f.parameters.iter().any(|p| p.not_identifiable.is_some()))
                .count();
            rows.push(vec![
                law.name().to_owned(),
                own.len().to_string(),
                best.to_string(),
                short(residuals[residuals.len() / 2]),
                untold.to_string(),
            ]);
        }
        let head = [
            "law",
            "fitted",
            "smallest AICc",
            "median residual, %",
            "with untold parameters",
        ];
        out.push_str(&table(&head, rows, 1));
    } else {
        for (name, fits) in fits {
            let weights = sinew_creep::akaike_weights(fits);
            let least = fits[0].aicc;
            let rows = fits
                .iter()
                .zip(weights)
                .map(|(f, w)| {
                    vec![
                        f.law.name().to_owned(),
                        f.law.equation().to_owned(),
                        format!("{:.1}", f.aicc - least),
                        format!("{w:.2}"),
                        short(f.residual_percent),
                    ]
                })
                .collect();
            out.push_str(&format!("{}\n", paragraph(&plain(name), 0)));
            out.push_str(&table(
                &["law", "strain", "ΔAICc", "weight", "residual, %"],
                rows,
                2,
            ));
            let best = &fits[0];
            out.push_str(&format!("\n{}:\n", best.law.name()));
            let rows = best
                .parameters
                .iter()
                .map(|p| {
                    let name = match &p.specimen {
                        Some(s) => plain(&format!("{} of {s}", p.name)),
                        None => p.name.clone(),
                    };
                    vec![
                        name,
                        short(p.value),
                        short(p.std_error),
                        format!("{} … {}", short(p.low), short(p.high)),
                        p.unit.clone(),
                    ]
                })
                .collect();
            let kind = best.parameters.first().map_or("", |p| p.interval.name());
            let head = ["parameter", "value", "std. error", "interval", "unit"];
            out.push_str(&table(&head, rows, 1));
            out.push_str(&format!(
                "std. errors from the covariance, intervals by {kind}\n"
            ));
            for h in &best.held {
                out.push_str(&paragraph(
                    &format!("- {} is held at {}: {}", h.name, short(h.value), h.why),
                    2,
                ));
            }
            for p in &best.parameters {
                if let Some(why) = &p.not_identifiable {
                    out.push_str(&paragraph(
                        &format!("- {} is not identifiable from this record: {why}", p.name),
                        2,
                    ));
                }
            }
            out.push('\n');
        }
    }
    for (name, f) in forecasts.iter().take(SHOWN) {
        if let Some(last) = f.time_s.len().checked_sub(1) {
            out.push_str(&paragraph(
                &plain(&format!(
                    "{name}: after {} h {} % ({} to {} %) under the record's last load, all laws weighed, the interval widened by how far they missed the record's own end",
                    short(f.time_s[last] / 3600.0),
                    short(100.0 * f.strain[last]),
                    short(100.0 * f.reading_low[last]),
                    short(100.0 * f.reading_high[last])
                )),
                2,
            ));
        }
    }
    for failure in failures.iter().take(20) {
        out.push_str(&paragraph(&plain(&format!("- not fitted: {failure}")), 2));
    }
    if failures.len() > 20 {
        out.push_str(&format!("- and {} more (--json)\n", failures.len() - 20));
    }
    out
}

pub(super) fn json(
    tests: &Tests,
    fits: &[(String, Vec<sinew_creep::Fit>)],
    forecasts: &[(String, sinew_creep::Forecast)],
    failures: &[String],
) -> serde_json::Value {
    let sets: Vec<serde_json::Value> = fits
        .iter()
        .map(|(name, fits)| {
            let weights = sinew_creep::akaike_weights(fits);
            let laws: Vec<serde_json::Value> = fits
                .iter()
                .zip(weights)
                .map(|(f, weight)| {
                    serde_json::json!({
                        "law": f.law.name(),
                        "equation": f.law.equation(),
                        "readings": f.readings,
                        "aicc": f.aicc,
                        "bic": f.bic,
                        "weight": weight,
                        "log_likelihood": f.log_likelihood,
                        "residual_percent": f.residual_percent,
                        "noise_slow_share": f.noise.share,
                        "noise_memory_log_time": f.noise.memory,
                        "converged": f.converged,
                        "parameters": f.parameters,
                        "covariance": f.covariance,
                        "held": f.held,
                    })
                })
                .collect();
            serde_json::json!({ "name": name, "laws": laws })
        })
        .collect();
    serde_json::json!({
        "sources": tests.sources,
        "fits": sets,
        "forecasts": forecasts,
        "failures": failures,
    })
}

pub(super) fn csv(fits: &[(String, Vec<sinew_creep::Fit>)]) -> String {
    let mut out = csv_line(&[
        "name",
        "law",
        "aicc",
        "bic",
        "parameter",
        "specimen",
        "unit",
        "value",
        "std_error",
        "low",
        "high",
        "interval",
        "not_identifiable",
    ]);
    for (name, fits) in fits {
        for f in fits {
            for p in &f.parameters {
                out.push_str(&csv_line(&[
                    name.clone(),
                    f.law.name().to_owned(),
                    f.aicc.to_string(),
                    f.bic.to_string(),
                    p.name.clone(),
                    p.specimen.clone().unwrap_or_default(),
                    p.unit.clone(),
                    p.value.to_string(),
                    p.std_error.to_string(),
                    p.low.to_string(),
                    p.high.to_string(),
                    p.interval.name().to_owned(),
                    p.not_identifiable.clone().unwrap_or_default(),
                ]));
            }
        }
    }
    out
}
