//! Catalogue entry from a fit of the rope law.

use sinew_rope::law::Parameter;
use sinew_rope::law::entry::{CatalogueEntry, Correlation, Origin, Uncertainty, Value};
use sinew_rope::law::tested_range::TestedRange;

use super::curve::Curve;
use super::error::{CreepError, NoEntry};
use super::fit::Fit;
use super::law::Law;
use super::rope_base::RopeBase;
use super::rope_walk::TEMPERATURE_C;
use super::span::extremes;
use super::student::normal_quantile;

/// Origin of a fitted entry.
#[derive(Debug, Clone, PartialEq)]
pub struct EntrySource {
    /// Name of the new rope: lower-case letters, digits and hyphens.
    pub name: String,
    /// Description of the data, such as file names with their checksums.
    pub data: String,
    /// Date of the fit, such as 2026-11-21.
    pub date: String,
}

/// Key of the entry's source that names the data.
const SOURCE: &str = "creep-fit";

/// Creates the catalogue entry of a fitted rope: fitted values with their 95 % intervals and the
/// correlations of their errors; all other values are those of the base rope, with their own
/// origin.
///
/// An interval of the catalogue is symmetric (in the value or in its logarithm), so that the wider
/// side of the fitted one counts for both.
///
/// # Errors
/// Returns [`NoEntry::NotARopeFit`] if the fit is not one of [`Law::Rope`] or has no draws.
pub fn rope_entry(
    fit: &Fit,
    base: &RopeBase,
    from: &EntrySource,
) -> Result<CatalogueEntry, CreepError> {
    if fit.law != Law::Rope || fit.draws.is_empty() || fit.model.blocks.len() != 1 {
        return Err(NoEntry::NotARopeFit.into());
    }
    let mut entry = base.entry.clone();
    entry.name.clone_from(&from.name);
    entry.sources.insert(
        SOURCE.to_owned(),
        format!(
            "sinew creep fit, rope law, {} readings, specimens: {}; {}",
            fit.readings,
            fit.model.curves.len(),
            from.data
        ),
    );
    let drawn: Vec<Vec<f64>> = fit.draws.iter().map(|d| d.numbers(&fit.model)).collect();
    let mut fitted = Vec::new();
    let mut scores = Vec::new();
    for (i, found) in fit.parameters.iter().enumerate() {
        let Some(parameter) = catalogued(&found.name) else {
            continue;
        };
        let mut own: Vec<f64> = drawn.iter().map(|d| d[i]).collect();
        scores.push(normal_scores(&own));
        own.sort_by(f64::total_cmp);
        let (lowest, highest) = parameter.range();
        let value = found.value.clamp(lowest, highest);
        let low = sinew_model::statistics::quantile(&own, 0.025);
        let high = sinew_model::statistics::quantile(&own, 0.975);
        entry.law.insert(
            parameter,
            Value {
                value,
                uncertainty: uncertainty(parameter, value, low, high),
                origin: Origin::Fitted,
                source: SOURCE.to_owned(),
                date: Some(from.date.clone()),
            },
        );
        fitted.push(parameter);
    }
    // Fixed parameters are correlated with the fitted ones: otherwise a prediction for the tested
    // load would count them twice.
    let shapes = fit.model.shapes.len();
    for (k, (parameter, _)) in fit
        .model
        .rope
        .iter()
        .flat_map(|plan| &plan.held)
        .enumerate()
    {
        let z: Vec<f64> = fit.draws.iter().map(|d| d.values[shapes + k]).collect();
        scores.push(normal_scores(&z));
        fitted.push(*parameter);
    }
    entry.correlation = Correlation::new(fitted, correlations(&scores));
    entry.note = Some(note(fit, base));
    entry.tested_range = Some(tested_range_of(&fit.model.curves, base));
    Ok(entry)
}

/// Range of loads, temperatures and times of records.
pub(super) fn tested_range_of(curves: &[Curve], base: &RopeBase) -> TestedRange {
    let tensions = curves.iter().flat_map(|curve| {
        let tension = curve.tension;
        let steps = curve
            .steps
            .iter()
            .map(|step| step.1)
            .filter(|step| *step > 0.05);
        steps.filter_map(move |step| tension.map(|t| t.at(step)))
    });
    let shares: Vec<f64> = tensions
        .map(|n| n / base.parameters.breaking_load_n)
        .collect();
    let celsius = curves
        .iter()
        .map(|c| c.temperature_c.unwrap_or(TEMPERATURE_C));
    let celsius: Vec<f64> = celsius.collect();
    let ends = curves.iter().filter_map(|c| c.time_s.last().copied());
    let (low, high) = extremes(&shares);
    TestedRange {
        // Rounded outwards to five decimals, so that the tested loads lie inside.
        load_share: [(1e5 * low).floor() / 1e5, (1e5 * high).ceil() / 1e5],
        temperature_c: extremes(&celsius).into(),
        duration_s: ends.fold(0.0, f64::max),
    }
}

fn catalogued(name: &str) -> Option<Parameter> {
    Parameter::ALL.iter().copied().find(|p| p.name() == name)
}

/// Uncertainty by the wider side of the interval, as a factor if the value is a positive quantity.
fn uncertainty(parameter: Parameter, value: f64, low: f64, high: f64) -> Uncertainty {
    /// Maximum factor; a wider one is less informative than zero to twice the value.
    const MAX_FACTOR: f64 = 1e3;
    let by_sum = matches!(
        parameter,
        Parameter::Jamming
            | Parameter::BeddingEnergy
            | Parameter::DelayedEnergy
            | Parameter::DelayedPerK
    );
    let factor = (high / value).max(value / low);
    if !by_sum && value > 0.0 && low > 0.0 && factor < MAX_FACTOR {
        Uncertainty::Factor(factor.max(1.0 + 1e-9))
    } else {
        Uncertainty::PlusMinus((high - value).max(value - low).max(f64::MIN_POSITIVE))
    }
}

/// Factor on the correlations of the ranks' normal scores, so that rounding to four digits does not
/// make the matrix indefinite.
pub(super) const SHRINK: f64 = 0.999;

fn correlations(scores: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let sizes: Vec<f64> = scores.iter().map(|s| dot(s, s).sqrt()).collect();
    (0..scores.len())
        .map(|i| {
            (0..scores.len())
                .map(|j| {
                    if i == j {
                        return 1.0;
                    }
                    let r = SHRINK * dot(&scores[i], &scores[j]) / (sizes[i] * sizes[j]);
                    (1e4 * r).round() / 1e4
                })
                .collect()
        })
        .collect()
}

/// Standard normal quantiles of the ranks of numbers (van der Waerden's scores).
fn normal_scores(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut scores = vec![0.0; values.len()];
    for (rank, index) in order.into_iter().enumerate() {
        scores[index] = normal_quantile((rank as f64 + 1.0) / (values.len() as f64 + 1.0));
    }
    scores
}

fn note(fit: &Fit, base: &RopeBase) -> String {
    let open: Vec<&str> = fit
        .parameters
        .iter()
        .filter(|p| p.not_identifiable.is_some() && catalogued(&p.name).is_some())
        .map(|p| p.name.as_str())
        .collect();
    let mut text = format!(
        "values that were not fitted are those of {}",
        base.entry.name
    );
    if !open.is_empty() {
        text.push_str(&format!(
            "; fitted, but weakly determined by the records: {}",
            open.join(", ")
        ));
    }
    text
}
