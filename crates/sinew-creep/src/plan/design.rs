//! Uncertainty that a fit of records would leave: free and fixed parameters as in the fit,
//! linearised about a rope.

use super::bench_test::strain;
use super::coordinate::moved;
use super::duty::Slopes;
use crate::curve::Curve;
use crate::rope_base::RopeBase;
use crate::rope_entry;
use crate::rope_law::RopePlan;
use sinew_model::cholesky;
use sinew_rope::law::tested_range::TestedRange;
use sinew_rope::law::{Parameter, Parameters};

/// Step of the differences, in standard deviations of a parameter's interval, or of its logarithm.
const STEP: f64 = 0.02;

/// Record with its sensitivity to every parameter.
pub(super) struct Record {
    curve: Curve,
    /// Change of every measurement per unit of every parameter's coordinate, over the measurement's
    /// standard deviation; zeros for parameters without an effect.
    slopes: Vec<Vec<f64>>,
    /// Change per unit of ε₀, divided by the standard deviation of the measurements and by that of the zero.
    zero: (f64, f64),
}

impl Record {
    pub(super) fn of(p: &Parameters, base: &RopeBase, curve: &Curve, reading_ratio: f64) -> Self {
        let at = |q: &Parameters| strain(q, curve);
        let slope = |parameter: &Parameter| -> Vec<f64> {
            let ends = [STEP, -STEP].map(|by| at(&moved(p, base, *parameter, by)));
            let [Some(up), Some(down)] = ends else {
                return vec![0.0; curve.time_s.len()];
            };
            let rows = up.iter().zip(&down).zip(&curve.count);
            rows.map(|((u, d), count)| (u - d) / (2.0 * STEP) * count.sqrt() / reading_ratio)
                .collect()
        };
        Self {
            slopes: Parameter::ALL.iter().map(slope).collect(),
            zero: (1.0 / reading_ratio, curve.zero_count.sqrt() / reading_ratio),
            curve: curve.clone(),
        }
    }
}

/// Information of a fit of records.
pub(super) struct Design {
    /// Indices of the fitted parameters of the law, then of those fixed within their interval.
    free: Vec<usize>,
    held: Vec<usize>,
    /// Lower Cholesky factor of the information, row by row: fitted, fixed, ε₀ of every record.
    factor: Vec<f64>,
    curves: Vec<Curve>,
}

fn index(parameter: Parameter) -> usize {
    Parameter::ALL
        .iter()
        .position(|p| *p == parameter)
        .unwrap_or(0)
}

impl Design {
    /// Linearises a fit; `None` if the rope law cannot be fitted to these records.
    pub(super) fn new(records: &[&Record], base: &RopeBase) -> Option<Self> {
        /// Prior standard deviation of a fitted parameter's coordinate from the searched range
        /// alone.
        const OPEN: f64 = 5.0;
        let curves: Vec<Curve> = records.iter().map(|r| r.curve.clone()).collect();
        let plan = RopePlan::new(&curves, base).ok()?;
        let free: Vec<usize> = plan
            .shapes
            .iter()
            .chain(&plan.terms)
            .map(|p| index(*p))
            .collect();
        let held: Vec<usize> = plan.held.iter().map(|(p, _)| index(*p)).collect();
        let numbers: Vec<usize> = free.iter().chain(&held).copied().collect();
        let n = numbers.len() + records.len();
        let mut information = vec![0.0; n * n];
        for (r, record) in records.iter().enumerate() {
            let own = numbers.len() + r;
            for (i, a) in numbers.iter().enumerate() {
                for (j, b) in numbers.iter().enumerate().take(i + 1) {
                    let pairs = record.slopes[*a].iter().zip(&record.slopes[*b]);
                    information[i * n + j] += pairs.map(|(a, b)| a * b).sum::<f64>();
                }
                let along: f64 = record.slopes[*a].iter().sum();
                information[own * n + i] += along * record.zero.0;
            }
            let readings = record.curve.time_s.len() as f64;
            information[own * n + own] += readings * record.zero.0.powi(2) + record.zero.1.powi(2);
        }
        for i in 0..numbers.len() {
            information[i * n + i] += if i < free.len() { OPEN.powi(-2) } else { 1.0 };
        }
        let mut factor = vec![0.0; n * n];
        cholesky::factorise(&information, &mut factor, n).ok()?;
        Some(Self {
            free,
            held,
            factor,
            curves,
        })
    }

    /// Variance of the logarithm of the duty's elongation after a fit, including the base rope's
    /// part for parameters that the fit does not affect. The correlations of a catalogue entry are
    /// a thousandth smaller than those of the fit, which matters if parameters compensate each
    /// other.
    pub(super) fn variance(&self, duty: &Slopes) -> f64 {
        let touched: Vec<usize> = self.free.iter().chain(&self.held).copied().collect();
        let mut along: Vec<f64> = touched.iter().map(|i| duty.slopes[*i]).collect();
        along.resize(self.numbers(), 0.0);
        let together = self.variance_along(along);
        let alone = |(place, i): (usize, &usize)| {
            let mut unit = vec![0.0; self.numbers()];
            unit[place] = duty.slopes[*i];
            self.variance_along(unit)
        };
        let apart: f64 = touched.iter().enumerate().map(alone).sum();
        let shrink = rope_entry::SHRINK;
        shrink * together + (1.0 - shrink) * apart + duty.variance_without(&touched)
    }

    /// Number of fitted and fixed parameters, and an ε₀ for every record.
    fn numbers(&self) -> usize {
        self.free.len() + self.held.len() + self.curves.len()
    }

    /// `b' (L L')⁻¹ b = |L⁻¹ b|²`.
    fn variance_along(&self, mut b: Vec<f64>) -> f64 {
        cholesky::forward(&self.factor, b.len(), &mut b);
        b.iter().map(|x| x * x).sum()
    }

    /// Tested range of the entry that the fit would write.
    pub(super) fn tested_range(&self, base: &RopeBase) -> TestedRange {
        rope_entry::tested_range_of(&self.curves, base)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Analytic value: two numbers of a fit, `b = (1, 2)` along them, and one it does not affect.
    // `L⁻¹ b = (1/2, (2 − 1/2)/3)`, so together they contribute 1/2. One by one it is `(1/2, −1/6)`
    // and `(0, 2/3)`: 13/18.
    #[test]
    fn variance_matches_analytic_value() {
        let design = Design {
            free: vec![2],
            held: vec![0],
            factor: vec![2.0, 0.0, 1.0, 3.0],
            curves: Vec::new(),
        };
        let mut duty = Slopes {
            slopes: vec![2.0, 3.0, 1.0],
            stated: vec![true; 3],
        };
        let fitted = 0.999 * 0.5 + 0.001 * 13.0 / 18.0;
        assert!((design.variance(&duty) - (fitted + 9.0)).abs() < 1e-12);
        // A parameter without an interval in the base contributes nothing.
        duty.stated[1] = false;
        assert!((design.variance(&duty) - fitted).abs() < 1e-12);
    }
}
