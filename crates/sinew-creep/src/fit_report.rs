//! Fit report: jointly fitted tests, forecasts, hold-out validation.

use super::analysis_report::Tests;
use super::curve::Curve;
use super::error::{CreepError, Failure, NoEntry};
use super::fit::{Fit, fit};
use super::forecast::{Forecast, akaike_weights};
use super::forecast_request::{ForecastConditions, ForecastRequest, continuation};
use super::holdout::{Coverage, hold_out_all};
use super::law::Law;
use super::options::{FitOptions, Share};
use super::outlook::ForecastSet;
use super::parallel::each;
use super::rope_base::RopeBase;
use super::rope_entry::{EntrySource, rope_entry};
use super::test_file::Source;
use serde::{Deserialize, Serialize};
use sinew_files::JsonDocument;
use sinew_rope::law::entry::CatalogueEntry;

/// Specimens that are fitted jointly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Joint {
    /// Every specimen separately.
    #[default]
    None,
    /// Specimens of a group with a common shape, each with its own amplitude.
    Shape,
    /// Specimens of a group with all parameters in common except their strain zero.
    Group,
}

/// Options of a fit of creep tests.
#[derive(Debug, Clone, Default)]
pub struct FitRequest {
    /// Laws to fit; empty for all that need only the record, and the rope law if there is a base.
    pub laws: Vec<Law>,
    /// Specimens that are fitted jointly.
    pub joint: Joint,
    /// Options of each fit; [`FitOptions::share`] follows from [`Self::joint`].
    pub options: FitOptions,
    /// Forecast, if requested.
    pub forecast: Option<ForecastRequest>,
}

impl FitRequest {
    /// Laws that are fitted.
    pub fn laws(&self) -> Vec<Law> {
        if !self.laws.is_empty() {
            return self.laws.clone();
        }
        let rope = self.options.rope.as_ref().map(|_| Law::Rope);
        Law::ALL.into_iter().chain(rope).collect()
    }

    fn options(&self) -> FitOptions {
        FitOptions {
            share: match self.joint {
                Joint::Shape => Share::Shape,
                _ => Share::All,
            },
            ..self.options.clone()
        }
    }
}

/// Step of the work in progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitStep {
    /// Fit of the laws.
    Fitting,
    /// Back-test and forecast.
    Forecasting,
}

/// Laws fitted to one specimen or group.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitSet {
    /// Name of the specimen or group.
    pub name: String,
    /// Fitted laws by increasing AICc.
    pub laws: Vec<Fit>,
    /// Forecast strain, weighted over all laws; of the first specimen of a group.
    pub forecast: Option<Forecast>,
    /// Load and temperature of the forecast.
    pub forecast_conditions: Option<ForecastConditions>,
}

/// Laws fitted to creep tests.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitReport {
    /// Raw data files of the tests.
    pub sources: Vec<Source>,
    /// Fits in the order of the files.
    pub fits: Vec<FitSet>,
    /// Specimens that could not be analysed or fitted.
    pub failures: Vec<Failure>,
}

impl JsonDocument for FitReport {
    const SCHEMA: &'static str = "sinew/creep-fit/2";
}

/// Forecasts compared with the held-out end of each test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HoldOutReport {
    /// Raw data files of the tests.
    pub sources: Vec<Source>,
    /// Held-out share of the time at the end of each test.
    pub held_out_share: f64,
    /// Confidence level of the intervals.
    pub level: f64,
    /// Coverage of each law, and of all laws combined.
    pub held_out: Vec<Coverage>,
    /// Specimens that could not be analysed.
    pub failures: Vec<Failure>,
}

impl HoldOutReport {
    /// Whether any law could forecast any test.
    pub fn forecasts_any(&self) -> bool {
        self.held_out.iter().any(|c| c.tests > 0)
    }
}

impl JsonDocument for HoldOutReport {
    const SCHEMA: &'static str = "sinew/creep-holdout/2";
}

/// Curves that are fitted jointly.
struct Set {
    name: String,
    curves: Vec<Curve>,
    /// Reference load, that of the first specimen, N or Pa.
    reference: f64,
}

fn sets(tests: &Tests, joint: Joint) -> Vec<Set> {
    let mut sets: Vec<Set> = Vec::new();
    for prepared in &tests.prepared {
        let load = prepared.stress_pa.or(prepared.force_n);
        let curve = prepared.curve.clone();
        let name = match joint {
            Joint::None => &prepared.name,
            _ => prepared.group.as_deref().unwrap_or("all"),
        };
        match sets
            .iter_mut()
            .find(|s| joint != Joint::None && s.name == name)
        {
            Some(set) => {
                let factor = load.map_or(1.0, |load| load / set.reference);
                set.curves.push(curve.scaled(factor));
            }
            None => sets.push(Set {
                name: name.to_owned(),
                curves: vec![curve],
                reference: load.unwrap_or(1.0),
            }),
        }
    }
    sets
}

