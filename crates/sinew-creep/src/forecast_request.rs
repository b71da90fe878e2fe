//! Load and temperature of a forecast beyond the record.

use super::curve::Curve;
use super::error::{CreepError, NoForecast};
use super::law::Law;
use super::rope_base::RopeBase;
use serde::{Deserialize, Serialize};

/// Requested forecast: end time, load and temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForecastRequest {
    /// End time of the forecast, s after the load.
    pub until_s: f64,
    /// Tension held from the beginning, N; `None` for the load held longest in the test.
    pub load_n: Option<f64>,
    /// Temperature, °C; `None` for that of the test.
    pub temperature_c: Option<f64>,
}

/// Load and temperature of a forecast.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForecastConditions {
    /// Source of load and temperature.
    pub source: ConditionSource,
    /// Tension, N, if the record has one.
    pub load_n: Option<f64>,
    /// Temperature, °C, if the record has one.
    pub temperature_c: Option<f64>,
}

/// Source of load and temperature of a forecast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ConditionSource {
    /// Load held longest in the test and its temperature, continued.
    Held,
    /// Specified by the user; the specimen is new and under them from the beginning.
    Stated,
}

/// Continuation of a curve after its last measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Continuation {
    /// Loads of the record, the last one to the end.
    AsRecorded,
    /// Load held longest.
    Held,
    /// New specimen under another load and temperature.
    Instead {
        level: f64,
        temperature_c: Option<f64>,
    },
}

impl Continuation {
    /// Curve on which a forecast is based: measurements and loads.
    pub(super) fn of(self, curve: &Curve) -> Curve {
        match self {
            Self::AsRecorded => curve.clone(),
            Self::Held => curve.held_on(),
            Self::Instead {
                level,
                temperature_c,
            } => curve.instead(level, temperature_c),
        }
    }

    /// Measurements used for a back-test of the forecast.
    pub(super) fn backtest_curve(self, curve: &Curve) -> Curve {
        match self {
            Self::AsRecorded => curve.clone(),
            Self::Held | Self::Instead { .. } => curve.held_on(),
        }
    }
}

