//! Under which load and at which temperature a forecast goes on.

use super::curve::Curve;
use super::error::{CreepError, NoForecast};
use super::law::Law;
use super::rope_base::RopeBase;
use serde::{Deserialize, Serialize};

/// What is asked of a forecast.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForecastRequest {
    /// To this time after the load, s.
    pub until_s: f64,
    /// Tension held from the beginning, N; `None`: the load that the test was held at longest.
    pub load_n: Option<f64>,
    /// Temperature, °C; `None`: the test's own.
    pub temperature_c: Option<f64>,
}

/// Load and temperature that a forecast is for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForecastConditions {
    /// Where they come from.
    pub source: ConditionSource,
    /// Tension, N, where the record has one.
    pub load_n: Option<f64>,
    /// Temperature, °C, where the record has one.
    pub temperature_c: Option<f64>,
}

/// Where load and temperature of a forecast come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ConditionSource {
    /// The load that the test was held at longest and its temperature, as if it had gone on.
    Held,
    /// Stated; the specimen is new and under them from the beginning.
    Stated,
}

/// How a curve goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ahead {
    /// Under the record's own loads, the last one to the end.
    AsRecorded,
    /// Under the load held longest.
    Held,
    /// New, under a level of load at a temperature.
    Instead {
        level: f64,
        temperature_c: Option<f64>,
    },
}

impl Ahead {
    /// The curve as a forecast takes it: readings it goes on from, and loads.
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

    /// The readings on which a forecast is rehearsed.
    pub(super) fn rehearsed(self, curve: &Curve) -> Curve {
        match self {
            Self::AsRecorded => curve.clone(),
            Self::Held | Self::Instead { .. } => curve.held_on(),
        }
    }
}

/// How the first of `curves` goes on, where they can tell: between the loads and temperatures that
/// they hold, or wherever the rope law holds when it alone was fitted.
///
/// # Errors
/// [`NoForecast`].
pub(super) fn ahead(
    name: &str,
    curves: &[Curve],
    laws: &[Law],
    base: Option<&RopeBase>,
    request: &ForecastRequest,
) -> Result<(Ahead, ForecastConditions), CreepError> {
    /// Within these a stated value is the test's own: a load cell's and a thermometer's error.
    const SAME_LOAD: f64 = 0.01;
    const SAME_KELVIN: f64 = 1.0;
    /// Beyond the temperatures of the records by no more than this, K.
    const NEAR_KELVIN: f64 = 3.0;
    let refuse = |reason| {
        Err(CreepError::NoForecast {
            specimen: name.to_owned(),
            reason,
        })
    };
    let Some(curve) = curves.first() else {
        return refuse(NoForecast::NoLoad);
    };
    let Some((level, _)) = curve.held() else {
        return refuse(NoForecast::NoLoad);
    };
    let own_n = curve.tension.map(|t| t.at(level));
    let own = ForecastConditions {
        source: ConditionSource::Held,
        load_n: own_n,
        temperature_c: curve.temperature_c,
    };
    let other_load = match (request.load_n, own_n) {
        (Some(_), None) => return refuse(NoForecast::NoForce),
        (Some(n), Some(own)) => (n - own).abs() > SAME_LOAD * own,
        (None, _) => false,
    };
    let other_temperature = match (request.temperature_c, curve.temperature_c) {
        (Some(_), None) => return refuse(NoForecast::NoTemperature),
        (Some(c), Some(own)) => (c - own).abs() > SAME_KELVIN,
        (None, _) => false,
    };
    if !other_load && !other_temperature {
        return Ok((Ahead::Held, own));
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
        if n < low * (1.0 - SAME_LOAD) || n > high * (1.0 + SAME_LOAD) || (rope_alone && n >= high)
        {
            return refuse(NoForecast::Load {
                load_n: n,
                low_n: low,
                high_n: high,
            });
        }
    }
    if let (true, false, Some(c)) = (other_temperature, rope_alone, temperature_c) {
        let own: Vec<f64> = curves.iter().filter_map(|c| c.temperature_c).collect();
        let (low, high) = super::span::extremes(&own);
        if c < low - NEAR_KELVIN || c > high + NEAR_KELVIN {
            return refuse(NoForecast::Temperature {
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
    let how = Ahead::Instead {
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
    use crate::outlook::Outlook;

    const UNTIL_S: f64 = 36_000.0;

    /// Strain after a step of 60 N, %: at once, and by the logarithm of time.
    fn answer(t: f64) -> f64 {
        if t < 0.0 {
            0.0
        } else {
            0.003 + 2e-4 * (t / 30.0).ln_1p()
        }
    }

    /// An hour under a load, half an hour without; errors of 2e-6.
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

    fn asked(load_n: Option<f64>, temperature_c: Option<f64>) -> ForecastRequest {
        ForecastRequest {
            until_s: UNTIL_S,
            load_n,
            temperature_c,
        }
    }

    /// Where the forecast of the first curve ends: median and interval of the strain.
    fn end(curves: &[Curve], request: &ForecastRequest) -> ([f64; 3], ForecastConditions) {
        let laws = [Law::LogTime];
        let (how, conditions) = ahead("test", curves, &laws, None, request).expect("an answer");
        let options = FitOptions::default();
        let fits: Vec<Fit> = vec![fit(Law::LogTime, curves, &options).expect("a fit")];
        let found = Outlook::under(&fits, curves, 0, how, &options, &[UNTIL_S]);
        let f = found.combined.expect("a forecast");
        let ends = [
            f.strain_ratio[0],
            f.reading_low_strain_ratio[0],
            f.reading_high_strain_ratio[0],
        ];
        (ends, conditions)
    }

    #[test]
    fn a_forecast_is_for_the_load_that_was_held_and_not_for_the_end_of_the_record() {
        let curves = [test(60.0)];
        let ([middle, low, high], conditions) = end(&curves, &asked(None, None));
        let truth = answer(UNTIL_S);
        assert!(low < truth && truth < high, "{low} {truth} {high}");
        assert!((middle / truth - 1.0).abs() < 0.02, "{middle} {truth}");
        assert_eq!(conditions.source, ConditionSource::Held);
        assert_eq!(
            (conditions.load_n, conditions.temperature_c),
            (Some(60.0), Some(23.0))
        );
        // The same load, stated.
        assert_eq!(end(&curves, &asked(Some(60.2), Some(22.5))).1, conditions);
    }

    #[test]
    fn a_stated_load_is_forecast_between_the_loads_of_the_tests_and_refused_beyond() {
        let curves = [test(60.0), test(120.0)];
        let ([_, low, high], conditions) = end(&curves, &asked(Some(90.0), None));
        let truth = 1.5 * answer(UNTIL_S);
        assert!(low < truth && truth < high, "{low} {truth} {high}");
        assert_eq!(
            (conditions.source, conditions.load_n),
            (ConditionSource::Stated, Some(90.0))
        );
        let refused = |curves: &[Curve], request: ForecastRequest| {
            ahead("test", curves, &Law::ALL, None, &request)
                .expect_err("not told")
                .to_string()
        };
        let text = refused(&curves, asked(Some(150.0), None));
        assert!(
            text.contains("150 N lies beyond the 60.0 to 120.0 N"),
            "{text}"
        );
        let text = refused(&curves[..1], asked(Some(90.0), None));
        assert!(text.contains("60.0 to 60.0 N"), "{text}");
        let text = refused(&curves, asked(None, Some(40.0)));
        assert!(
            text.contains("40 °C lies beyond the 23.0 to 23.0 °C"),
            "{text}"
        );
    }
}
