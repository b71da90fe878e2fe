//! The honest measure: hide the end of a test, forecast it, count how often the interval holds.

use super::CreepError;
use super::curve::Curve;
use super::fit::FitOptions;
use super::forecast::Forecast;
use super::law::Law;
use super::outlook::Outlook;

/// One law on one test.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Withheld {
    /// Law; `combined` weighs all that could be fitted.
    pub law: String,
    /// Readings hidden.
    pub hidden: usize,
    /// Hidden readings within their interval.
    pub covered: usize,
    /// Whether the last reading lies within.
    pub end_covered: bool,
    /// Forecast minus truth at the last reading, over the creep of the whole test.
    pub end_error: f64,
    /// Half the width of the interval at the last reading, over the same.
    pub end_half_width: f64,
}

/// Hides the last `share` of the time of a curve from every law; failures name their reason.
pub fn withhold(
    curve: &Curve,
    share: f64,
    options: &FitOptions,
) -> Vec<Result<Withheld, (String, CreepError)>> {
    let (Some(first), Some(last)) = (curve.time_s.first(), curve.time_s.last()) else {
        return Vec::new();
    };
    let (seen, hidden) = curve.split(last - share * (last - first));
    let mut results = Vec::new();
    let range = {
        let (low, high) = curve
            .strain
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), e| {
                (l.min(*e), h.max(*e))
            });
        high - low
    };
    let judge = |law: &str, forecast: &Forecast| {
        let end = hidden.strain.len() - 1;
        let within = |i: usize| {
            hidden.strain[i] >= forecast.reading_low[i]
                && hidden.strain[i] <= forecast.reading_high[i]
        };
        Withheld {
            law: law.to_owned(),
            hidden: hidden.strain.len(),
            covered: (0..=end).filter(|i| within(*i)).count(),
            end_covered: within(end),
            end_error: (forecast.strain[end] - hidden.strain[end]) / range,
            end_half_width: 0.5 * (forecast.reading_high[end] - forecast.reading_low[end]) / range,
        }
    };
    if hidden.strain.is_empty() {
        return results;
    }
    let outlook = Outlook::new(
        &Law::ALL,
        std::slice::from_ref(&seen),
        0,
        options,
        &hidden.time_s,
    );
    for (law, forecast) in outlook.laws {
        results.push(match forecast {
            Ok(forecast) => Ok(judge(law.name(), &forecast)),
            Err(error) => Err((law.name().to_owned(), error)),
        });
    }
    if let Some(forecast) = outlook.combined {
        results.push(Ok(judge("combined", &forecast)));
    }
    results
}

/// One law over many tests.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// Law, or `combined`.
    pub law: String,
    /// Tests forecast.
    pub tests: usize,
    /// Tests the law couldn't be fitted to.
    pub failed: usize,
    /// Hidden readings within their intervals, %.
    pub readings_percent: f64,
    /// Tests whose last reading lies within, %.
    pub end_percent: f64,
    /// Median of |forecast − truth| at the end, % of the test's creep.
    pub end_error_percent: f64,
    /// Median half width of the interval at the end, % of the test's creep.
    pub end_half_width_percent: f64,
}

/// Withholds from many curves, on all processors, and counts per law; `done` is told how many.
pub fn withhold_all(
    curves: &[Curve],
    share: f64,
    options: &FitOptions,
    done: impl Fn(usize) + Sync,
) -> Vec<Coverage> {
    let rows = super::parallel::each(curves, |curve| withhold(curve, share, options), done);
    Law::ALL
        .iter()
        .map(|law| law.name())
        .chain(["combined"])
        .map(|name| {
            let done: Vec<&Withheld> = rows
                .iter()
                .flat_map(|row| row.iter().filter_map(|r| r.as_ref().ok()))
                .filter(|w| w.law == name)
                .collect();
            let failed = rows
                .iter()
                .flat_map(|row| row.iter().filter_map(|r| r.as_ref().err()))
                .filter(|(law, _)| law == name)
                .count();
            let median = |pick: &dyn Fn(&Withheld) -> f64| {
                let values: Vec<f64> = done.iter().map(|w| pick(w)).collect();
                super::scan::median(&values)
            };
            let hidden: usize = done.iter().map(|w| w.hidden).sum();
            let covered: usize = done.iter().map(|w| w.covered).sum();
            let ends = done.iter().filter(|w| w.end_covered).count();
            Coverage {
                law: name.to_owned(),
                tests: done.len(),
                failed,
                readings_percent: 100.0 * covered as f64 / hidden as f64,
                end_percent: 100.0 * ends as f64 / done.len() as f64,
                end_error_percent: 100.0 * median(&|w| w.end_error.abs()),
                end_half_width_percent: 100.0 * median(&|w| w.end_half_width),
            }
        })
        .collect()
}
