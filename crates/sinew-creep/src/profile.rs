//! Intervals by profile likelihood: a value belongs to the interval if the likelihood, with all
//! other parameters fitted again, is not much smaller than the maximum.

use super::draw::Draw;
use super::fixed_parameters::moving;
use super::model::{Fixed, Model};
use super::options::IntervalKind;
use super::parameter::Parameter;
use super::solver::{half_squares, minimum};
use super::student::student_quantile;

/// Parameter that is fixed in a profile search.
#[derive(Debug, Clone, Copy)]
enum Kept {
    Nothing,
    Shape { index: usize, value: f64 },
    Coefficient(Fixed),
}

/// Profile search over the nonlinear parameters except the fixed one, and over the deviations of
/// the base rope's parameters that affect the others. Their deviations are penalised by the base
/// rope's own interval.
struct Profile<'a> {
    model: &'a Model,
    held: &'a [usize],
    least: f64,
    threshold: f64,
}

/// Maximum number of steps of a search.
const STEPS: u64 = 40;

impl Profile<'_> {
    /// Maximum deviation from the base rope's value that is searched, in standard deviations.
    const MAX_DEVIATION_STDS: f64 = 4.0;

    /// Nonlinear parameters, and the deviations of all fixed base parameters.
    fn full(&self, x: &[f64], kept: Kept) -> (Vec<f64>, Vec<f64>) {
        let (own, base) = x.split_at(x.len() - self.held.len());
        let mut full = own.to_vec();
        if let Kept::Shape { index, value } = kept {
            full.insert(index, value);
        }
        let mut held_z = self.model.held_z.clone();
        for (index, u) in self.held.iter().zip(base) {
            held_z[*index] = Self::MAX_DEVIATION_STDS * (2.0 * u - 1.0);
        }
        (full, held_z)
    }

    fn residuals(&self, x: &[f64], kept: Kept) -> Vec<f64> {
        let fixed = match kept {
            Kept::Coefficient(fixed) => Some(fixed),
            Kept::Nothing | Kept::Shape { .. } => None,
        };
        let (full, held_z) = self.full(x, kept);
        let mut residuals = self.model.held_residuals(&full, &held_z, fixed);
        // A deviation subtracts `z²` from twice the log-likelihood: the squares `S` become `S
        // exp(Σz²/n)`.
        let off: f64 = held_z.iter().map(|z| z * z).sum();
        let n = self.model.readings as f64;
        let each = if off > 0.0 {
            (off / n).exp_m1() / off
        } else {
            1.0 / n
        };
        let weight = (2.0 * half_squares(&residuals) * each).sqrt();
        residuals.extend(self.held.iter().map(|index| weight * held_z[*index]));
        residuals
    }

    /// Decrease of the log-likelihood over the threshold: 1 at the interval's ends. `warm` is
    /// updated.
    fn excess(&self, kept: Kept, start: &[f64], warm: &mut Vec<f64>) -> f64 {
        let residuals = |x: &[f64]| self.residuals(x, kept);
        let near = minimum(&residuals, warm, STEPS);
        let fresh = minimum(&residuals, start, STEPS);
        let best = if fresh.cost < near.cost { fresh } else { near };
        *warm = best.x;
        self.model.readings as f64 * (best.cost / self.least).ln() / self.threshold
    }

    /// End of the interval on one side, or the bound if it lies within the interval. `start` is the
    /// optimum without the fixed parameter.
    fn end(
        &self,
        kept: impl Fn(f64) -> Kept,
        start: &[f64],
        centre: f64,
        first_step: f64,
        bound: f64,
    ) -> f64 {
        /// Width of the last bracket over the half-width.
        const BRACKET_TOLERANCE: f64 = 0.01;
        const MAX_ITERATIONS: usize = 30;
        let mut warm = start.to_vec();
        let (mut inside, mut outside) = (centre, None);
        let mut step = first_step;
        for _ in 0..MAX_ITERATIONS {
            let tried = match outside {
                None if (bound - inside - step) * step <= 0.0 => bound,
                None => inside + step,
                Some(outside) => 0.5 * (inside + outside),
            };
            if self.excess(kept(tried), start, &mut warm) < 1.0 {
                inside = tried;
                if tried == bound {
                    return bound;
                }
                step *= 1.7;
            } else {
                outside = Some(tried);
            }
            if outside.is_some_and(|o| (o - inside).abs() < BRACKET_TOLERANCE * (o - centre).abs())
            {
                break;
            }
        }
        outside.map_or(inside, |outside| 0.5 * (inside + outside))
    }
}

/// Replaces intervals by those of the profile likelihood.
///
/// `n ln(S(v)/S) ≤ n ln(1 + t²/(n − k))`, the F test of a linear law, `S` the whitened squares with
/// jointly fitted noise. Each parameter fixed at a base rope's value counts as one more measurement
/// with that rope's interval.
pub(super) fn intervals(parameters: &mut [Parameter], model: &Model, best: &Draw, level: f64) {
    let held = moving(model, &best.unit);
    let t = student_quantile(model.freedom(), level);
    let mut profile = Profile {
        model,
        held: &held,
        least: f64::NAN,
        threshold: model.readings as f64 * (t * t / model.freedom()).ln_1p(),
    };
    let mut optimum = best.unit.clone();
    optimum.resize(best.unit.len() + held.len(), 0.5);
    let free = |x: &[f64]| profile.residuals(x, Kept::Nothing);
    if !held.is_empty() {
        optimum = minimum(&free, &optimum, STEPS).x;
    }
    profile.least = half_squares(&free(&optimum));
    let mut ends = Vec::new();
    for (index, shape) in model.shapes[..model.law_numbers()].iter().enumerate() {
        let mut start = optimum.clone();
        let centre = start.remove(index);
        let end = |step, bound| {
            let kept = |value| Kept::Shape { index, value };
            shape.value(profile.end(kept, &start, centre, step, bound))
        };
        ends.push((end(-0.05, 0.0), end(0.05, 1.0)));
    }
    let (full, held_z) = profile.full(&optimum, Kept::Nothing);
    let values = model.values_held(&full, &held_z);
    let point = model.solve_values(&values, model.noise_at(&full), false, None);
    for (block, own) in model.blocks.iter().enumerate() {
        for (column, positive) in own.positive.iter().enumerate() {
            let centre = point.solutions[block].beta[column];
            let end = |step, bound| {
                let kept = |value| {
                    Kept::Coefficient(Fixed {
                        block,
                        column,
                        value,
                    })
                };
                model.number(column, profile.end(kept, &optimum, centre, step, bound))
            };
            let step = (0.1 * centre.abs()).max(1e-3);
            let (a, b) = (
                end(-step, if *positive { 0.0 } else { -1e9 }),
                end(step, 1e9),
            );
            ends.push((a.min(b), a.max(b)));
        }
    }
    for (parameter, (low, high)) in parameters.iter_mut().zip(ends) {
        parameter.low = low;
        parameter.high = high;
        parameter.interval = IntervalKind::Profile;
    }
}
