//! Draw of all numbers of a law, and the strain it predicts.

use super::curve::Curve;
use super::model::Model;
use super::noise::Noise;

/// Draw of all numbers of a law.
#[derive(Debug, Clone)]
pub(super) struct Draw {
    pub(super) values: Vec<f64>,
    /// Nonlinear parameters in the unit cube.
    pub(super) unit: Vec<f64>,
    pub(super) noise: Noise,
    pub(super) sigma: f64,
    /// Coefficients of every block, strain over the model's scale.
    pub(super) beta: Vec<Vec<f64>>,
}

impl Draw {
    /// Maximum-likelihood numbers at a point of the unit cube.
    pub(super) fn at(model: &Model, unit: &[f64]) -> Draw {
        let point = model.solve(unit, false);
        Draw {
            values: model.values(unit),
            unit: unit.to_vec(),
            noise: point.noise,
            sigma: (point.squares / model.freedom()).sqrt(),
            beta: point.solutions.iter().map(|s| s.beta.clone()).collect(),
        }
    }

    /// Values of the parameters in their order and units: shapes of the law, then coefficients by
    /// block.
    pub(super) fn numbers(&self, model: &Model) -> Vec<f64> {
        let mut numbers = self.values[..model.law_numbers()].to_vec();
        for beta in &self.beta {
            for (j, b) in beta.iter().enumerate() {
                numbers.push(model.number(j, *b));
            }
        }
        numbers
    }

    /// Strain of the curve with index `curve`, m/m, at increasing times.
    pub(super) fn strain(&self, model: &Model, curve: usize, time_s: &[f64]) -> Vec<f64> {
        self.strain_under(model, curve, &model.curves[curve], time_s)
    }

    /// Strain of the curve with index `curve`, m/m, at increasing times, under the loads and at the
    /// temperature of `member`.
    pub(super) fn strain_under(
        &self,
        model: &Model,
        curve: usize,
        member: &Curve,
        time_s: &[f64],
    ) -> Vec<f64> {
        let Some((block, place)) = model.blocks.iter().enumerate().find_map(|(b, block)| {
            let place = block.members.iter().position(|m| *m == curve)?;
            Some((b, place))
        }) else {
            return vec![f64::NAN; time_s.len()];
        };
        let beta = &self.beta[block];
        let shared = beta.len() - model.blocks[block].members.len();
        let (rows, offset) = model.rows(&self.values, curve, member, time_s, shared);
        (0..time_s.len())
            .map(|i| {
                let row = &rows[i * shared..(i + 1) * shared];
                let sum: f64 = row.iter().zip(beta).map(|(r, b)| r * b).sum();
                (sum + beta[shared + place]) * model.scale + offset.as_ref().map_or(0.0, |o| o[i])
            })
            .collect()
    }
}
