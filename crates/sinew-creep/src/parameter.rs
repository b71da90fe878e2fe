//! A fitted law's numbers with their intervals, and which of them the record doesn't tell.

use super::draw::Draw;
use super::law::Shape;
use super::model::Model;
use super::options::IntervalKind;
use serde::{Deserialize, Serialize};
use sinew_model::statistics::quantile;

/// A fitted parameter. Its numbers are in the unit beside them, as laboratories write the laws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Parameter {
    /// Symbol.
    pub name: String,
    /// Unit of the numbers below.
    pub unit: String,
    /// Specimen it belongs to; `None`: common to all.
    pub specimen: Option<String>,
    /// Value of largest likelihood.
    pub value: f64,
    /// Standard deviation of the draws; NaN without them.
    pub std_error: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// How the interval was made.
    pub interval: IntervalKind,
    /// What the record leaves open, where it doesn't tell this parameter.
    pub not_identifiable: Option<NotIdentifiable>,
}

/// What fits the record as well as the fitted value, in the parameter's unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum NotIdentifiable {
    /// Anything between, which is most of what was searched.
    Anything {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Anything below.
    Below {
        /// Upper end.
        high: f64,
    },
    /// Anything above.
    Above {
        /// Lower end.
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

/// An interval that fills most of what was searched, or ends at a bound, is no answer.
fn undecided_shape(shape: &Shape, low: f64, high: f64) -> Option<NotIdentifiable> {
    /// An end this close to a bound (in parts of the searched range) is the bound.
    const AT_BOUND: f64 = 0.03;
    /// An interval this wide says nothing.
    const WIDE: f64 = 0.8;
    let (v_low, v_high) = (shape.value(low), shape.value(high));
    if high - low > WIDE {
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

/// An amplitude that may be nothing, or is known within a factor of thirty only, is open below.
fn undecided_amplitude(label: &Label, low: f64, high: f64) -> Option<NotIdentifiable> {
    /// From a thirtieth of the upper end on, zero is as good.
    const FACTOR: f64 = 30.0;
    (label.positive && high > FACTOR * low).then_some(NotIdentifiable::Below { high })
}
