//! A fitted law's numbers with their intervals, and which of them the record doesn't tell.

use super::fit::{Draw, Fit, IntervalKind};
use super::law::Shape;
use sinew_model::statistics::quantile;

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
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
    /// Why the record doesn't tell this parameter, where it doesn't.
    pub not_identifiable: Option<String>,
}

impl Fit {
    /// Numbers of a draw in the order and units of [`Self::parameters`].
    pub(super) fn numbers(&self, draw: &Draw) -> Vec<f64> {
        let mut numbers = draw.values.clone();
        for beta in &draw.beta {
            for (j, b) in beta.iter().enumerate() {
                numbers.push(self.model.number(j, *b));
            }
        }
        numbers
    }

    pub(super) fn tell_parameters(&mut self) {
        let terms = &self.model.terms;
        let mut names: Vec<(String, String, Option<String>, bool)> = self
            .model
            .shapes
            .iter()
            .map(|s| (s.name.to_owned(), s.unit.to_owned(), None, false))
            .collect();
        for block in &self.model.blocks {
            let name = |m: usize| Some(self.model.curves[m].name.clone());
            let owner = match block.members.as_slice() {
                [only] if self.model.blocks.len() > 1 => name(*only),
                _ => None,
            };
            for t in terms {
                names.push((
                    t.name.to_owned(),
                    t.unit.to_owned(),
                    owner.clone(),
                    t.positive,
                ));
            }
            if block.elastic {
                names.push(("J_0".to_owned(), "%".to_owned(), owner.clone(), true));
            }
            for &m in &block.members {
                let single = self.model.curves.len() == 1;
                let of = if single { None } else { name(m) };
                names.push(("epsilon_0".to_owned(), "%".to_owned(), of, false));
            }
        }
        let best = self.numbers(&self.best);
        let drawn: Vec<Vec<f64>> = self.draws.iter().map(|d| self.numbers(d)).collect();
        let count = drawn.len() as f64;
        let mean: Vec<f64> = (0..best.len())
            .map(|i| drawn.iter().map(|d| d[i]).sum::<f64>() / count)
            .collect();
        if !drawn.is_empty() {
            self.covariance = (0..best.len())
                .map(|i| {
                    (0..best.len())
                        .map(|j| {
                            drawn
                                .iter()
                                .map(|d| (d[i] - mean[i]) * (d[j] - mean[j]))
                                .sum::<f64>()
                                / (count - 1.0)
                        })
                        .collect()
                })
                .collect();
        }
        self.parameters = names
            .into_iter()
            .enumerate()
            .map(|(i, (name, unit, specimen, positive))| {
                let mut values: Vec<f64> = drawn.iter().map(|d| d[i]).collect();
                values.sort_by(f64::total_cmp);
                let tail = 0.5 * (1.0 - self.level);
                let (low, high) = (quantile(&values, tail), quantile(&values, 1.0 - tail));
                let not_identifiable = if drawn.is_empty() {
                    None
                } else if let Some(shape) = self.model.shapes.get(i) {
                    let mut places: Vec<f64> = self.draws.iter().map(|d| d.places[i]).collect();
                    places.sort_by(f64::total_cmp);
                    let low = quantile(&places, tail);
                    let high = quantile(&places, 1.0 - tail);
                    undecided_shape(shape, low, high)
                } else {
                    undecided_amplitude(&name, positive, low, high)
                };
                Parameter {
                    name,
                    unit,
                    specimen,
                    value: best[i],
                    std_error: self
                        .covariance
                        .get(i)
                        .map_or(f64::NAN, |row| row[i].max(0.0).sqrt()),
                    low,
                    high,
                    interval: IntervalKind::Draws,
                    not_identifiable,
                }
            })
            .collect();
    }

    /// A parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }
}

/// An interval that fills most of what was searched, or ends at a bound, is no answer.
fn undecided_shape(shape: &Shape, low: f64, high: f64) -> Option<String> {
    /// An end this close to a bound (in parts of the searched range) is the bound.
    const AT_BOUND: f64 = 0.03;
    /// An interval this wide says nothing.
    const WIDE: f64 = 0.8;
    let (v_low, v_high) = (shape.value(low), shape.value(high));
    if high - low > WIDE {
        Some(format!(
            "anything from {v_low:.2e} to {v_high:.2e} {} fits",
            shape.unit
        ))
    } else if low < AT_BOUND && high > AT_BOUND {
        Some(format!("anything below {v_high:.3e} {} fits", shape.unit))
    } else if high > 1.0 - AT_BOUND && low < 1.0 - AT_BOUND {
        Some(format!("anything above {v_low:.3e} {} fits", shape.unit))
    } else {
        None
    }
}

/// An amplitude that is nothing or within a factor of thirty is not told.
fn undecided_amplitude(name: &str, positive: bool, low: f64, high: f64) -> Option<String> {
    /// From a thirtieth of the upper end on, zero is as good.
    const FACTOR: f64 = 30.0;
    (positive && name != "epsilon_0" && high > FACTOR * low)
        .then(|| format!("anything below {high:.3e} fits"))
}

/// Standard normal quantiles of the ranks of numbers (van der Waerden's scores).
pub(super) fn normal_scores(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut scores = vec![0.0; values.len()];
    for (rank, index) in order.into_iter().enumerate() {
        scores[index] =
            super::student::normal_quantile((rank as f64 + 1.0) / (values.len() as f64 + 1.0));
    }
    scores
}
