//! Linear problem at a point of the nonlinear parameters: columns, solution, likelihood.

use super::{Block, Fixed, Model, Point, REFERENCE_K};
use crate::curve::Curve;
use crate::linear;
use crate::noise::{Filter, Noise};

/// Gas constant, J/(mol K), exact since 2019.
const GAS: f64 = 8.314_462_618_153_24;
/// 0 °C in kelvin.
const ZERO_C_K: f64 = 273.15;

impl Model {
    /// Rows of a curve's columns at increasing times, one after another: terms, elastic step;
    /// without ε₀. `curve` is that with index `index`, or its continuation. Also returns the strain
    /// that no coefficient enters, m/m.
    pub(crate) fn rows(
        &self,
        values: &[f64],
        index: usize,
        curve: &Curve,
        times: &[f64],
        shared: usize,
    ) -> (Vec<f64>, Option<Vec<f64>>) {
        let steps = self.steps(values, index, curve);
        if let Some(plan) = &self.rope {
            let (shapes, held) = (&values[..self.law_shapes], &values[self.shapes.len()..]);
            let (rows, offset) = plan.rows(shapes, held, curve, &steps, times);
            return (rows, Some(offset));
        }
        // Boltzmann superposition of the law's responses to the steps before each time.
        let terms = self.terms.len();
        let shift = self.shift(values, curve);
        let level = |load: f64| match self.exponent {
            Some(index) => load.signum() * load.abs().powf(values[index]),
            None => load,
        };
        let mut response = vec![0.0; terms];
        let mut rows = vec![0.0; times.len() * shared];
        for (row, &t) in rows.chunks_mut(shared.max(1)).zip(times) {
            let mut before = 0.0;
            for &(start, load) in steps.iter().take_while(|step| step.0 <= t) {
                let now = level(load);
                let since = (t - start) * shift;
                self.law
                    .respond(&values[..self.law_shapes], since, &mut response);
                for (out, r) in row.iter_mut().zip(&response) {
                    *out += (now - before) * r;
                }
                if shared > terms {
                    row[terms] += now - before;
                }
                before = now;
            }
        }
        (rows, None)
    }

    /// Time scale factor from the temperature of a curve.
    fn shift(&self, values: &[f64], curve: &Curve) -> f64 {
        match (self.activation, curve.temperature_c) {
            (Some(index), Some(celsius)) => {
                (values[index] * 1e3 / GAS * (1.0 / REFERENCE_K - 1.0 / (celsius + ZERO_C_K))).exp()
            }
            _ => 1.0,
        }
    }

    /// Columns of a block, and its measurements minus the strain that no coefficient enters, over
    /// the scale.
    pub(crate) fn columns(&self, block: &Block, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (n, p) = (block.readings, block.positive.len());
        let shared = p - block.members.len();
        let mut columns = vec![0.0; n * p];
        let mut y = Vec::with_capacity(n);
        for (index, &member) in block.members.iter().enumerate() {
            let curve = &self.curves[member];
            let from = y.len();
            let readings = curve.time_s.len();
            columns[(shared + index) * n + from..][..readings].fill(1.0);
            let (rows, offset) = self.rows(values, member, curve, &curve.time_s, shared);
            for (i, row) in rows.chunks(shared.max(1)).enumerate() {
                for (j, value) in row.iter().enumerate() {
                    columns[j * n + from + i] = *value;
                }
            }
            let fixed_strain = |i: usize| offset.as_ref().map_or(0.0, |offset| offset[i]);
            let left = curve
                .strain
                .iter()
                .enumerate()
                .map(|(i, e)| e - fixed_strain(i));
            y.extend(left.map(|e| e / self.scale));
        }
        (columns, y)
    }

    /// Solves the linear problem at a point of the nonlinear parameters.
    pub(crate) fn solve(&self, x: &[f64], information: bool) -> Point {
        self.solve_values(&self.values(x), self.noise_at(x), information, None)
    }

    /// Solves it at values of the shapes and of the fixed parameters, with one coefficient fixed
    /// (its solution is 0).
    pub(crate) fn solve_values(
        &self,
        values: &[f64],
        noise: Noise,
        information: bool,
        fixed: Option<Fixed>,
    ) -> Point {
        let mut point = Point {
            noise,
            solutions: Vec::with_capacity(self.blocks.len()),
            squares: 0.0,
            log_det_noise: 0.0,
            log_det_information: 0.0,
            residuals: Vec::with_capacity(self.readings),
        };
        let mut filter = Filter::default();
        for (b, block) in self.blocks.iter().enumerate() {
            let (n, p) = (block.readings, block.positive.len());
            let (mut columns, mut y) = self.columns(block, values);
            if let Some(fixed) = fixed.filter(|f| f.block == b) {
                let column = &mut columns[fixed.column * n..(fixed.column + 1) * n];
                for (y, c) in y.iter_mut().zip(column) {
                    *y -= fixed.value * *c;
                    *c = 0.0;
                }
            }
            if information {
                point.log_det_information -= linear::log_det(&mut columns.clone(), n, p);
            }
            let mut at = 0;
            for &member in &block.members {
                let curve = &self.curves[member];
                let end = at + curve.time_s.len();
                filter.prepare(&self.clocks[member], &curve.count, noise);
                point.log_det_noise += filter.log_det;
                filter.whiten(&mut y[at..end]);
                for j in 0..p {
                    filter.whiten(&mut columns[j * n + at..j * n + end]);
                }
                at = end;
            }
            let solution = linear::solve(&mut columns, &mut y, &block.positive);
            point.residuals.extend_from_slice(&y);
            point.squares += solution.squares;
            point.log_det_information += solution.log_det;
            point.solutions.push(solution);
        }
        point
    }

    /// Residuals whose squares have their minimum where the likelihood has its maximum: `r̃
    /// |K|^{1/2n}`, since
    /// `n ln(r̃ᵀr̃) + ln |K| = n ln(r̃ᵀr̃ |K|^{1/n})`.
    pub(crate) fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.held_residuals(x, &self.held_z, None)
    }

    /// Residuals with the fixed parameters at deviations `held_z` from the base rope's values.
    pub(crate) fn held_residuals(
        &self,
        x: &[f64],
        held_z: &[f64],
        fixed: Option<Fixed>,
    ) -> Vec<f64> {
        let values = self.values_held(x, held_z);
        let mut point = self.solve_values(&values, self.noise_at(x), false, fixed);
        let factor = (0.5 * point.log_det_noise / self.readings as f64).exp();
        point.residuals.iter_mut().for_each(|r| *r *= factor);
        point.residuals
    }

    /// Restricted log-likelihood, with the coefficients and the size of the noise integrated out;
    /// flat in the unit-cube coordinates of the nonlinear parameters.
    pub(crate) fn log_restricted(&self, x: &[f64]) -> f64 {
        if x.iter().any(|x| !(0.0..=1.0).contains(x)) {
            return f64::NEG_INFINITY;
        }
        let point = self.solve(x, true);
        let free = self.readings.saturating_sub(self.coefficients()).max(1) as f64;
        let value = -0.5
            * (point.log_det_noise
                + point.log_det_information
                + free * point.squares.max(f64::MIN_POSITIVE).ln());
        if value.is_nan() {
            f64::NEG_INFINITY
        } else {
            value
        }
    }
}
