//! Parameters of a fitted law with their intervals and identifiability.

use super::draw::Draw;
use super::law::Shape;
use super::model::Model;
use super::options::IntervalKind;
use serde::{Deserialize, Serialize};
use sinew_model::statistics::quantile;

/// Fitted parameter; its numbers are in its unit, as laboratories write the laws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Parameter {
    /// Symbol of the parameter.
    pub name: String,
    /// Unit of all numbers below.
    pub unit: String,
    /// Specimen it belongs to; `None` if common to all.
    pub specimen: Option<String>,
    /// Value of maximum likelihood, in its unit.
    pub value: f64,
    /// Standard deviation of the draws; NaN without draws.
    pub std_error: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// Method of the interval.
    pub interval: IntervalKind,
    /// Range of values consistent with the record, if the parameter is not identifiable.
    pub not_identifiable: Option<NotIdentifiable>,
}

/// Range of values that fit the record as well as the fitted value, in the parameter's unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NotIdentifiable {
    /// Any value between, which is most of the searched range.
    Anything {
        /// Lower end of the range.
        low: f64,
        /// Upper end of the range.
        high: f64,
    },
    /// Any value below a bound.
    Below {
        /// Upper end of the range.
        high: f64,
    },
    /// Any value above a bound.
    Above {
        /// Lower end of the range.
        low: f64,
    },
}

/// Name, unit, owner and sign of a number of a draw.
struct Label {
    name: &'static str,
    unit: &'static str,
    specimen: Option<String>,
    positive: bool,
}

/// Labels in the order of [`Draw::numbers`].
fn labels(model: &Model) -> Vec<Label> {
    let mut labels: Vec<Label> = Vec::new();
    let mut label = |name, unit, specimen: &Option<String>, positive| {
        labels.push(Label {
            name,
            unit,
            specimen: specimen.clone(),
            positive,
        });
    };
    let law = &model.shapes[..model.law_numbers()];
    for s in law {
        label(s.name, s.unit, &None, false);
    }
    for block in &model.blocks {
        let name = |m: usize| Some(model.curves[m].name.clone());
        let owner = match block.members.as_slice() {
            [only] if model.blocks.len() > 1 => name(*only),
            _ => None,
        };
        for t in &model.terms {
            label(t.name, t.unit, &owner, t.positive);
        }
        if block.elastic {
            label("J_0", "%", &owner, true);
        }
        for &m in &block.members {
            let single = model.curves.len() == 1;
            let of = if single { None } else { name(m) };
            label("epsilon_0", "%", &of, false);
        }
    }
    labels
}

/// Parameters with quantiles of the draws as intervals, and their covariance.
pub(super) fn parameters(
    model: &Model,
    best: &Draw,
    draws: &[Draw],
    level: f64,
) -> (Vec<Parameter>, Vec<Vec<f64>>) {
    let best = best.numbers(model);
    let drawn: Vec<Vec<f64>> = draws.iter().map(|d| d.numbers(model)).collect();
    let count = drawn.len() as f64;
    let mean: Vec<f64> = (0..best.len())
        .map(|i| drawn.iter().map(|d| d[i]).sum::<f64>() / count)
        .collect();
    let covariance: Vec<Vec<f64>> = if drawn.is_empty() {
        Vec::new()
    } else {
        let between = |i: usize, j: usize| {
            let products = drawn.iter().map(|d| (d[i] - mean[i]) * (d[j] - mean[j]));
            products.sum::<f64>() / (count - 1.0)
        };
        let row = |i| (0..best.len()).map(|j| between(i, j)).collect();
        (0..best.len()).map(row).collect()
    };
    let tail = 0.5 * (1.0 - level);
    let parameters = labels(model)
        .into_iter()
        .enumerate()
        .map(|(i, label)| {
            let ends = |mut values: Vec<f64>| {
                values.sort_by(f64::total_cmp);
                (quantile(&values, tail), quantile(&values, 1.0 - tail))
            };
            let (low, high) = ends(drawn.iter().map(|d| d[i]).collect());
            let not_identifiable = if drawn.is_empty() {
                None
            } else if let Some(shape) = model.shapes[..model.law_numbers()].get(i) {
                let (low, high) = ends(draws.iter().map(|d| d.unit[i]).collect());
                undecided_shape(shape, low, high)
            } else {
                undecided_amplitude(&label, low, high)
            };
            Parameter {
                name: label.name.to_owned(),
                unit: label.unit.to_owned(),
                specimen: label.specimen,
                value: best[i],
                std_error: covariance
                    .get(i)
                    .map_or(f64::NAN, |row| row[i].max(0.0).sqrt()),
                low,
                high,
                interval: IntervalKind::Draws,
                not_identifiable,
            }
        })
        .collect();
    (parameters, covariance)
}

/// Range of a shape whose interval fills most of the searched range or ends at a bound.
fn undecided_shape(shape: &Shape, low: f64, high: f64) -> Option<NotIdentifiable> {
    /// Maximum distance of an end from a bound (as a share of the searched range) to count as the
    /// bound.
    const AT_BOUND: f64 = 0.03;
    /// Maximum width of an informative interval, as a share of the searched range.
    const MAX_INTERVAL_WIDTH: f64 = 0.8;
    let (v_low, v_high) = (shape.value(low), shape.value(high));
    if high - low > MAX_INTERVAL_WIDTH {
        Some(NotIdentifiable::Anything {
            low: v_low,
            high: v_high,
        })
    } else if low < AT_BOUND && high > AT_BOUND {
        Some(NotIdentifiable::Below { high: v_high })
    } else if high > 1.0 - AT_BOUND && low < 1.0 - AT_BOUND {
        Some(NotIdentifiable::Above { low: v_low })
    } else {
        None
    }
}

/// Range of an amplitude that may be zero, or is determined within a factor of thirty only.
fn undecided_amplitude(label: &Label, low: f64, high: f64) -> Option<NotIdentifiable> {
    /// Minimum ratio of the ends for which zero is consistent with the record.
    const MIN_RATIO: f64 = 30.0;
    (label.positive && high > MIN_RATIO * low).then_some(NotIdentifiable::Below { high })
}
