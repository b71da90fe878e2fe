//! Derivatives of the residuals for the search.
//!
//! The linear coefficients are eliminated: `r = P W (y − Φ β)` with the projector `P` onto what the
//! columns don't explain. Kaufman's approximation (BIT 15, 1975), `∂r ≈ −P W ∂Φ β`, leaves out only
//! what is orthogonal to `r`, so that the gradient `∂rᵀ r` is exact.

use super::{Block, Model};
use crate::linear::{self, Solution};
use crate::noise::{Filter, Noise};

/// Half width of the differences where there is no closed form.
const STEP: f64 = 6e-6;

/// A block at a point: everything a derivative needs.
struct Solved<'a> {
    block: &'a Block,
    /// Whitened columns, for a coefficient at its bound.
    whitened: Vec<f64>,
    basis: Vec<f64>,
    solution: Solution,
    /// `y − Φ β`, not whitened.
    error: Vec<f64>,
    /// Whitened.
    residual: Vec<f64>,
    filters: Vec<Filter>,
}

impl Solved<'_> {
    /// Takes away what the columns explain.
    fn project(&self, y: &mut [f64]) {
        let positive = &self.block.positive;
        let bound = |j: usize| positive[j] && self.solution.beta[j] == 0.0;
        if (0..positive.len()).any(bound) {
            let kept: Vec<bool> = (0..positive.len()).map(|j| !bound(j)).collect();
            linear::project_out(&mut self.whitened.clone(), y, &kept);
        } else {
            self.solution.remove(&self.basis, y);
        }
    }
}

impl Model {
    /// Derivatives of [`Model::likelihood_residuals`] with the nonlinear parameters, column after
    /// column.
    pub(crate) fn likelihood_slopes(&self, x: &[f64]) -> Vec<f64> {
        let (n, d) = (self.readings, x.len());
        let values = self.values(x);
        let noise = self.noise_at(x);
        let mut slopes = vec![0.0; n * d];
        let mut log_det = 0.0;
        let mut log_det_slopes = vec![0.0; d];
        let mut from = 0;
        let mut residuals = Vec::with_capacity(n);
        for block in &self.blocks {
            let solved = self.solved(block, &values, noise);
            log_det += solved.filters.iter().map(|f| f.log_det).sum::<f64>();
            for k in 0..d {
                let out = &mut slopes[k * n + from..k * n + from + block.readings];
                if k < self.shapes.len() {
                    self.shape_slope(&solved, &values, x, k, out);
                } else {
                    log_det_slopes[k] += self.noise_slope(&solved, x, k, out);
                }
                solved.project(out);
            }
            residuals.extend_from_slice(&solved.residual);
            from += block.readings;
        }
        let factor = (0.5 * log_det / n as f64).exp();
        for (column, log_det) in slopes.chunks_mut(n.max(1)).zip(&log_det_slopes) {
            let along = 0.5 * log_det / n as f64;
            for (slope, residual) in column.iter_mut().zip(&residuals) {
                *slope = factor * (*slope + along * residual);
            }
        }
        slopes
    }

    fn solved<'a>(&'a self, block: &'a Block, values: &[f64], noise: Noise) -> Solved<'a> {
        let (n, p) = (block.readings, block.positive.len());
        let (mut columns, mut y) = self.columns(block, values);
        let (raw, mut error) = (columns.clone(), y.clone());
        let mut filters = Vec::with_capacity(block.members.len());
        let mut at = 0;
        for &member in &block.members {
            let curve = &self.curves[member];
            let end = at + curve.time_s.len();
            let mut filter = Filter::default();
            filter.prepare(&self.clocks[member], &curve.count, noise);
            filter.whiten(&mut y[at..end]);
            for j in 0..p {
                filter.whiten(&mut columns[j * n + at..j * n + end]);
            }
            filters.push(filter);
            at = end;
        }
        let whitened = columns.clone();
        let solution = linear::solve(&mut columns, &mut y, &block.positive);
        for (column, beta) in raw.chunks(n.max(1)).zip(&solution.beta) {
            for (error, value) in error.iter_mut().zip(column) {
                *error -= beta * value;
            }
        }
        Solved {
            block,
            whitened,
            basis: columns,
            solution,
            error,
            residual: y,
            filters,
        }
    }

    /// `−W ∂Φ β` with a shape's coordinate.
    fn shape_slope(
        &self,
        solved: &Solved<'_>,
        values: &[f64],
        x: &[f64],
        k: usize,
        out: &mut [f64],
    ) {
        let beta = &solved.solution.beta;
        let shared = beta.len() - solved.block.members.len();
        let mut at = 0;
        for (&member, filter) in solved.block.members.iter().zip(&solved.filters) {
            let curve = &self.curves[member];
            let out = &mut out[at..at + curve.time_s.len()];
            if self.rope.is_none() && k < self.law_shapes {
                self.closed_slope(values, member, &beta[..shared], k, out);
            } else if self
                .moments
                .iter()
                .all(|m| m.shape != k || m.curve == member)
            {
                self.difference(x, member, &beta[..shared], k, out);
            } else {
                // Another curve's moment.
                out.fill(0.0);
            }
            filter.whiten(out);
            at += curve.time_s.len();
        }
    }

    fn closed_slope(&self, values: &[f64], member: usize, beta: &[f64], k: usize, out: &mut [f64]) {
        let curve = &self.curves[member];
        let steps = self.steps(values, member, curve);
        let conditions = self.conditions(values, curve);
        let shapes = &values[..self.law_shapes];
        let inner = -self.shapes[k].slope(values[k]);
        let mut slopes = [0.0; 4];
        for (out, &t) in out.iter_mut().zip(&curve.time_s) {
            let mut before = 0.0;
            *out = 0.0;
            for &(start, load) in steps.iter().take_while(|step| step.0 <= t) {
                let now = conditions.level(load);
                let since = (t - start) * conditions.shift;
                let slopes = &mut slopes[..self.law_shapes];
                self.law.slopes(shapes, beta, since, slopes);
                *out += (now - before) * slopes[k];
                before = now;
            }
            *out *= inner;
        }
    }