/// Determines the continuation of the first of `curves`, if the records support it: between their
/// loads and temperatures, or within the validity of the rope law if it alone was fitted.
///
/// # Errors
/// Returns [`CreepError::NoForecast`] with a [`NoForecast`] reason.
pub(super) fn continuation(
    name: &str,
    curves: &[Curve],
    laws: &[Law],
    base: Option<&RopeBase>,
    request: &ForecastRequest,
) -> Result<(Continuation, ForecastConditions), CreepError> {
    /// Tolerances within which a specified value is that of the test: errors of load cell and
    /// thermometer.
    const LOAD_TOLERANCE: f64 = 0.01;
    const TEMPERATURE_TOLERANCE_K: f64 = 1.0;
    /// Maximum distance from the temperatures of the records, K.
    const MAX_EXTRAPOLATION_K: f64 = 3.0;
    let no_forecast = |reason| {
        Err(CreepError::NoForecast {
            specimen: name.to_owned(),
            reason,
        })
    };
    let Some(curve) = curves.first() else {
        return no_forecast(NoForecast::NoLoad);
    };
    let Some((level, _)) = curve.held() else {
        return no_forecast(NoForecast::NoLoad);
    };
    let own_n = curve.tension.map(|t| t.at(level));
    let own = ForecastConditions {
        source: ConditionSource::Held,
        load_n: own_n,
        temperature_c: curve.temperature_c,
    };
    let other_load = match (request.load_n, own_n) {
        (Some(_), None) => return no_forecast(NoForecast::NoForce),
        (Some(n), Some(own)) => (n - own).abs() > LOAD_TOLERANCE * own,
        (None, _) => false,
    };
    let other_temperature = match (request.temperature_c, curve.temperature_c) {
        (Some(_), None) => return no_forecast(NoForecast::NoTemperature),
        (Some(c), Some(own)) => (c - own).abs() > TEMPERATURE_TOLERANCE_K,
        (None, _) => false,
    };
    if !other_load && !other_temperature {
        return Ok((Continuation::Held, own));
    }
    let load_n = request.load_n.or(own_n);
    let temperature_c = request.temperature_c.or(curve.temperature_c);
    let rope_alone = laws.iter().all(|law| *law == Law::Rope);
    if let (true, Some(n)) = (other_load, load_n) {
        let tensions = curves.iter().flat_map(|c| {
            let loads = c.steps.iter().map(|s| s.1).filter(|l| *l > 0.05);
            loads.filter_map(|l| c.tension.map(|t| t.at(l)))
        });
        let (low, high) = super::span::extremes(&tensions.collect::<Vec<_>>());
        let (low, high) = match base {
            Some(base) if rope_alone => (0.0, base.parameters.breaking_load_n),
            _ => (low, high),
        };
        if n < low * (1.0 - LOAD_TOLERANCE)
            || n > high * (1.0 + LOAD_TOLERANCE)
            || (rope_alone && n >= high)
        {
            return no_forecast(NoForecast::Load {
                load_n: n,
                low_n: low,
                high_n: high,
            });
        }
    }
    if let (true, false, Some(c)) = (other_temperature, rope_alone, temperature_c) {
        let own: Vec<f64> = curves.iter().filter_map(|c| c.temperature_c).collect();
        let (low, high) = super::span::extremes(&own);
        if c < low - MAX_EXTRAPOLATION_K || c > high + MAX_EXTRAPOLATION_K {
            return no_forecast(NoForecast::Temperature {
                temperature_c: c,
                low_c: low,
                high_c: high,
            });
        }
    }
    let level = match (load_n, curve.tension) {
        (Some(n), Some(t)) if other_load => (n - t.preload_n) / t.per_step_n,
        _ => level,
    };
    let how = Continuation::Instead {
        level,
        temperature_c,
    };
    let stated = ForecastConditions {
        source: ConditionSource::Stated,
        load_n,
        temperature_c,
    };
    Ok((how, stated))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Tension;
    use crate::fit::{Fit, fit};
    use crate::options::FitOptions;
    use crate::outlook::ForecastSet;

    const UNTIL_S: f64 = 36_000.0;

    /// Strain after a step of 60 N: immediate, and proportional to the logarithm of time.
    fn answer(t: f64) -> f64 {
        if t < 0.0 {
            0.0
        } else {
            0.003 + 2e-4 * (t / 30.0).ln_1p()
        }
    }

    /// Test of an hour under a load and half an hour without; errors of 2e-6.
    fn test(load_n: f64) -> Curve {
        let time_s: Vec<f64> = (1..=90).map(|i| 60.0 * f64::from(i)).collect();
        let levels = load_n / 60.0;
        let error = |t: f64| 2e-6 * (12.9898 * t).sin();
        let strain = |t: &f64| levels * (answer(*t) - answer(*t - 3600.0)) + error(*t);
        Curve {
            strain: time_s.iter().map(strain).collect(),
            steps: vec![(0.0, levels), (3600.0, 0.0)],
            temperature_c: Some(23.0),
            tension: Some(Tension {
                preload_n: 0.0,
                per_step_n: 60.0,
                preloaded_s: 0.0,
            }),
            ..Curve::constant_load(format!("{load_n} N"), time_s, Vec::new())
        }
    }

    fn requested(load_n: Option<f64>, temperature_c: Option<f64>) -> ForecastRequest {
        ForecastRequest {
            until_s: UNTIL_S,
            load_n,
            temperature_c,
        }
    }

    /// Median and interval of the strain at the end of the forecast of the first curve.
    fn end(curves: &[Curve], request: &ForecastRequest) -> ([f64; 3], ForecastConditions) {
        let laws = [Law::LogTime];
        let (how, conditions) =
            continuation("test", curves, &laws, None, request).expect("an answer");
        let options = FitOptions::default();
        let fits: Vec<Fit> = vec![fit(Law::LogTime, curves, &options).expect("a fit")];
        let found = ForecastSet::under(&fits, curves, 0, how, &options, &[UNTIL_S]);
        let f = found.combined.expect("a forecast");
        let ends = [
            f.strain_ratio[0],
            f.reading_low_strain_ratio[0],
            f.reading_high_strain_ratio[0],
        ];
        (ends, conditions)
    }

    #[test]
    fn forecast_applies_to_load_held_longest() {
        let curves = [test(60.0)];
        let ([middle, low, high], conditions) = end(&curves, &requested(None, None));
        let truth = answer(UNTIL_S);
        assert!(low < truth && truth < high, "{low} {truth} {high}");
        assert!((middle / truth - 1.0).abs() < 0.02, "{middle} {truth}");
        assert_eq!(conditions.source, ConditionSource::Held);
        assert_eq!(
            (conditions.load_n, conditions.temperature_c),
            (Some(60.0), Some(23.0))
        );
        // The same load, specified.
        assert_eq!(
            end(&curves, &requested(Some(60.2), Some(22.5))).1,
            conditions
        );
    }

    #[test]
    fn forecast_rejects_load_beyond_tested_range() {
        let curves = [test(60.0), test(120.0)];
        let ([_, low, high], conditions) = end(&curves, &requested(Some(90.0), None));
        let truth = 1.5 * answer(UNTIL_S);
        assert!(low < truth && truth < high, "{low} {truth} {high}");
        assert_eq!(
            (conditions.source, conditions.load_n),
            (ConditionSource::Stated, Some(90.0))
        );
        let refused = |curves: &[Curve], request: ForecastRequest| {
            continuation("test", curves, &Law::ALL, None, &request)
                .expect_err("no forecast")
                .to_string()
        };
        let text = refused(&curves, requested(Some(150.0), None));
        assert!(
            text.contains("150 N is outside the tested range (60.0 to 120.0 N)"),
            "{text}"
        );
        let text = refused(&curves[..1], requested(Some(90.0), None));
        assert!(text.contains("60.0 to 60.0 N"), "{text}");
        let text = refused(&curves, requested(None, Some(40.0)));
        assert!(
            text.contains("40 °C is outside the tested range (23.0 to 23.0 °C)"),
            "{text}"
        );
    }
}