/// Fits laws to every specimen or group, on all processors, and computes forecasts. `progress` is
/// called with the step, the number of sets finished, and of all.
pub fn fit_tests(
    tests: &Tests,
    request: &FitRequest,
    progress: impl Fn(FitStep, usize, usize) + Sync,
) -> FitReport {
    let laws = request.laws();
    let options = request.options();
    let sets = sets(tests, request.joint);
    let fitted = each(
        &sets,
        |set| fit_set(set, &laws, &options),
        |done| progress(FitStep::Fitting, done, sets.len()),
    );
    let mut failures = tests.failures.clone();
    let mut pairs = Vec::new();
    for ((fits, failed), set) in fitted.into_iter().zip(&sets) {
        failures.extend(failed);
        if !fits.is_empty() {
            pairs.push((set, fits));
        }
    }
    let forecasts: Vec<_> = match &request.forecast {
        None => vec![Ok(None); pairs.len()],
        Some(requested) => each(
            &pairs,
            |(set, fits)| forecast(set, fits, &options, requested),
            |done| progress(FitStep::Forecasting, done, pairs.len()),
        ),
    };
    let mut fits = Vec::with_capacity(pairs.len());
    for ((set, laws), forecast) in pairs.into_iter().zip(forecasts) {
        let (forecast, forecast_conditions) = match forecast {
            Ok(found) => found.unzip(),
            Err(reason) => {
                failures.push(Failure { name: None, reason });
                (None, None)
            }
        };
        fits.push(FitSet {
            name: set.name.clone(),
            laws,
            forecast,
            forecast_conditions,
        });
    }
    FitReport {
        sources: tests.sources.clone(),
        fits,
        failures,
    }
}

/// Forecast of a set's first curve, weighted over all laws, and its conditions.
fn forecast(
    set: &Set,
    fits: &[Fit],
    options: &FitOptions,
    requested: &ForecastRequest,
) -> Result<Option<(Forecast, ForecastConditions)>, CreepError> {
    let laws: Vec<Law> = fits.iter().map(|f| f.law).collect();
    let base = options.rope.as_deref();
    let (how, conditions) = continuation(&set.name, &set.curves, &laws, base, requested)?;
    let Some(curve) = set.curves.first().map(|curve| how.of(curve)) else {
        return Ok(None);
    };
    let time_s = times_ahead(&curve, requested.until_s);
    let outlook = ForecastSet::under(fits, &set.curves, 0, how, options, &time_s);
    Ok(outlook.combined.map(|forecast| (forecast, conditions)))
}

/// Fits by increasing AICc with their weights, and failures.
fn fit_set(set: &Set, laws: &[Law], options: &FitOptions) -> (Vec<Fit>, Vec<Failure>) {
    let mut fits = Vec::new();
    let mut failures = Vec::new();
    for law in laws {
        match fit(*law, &set.curves, options) {
            Ok(fit) => fits.push(fit),
            Err(reason) => failures.push(Failure {
                name: Some(set.name.clone()),
                reason,
            }),
        }
    }
    fits.sort_by(|a, b| a.aicc.total_cmp(&b.aicc));
    let weights = akaike_weights(&fits);
    for (fit, weight) in fits.iter_mut().zip(weights) {
        fit.weight = weight;
    }
    (fits, failures)
}

/// Times after a curve's end, uniform in the logarithm.
fn times_ahead(curve: &Curve, until_s: f64) -> Vec<f64> {
    const COUNT: i32 = 40;
    /// Start of a new specimen's forecast, s.
    const FROM_S: f64 = 60.0;
    let from = curve.time_s.last().copied();
    let end = from.unwrap_or(FROM_S.min(0.1 * until_s)).max(1e-3);
    let last = until_s.max(1.01 * end);
    (1..=COUNT)
        .map(|i| end * (last / end).powf(f64::from(i) / f64::from(COUNT)))
        .collect()
}

impl FitReport {
    /// Creates the catalogue entry of the only fitted rope.
    ///
    /// # Errors
    /// Returns a [`NoEntry`] reason: several ropes, several amplitudes, or no fit of the rope law.
    pub fn rope_entry(
        &self,
        joint: Joint,
        base: &RopeBase,
        name: String,
        date: String,
    ) -> Result<CatalogueEntry, CreepError> {
        if joint == Joint::Shape {
            return Err(NoEntry::SeveralAmplitudes.into());
        }
        let [set] = self.fits.as_slice() else {
            let fitted = self.fits.len();
            return Err(NoEntry::SeveralRopes { fitted }.into());
        };
        let fit = set.laws.iter().find(|f| f.law == Law::Rope);
        let data: Vec<String> = self
            .sources
            .iter()
            .map(|s| format!("{} (SHA-256 {})", s.file, s.sha256))
            .collect();
        let source = EntrySource {
            name,
            data: data.join(", "),
            date,
        };
        rope_entry(fit.ok_or(NoEntry::NoRopeLaw)?, base, &source)
    }
}

/// Holds out the last `share` of the time of every test and counts the coverage of the forecasts;
/// `done` is called with the number of tests finished, and of all.
pub fn hold_out_tests(
    tests: &Tests,
    share: f64,
    request: &FitRequest,
    done: impl Fn(usize, usize) + Sync,
) -> HoldOutReport {
    let curves: Vec<Curve> = tests.prepared.iter().map(|p| p.curve.clone()).collect();
    let (count, options) = (curves.len(), request.options());
    HoldOutReport {
        sources: tests.sources.clone(),
        held_out_share: share,
        level: options.level,
        held_out: hold_out_all(&curves, share, &options, |finished| done(finished, count)),
        failures: tests.failures.clone(),
    }
}