    /// The same by differences of the columns.
    fn difference(&self, x: &[f64], member: usize, beta: &[f64], k: usize, out: &mut [f64]) {
        let curve = &self.curves[member];
        let strain = |unit: f64| -> Vec<f64> {
            let mut x = x.to_vec();
            x[k] = unit;
            let values = self.values(&x);
            let (rows, offset) = self.rows(&values, member, curve, &curve.time_s, beta.len());
            (0..curve.time_s.len())
                .map(|i| {
                    let row = &rows[i * beta.len()..(i + 1) * beta.len()];
                    let sum: f64 = row.iter().zip(beta).map(|(r, b)| r * b).sum();
                    sum + offset.as_ref().map_or(0.0, |o| o[i] / self.scale)
                })
                .collect()
        };
        let (low, high) = ((x[k] - STEP).max(0.0), (x[k] + STEP).min(1.0));
        let (down, up) = (strain(low), strain(high));
        for (out, (up, down)) in out.iter_mut().zip(up.iter().zip(&down)) {
            *out = (down - up) / (high - low);
        }
    }

    /// `∂W (y − Φ β)` with the noise's share or memory; returns the derivative of `ln |K|`.
    fn noise_slope(&self, solved: &Solved<'_>, x: &[f64], k: usize, out: &mut [f64]) -> f64 {
        let (low, high) = ((x[k] - STEP).max(0.0), (x[k] + STEP).min(1.0));
        let mut filter = Filter::default();
        let mut log_det = 0.0;
        let mut ends = [solved.error.clone(), solved.error.clone()];
        for (end, (unit, sign)) in ends.iter_mut().zip([(low, -1.0), (high, 1.0)]) {
            let mut x = x.to_vec();
            x[k] = unit;
            let noise = self.noise_at(&x);
            let mut at = 0;
            for &member in &solved.block.members {
                let curve = &self.curves[member];
                let to = at + curve.time_s.len();
                filter.prepare(&self.clocks[member], &curve.count, noise);
                filter.whiten(&mut end[at..to]);
                log_det += sign * filter.log_det;
                at = to;
            }
        }
        for (out, (down, up)) in out.iter_mut().zip(ends[0].iter().zip(&ends[1])) {
            *out = (up - down) / (high - low);
        }
        log_det / (high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Curve, FitOptions, Law, NoiseKind, RopeBase, Share, Tension};
    use sinew_rope::Catalogue;

    /// Two loads, one unloaded, two temperatures.
    fn curves() -> Vec<Curve> {
        [(1.0, 23.0), (0.6, 41.0)]
            .into_iter()
            .map(|(load, celsius)| {
                let time: Vec<f64> = (0..30).map(|i| 5.0 * 1.25_f64.powi(i)).collect();
                let strain = |t: f64| {
                    let wave = 1e-4 * (12.9898 * t).sin();
                    load * (1e-3 * (t / 60.0).ln_1p() + 2e-3 * -(-t / 900.0).exp_m1()) + wave
                };
                let values = time.iter().map(|t| strain(*t)).collect();
                let mut curve = Curve::constant_load("made", time, values);
                curve.steps = vec![(0.0, load), (2500.0, 0.1)];
                curve.temperature_c = Some(celsius);
                curve.tension = Some(Tension {
                    preload_n: 2.0,
                    per_step_n: 100.0,
                    preloaded_s: 60.0,
                });
                curve
            })
            .collect()
    }

    #[test]
    fn the_gradient_is_the_squares_own() {
        let catalogue = Catalogue::shipped().expect("shipped");
        let entry = catalogue
            .find("liros-dc000-0301")
            .expect("there")
            .entry
            .clone();
        let base = std::sync::Arc::new(RopeBase::new(entry).expect("complete"));
        for law in Law::ALL.into_iter().chain([Law::Rope]) {
            for (share, noise) in [
                (Share::All, NoiseKind::Correlated),
                (Share::Shape, NoiseKind::White),
            ] {
                let options = FitOptions {
                    share,
                    noise,
                    rope: Some(base.clone()),
                    ..FitOptions::default()
                };
                let model = Model::new(law, curves(), &options).expect("a model");
                let d = model.dimension();
                for place in [0.3, 0.55] {
                    let x: Vec<f64> = (0..d).map(|k| place + 0.03 * k as f64).collect();
                    check(&model, &x);
                }
            }
        }
    }

    fn check(model: &Model, x: &[f64]) {
        let squares = |x: &[f64]| -> f64 {
            let r = model.likelihood_residuals(x, None);
            0.5 * r.iter().map(|r| r * r).sum::<f64>()
        };
        let slopes = model.likelihood_slopes(x);
        let residuals = model.likelihood_residuals(x, None);
        for (k, column) in slopes.chunks(residuals.len()).enumerate() {
            let found: f64 = column.iter().zip(&residuals).map(|(s, r)| s * r).sum();
            let mut at = x.to_vec();
            at[k] = x[k] + 1e-5;
            let up = squares(&at);
            at[k] = x[k] - 1e-5;
            let expected = (up - squares(&at)) / 2e-5;
            // Truncation and rounding of a central difference: 1e-9 of the squares over the step.
            let error = (found - expected).abs();
            let size = squares(x) + expected.abs();
            assert!(
                error < 1e-5 * size,
                "{:?} {k}: {found} {expected}",
                model.law
            );
        }
    }
}
