//! The honest measure: hide the end of a test, forecast it, count how often the interval holds.

use super::curve::Curve;
use super::error::CreepError;
use super::forecast::Forecast;
use super::law::Law;
use super::options::FitOptions;
use super::outlook::Outlook;
use super::span::extremes;
use serde::{Deserialize, Serialize};

/// Who forecasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Forecaster {
    /// All laws that could be fitted, by their Akaike weights.
    Combined,
    /// One law.
    #[serde(untagged)]
    Law(Law),
}

impl Forecaster {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Forecaster::Combined => "combined",
            Forecaster::Law(law) => law.name(),
        }
    }
}

/// One law on one test.
#[derive(Debug, Clone, PartialEq)]
pub struct Withheld {
    /// Who forecast.
    pub forecaster: Forecaster,
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
) -> Vec<Result<Withheld, (Law, CreepError)>> {
    let (Some(first), Some(last)) = (curve.time_s.first(), curve.time_s.last()) else {
        return Vec::new();
    };
    let (seen, hidden) = curve.split(last - share * (last - first));
    let mut results = Vec::new();
    let (low, high) = extremes(&curve.strain);
    let range = high - low;
    let judge = |forecaster: Forecaster, forecast: &Forecast| {
        let end = hidden.strain.len() - 1;
        let within = |i: usize| {
            hidden.strain[i] >= forecast.reading_low_strain_ratio[i]
                && hidden.strain[i] <= forecast.reading_high_strain_ratio[i]
        };
        Withheld {
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
    let outlook = Outlook::new(
        &Law::ALL,
        std::slice::from_ref(&seen),
        0,
        options,
        &hidden.time_s,
    );
    for (law, forecast) in outlook.laws {
        results.push(match forecast {
            Ok(forecast) => Ok(judge(Forecaster::Law(law), &forecast)),
            Err(error) => Err((law, error)),
        });
    }
    if let Some(forecast) = outlook.combined {
        results.push(Ok(judge(Forecaster::Combined, &forecast)));
    }
    results
}

/// One forecaster over many tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coverage {
    /// Law, or all laws combined.
    pub forecaster: Forecaster,
    /// Tests forecast.
    pub tests: usize,
    /// Tests the law couldn't be fitted to.
    pub failed: usize,
    /// Hidden readings.
    pub readings: usize,
    /// Hidden readings within their intervals.
    pub readings_inside: usize,
    /// Tests whose last reading lies within.
    pub ends_inside: usize,
    /// Median of |forecast − truth| at the end, over the test's creep.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub end_error_ratio: f64,
    /// Median half width of the interval at the end, over the test's creep.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub end_half_width_ratio: f64,
}

impl Coverage {
    /// Share of the hidden readings within their intervals; `None` where nothing was forecast.
    pub fn readings_share(&self) -> Option<f64> {
        (self.readings > 0).then(|| self.readings_inside as f64 / self.readings as f64)
    }

    /// Share of the last readings within; `None` where nothing was forecast.
    pub fn ends_share(&self) -> Option<f64> {
        (self.tests > 0).then(|| self.ends_inside as f64 / self.tests as f64)
    }
}

/// Withholds from many curves, on all processors, and counts per law; `done` is called with the
/// number of curves finished.
pub fn withhold_all(
    curves: &[Curve],
    share: f64,
    options: &FitOptions,
    done: impl Fn(usize) + Sync,
) -> Vec<Coverage> {
    let rows = super::parallel::each(curves, |curve| withhold(curve, share, options), done);
    let results = || rows.iter().flatten();
    Law::ALL
        .map(Forecaster::Law)
        .into_iter()
        .chain([Forecaster::Combined])
        .map(|forecaster| {
            let own: Vec<&Withheld> = results()
                .filter_map(|r| r.as_ref().ok())
                .filter(|w| w.forecaster == forecaster)
                .collect();
            let failed = results()
                .filter_map(|r| r.as_ref().err())
                .filter(|(law, _)| Forecaster::Law(*law) == forecaster)
                .count();
            let median = |pick: &dyn Fn(&Withheld) -> f64| {
                let values: Vec<f64> = own.iter().map(|w| pick(w)).collect();
                super::scan::median(&values)
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
