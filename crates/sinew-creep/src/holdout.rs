//! Hold-out validation: forecast the held-out end of a test and count the coverage of the
//! intervals.

use super::curve::Curve;
use super::error::CreepError;
use super::forecast::Forecast;
use super::law::Law;
use super::options::FitOptions;
use super::outlook::ForecastSet;
use super::span::extremes;
use serde::{Deserialize, Serialize};

/// Law or combination that forecasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Forecaster {
    /// All fitted laws, weighted by their Akaike weights.
    Combined,
    /// Single creep law.
    #[serde(untagged)]
    Law(Law),
}

impl Forecaster {
    /// Name of the forecaster in tables.
    pub fn name(self) -> &'static str {
        match self {
            Forecaster::Combined => "combined",
            Forecaster::Law(law) => law.name(),
        }
    }
}

/// Hold-out result of one forecaster on one test.
#[derive(Debug, Clone, PartialEq)]
pub struct HoldOut {
    /// Law or combination that forecast.
    pub forecaster: Forecaster,
    /// Number of held-out measurements.
    pub hidden: usize,
    /// Number of held-out measurements within their interval.
    pub covered: usize,
    /// Whether the last measurement lies within its interval.
    pub end_covered: bool,
    /// Forecast minus measurement at the end, over the creep of the whole test.
    pub end_error: f64,
    /// Half-width of the interval at the last measurement, over the same.
    pub end_half_width: f64,
}

/// Holds out the last `share` of the time of a curve from every law; failures contain their reason.
pub fn hold_out(
    curve: &Curve,
    share: f64,
    options: &FitOptions,
) -> Vec<Result<HoldOut, (Law, CreepError)>> {
    let (Some(first), Some(last)) = (curve.time_s.first(), curve.time_s.last()) else {
        return Vec::new();
    };
    let (seen, hidden) = curve.split(last - share * (last - first));
    let mut results = Vec::new();
    let (low, high) = extremes(&curve.strain);
    let range = high - low;
    let evaluate = |forecaster: Forecaster, forecast: &Forecast| {
        let end = hidden.strain.len() - 1;
        let within = |i: usize| {
            hidden.strain[i] >= forecast.reading_low_strain_ratio[i]
                && hidden.strain[i] <= forecast.reading_high_strain_ratio[i]
        };
        HoldOut {
            forecaster,
            hidden: hidden.strain.len(),
            covered: (0..=end).filter(|i| within(*i)).count(),
            end_covered: within(end),
            end_error: (forecast.strain_ratio[end] - hidden.strain[end]) / range,
            end_half_width: 0.5
                * (forecast.reading_high_strain_ratio[end]
                    - forecast.reading_low_strain_ratio[end])
                / range,
        }
    };
    if hidden.strain.is_empty() {
        return results;
    }
    let outlook = ForecastSet::new(
        &Law::ALL,
        std::slice::from_ref(&seen),
        0,
        options,
        &hidden.time_s,
    );
    for (law, forecast) in outlook.laws {
        results.push(match forecast {
            Ok(forecast) => Ok(evaluate(Forecaster::Law(law), &forecast)),
            Err(error) => Err((law, error)),
        });
    }
    if let Some(forecast) = outlook.combined {
        results.push(Ok(evaluate(Forecaster::Combined, &forecast)));
    }
    results
}

/// Hold-out result of one forecaster over many tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coverage {
    /// Law, or all laws combined.
    pub forecaster: Forecaster,
    /// Number of forecast tests.
    pub tests: usize,
    /// Number of tests that the law could not be fitted to.
    pub failed: usize,
    /// Number of held-out measurements.
    pub readings: usize,
    /// Number of held-out measurements within their intervals.
    pub readings_inside: usize,
    /// Number of tests whose last measurement lies within its interval.
    pub ends_inside: usize,
    /// Median of |forecast − measurement| at the end, over the test's creep.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub end_error_ratio: f64,
    /// Median half-width of the interval at the end, over the test's creep.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub end_half_width_ratio: f64,
}

impl Coverage {
    /// Share of the held-out measurements within their intervals; `None` without a forecast.
    pub fn readings_share(&self) -> Option<f64> {
        (self.readings > 0).then(|| self.readings_inside as f64 / self.readings as f64)
    }

    /// Share of the last measurements within their intervals; `None` without a forecast.
    pub fn ends_share(&self) -> Option<f64> {
        (self.tests > 0).then(|| self.ends_inside as f64 / self.tests as f64)
    }
}

/// Validates forecasts of many curves, on all processors, and counts per law; `done` is called with
/// the number of curves finished.
pub fn hold_out_all(
    curves: &[Curve],
    share: f64,
    options: &FitOptions,
    done: impl Fn(usize) + Sync,
) -> Vec<Coverage> {
    let rows = super::parallel::each(curves, |curve| hold_out(curve, share, options), done);
    let results = || rows.iter().flatten();
    Law::ALL
        .map(Forecaster::Law)
        .into_iter()
        .chain([Forecaster::Combined])
        .map(|forecaster| {
            let own: Vec<&HoldOut> = results()
                .filter_map(|r| r.as_ref().ok())
                .filter(|w| w.forecaster == forecaster)
                .collect();
            let failed = results()
                .filter_map(|r| r.as_ref().err())
                .filter(|(law, _)| Forecaster::Law(*law) == forecaster)
                .count();
            let median = |pick: &dyn Fn(&HoldOut) -> f64| {
                let values: Vec<f64> = own.iter().map(|w| pick(w)).collect();
                super::artefacts::median(&values)
            };
            Coverage {
                forecaster,
                tests: own.len(),
                failed,
                readings: own.iter().map(|w| w.hidden).sum(),
                readings_inside: own.iter().map(|w| w.covered).sum(),
                ends_inside: own.iter().filter(|w| w.end_covered).count(),
                end_error_ratio: median(&|w| w.end_error.abs()),
                end_half_width_ratio: median(&|w| w.end_half_width),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_of_what_was_forecast() {
        let mut counted = Coverage {
            forecaster: Forecaster::Combined,
            tests: 4,
            failed: 1,
            readings: 40,
            readings_inside: 36,
            ends_inside: 3,
            end_error_ratio: 0.0,
            end_half_width_ratio: 0.0,
        };
        assert_eq!(counted.readings_share(), Some(0.9));
        assert_eq!(counted.ends_share(), Some(0.75));
        (counted.tests, counted.readings) = (0, 0);
        assert_eq!(counted.readings_share(), None);
        assert_eq!(counted.ends_share(), None);
    }
}
