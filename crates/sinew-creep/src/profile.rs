//! Intervals by profile likelihood: a value belongs to the interval when all the other numbers,
//! fitted anew with it kept, make the readings not much less likely.

use super::draw::Draw;
use super::held::moving;
use super::model::{Fixed, Model};
use super::options::IntervalKind;
use super::parameter::Parameter;
use super::solver::{LeastSquares, Residuals, TrustRegion};
use super::student::student_quantile;

/// What is kept.
#[derive(Debug, Clone, Copy)]
enum Kept {
    Nothing,
    Shape { index: usize, value: f64 },
    Coefficient(Fixed),
}

/// What is searched: the nonlinear parameters but the one that is kept, then what is held at the base rope's value and moves
/// the others. Being off it costs what the base rope's own interval says.
#[derive(Clone, Copy)]
struct Constrained<'a> {
    model: &'a Model,
    held: &'a [usize],
    kept: Kept,
}

impl Constrained<'_> {
    /// Deviations from the base rope's value that are searched.
    const WIDEST: f64 = 4.0;

    /// The nonlinear parameters, and the deviations of all that is held.
    fn full(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (own, beside) = x.split_at(x.len() - self.held.len());
        let mut full = own.to_vec();
        if let Kept::Shape { index, value } = self.kept {
            full.insert(index, value);
        }
        let mut held_z = self.model.held_z.clone();
        for (index, u) in self.held.iter().zip(beside) {
            held_z[*index] = Self::WIDEST * (2.0 * u - 1.0);
        }
        (full, held_z)
    }

    /// A coefficient where the rest is at `x`.
    fn coefficient(&self, x: &[f64], block: usize, column: usize) -> f64 {
        let (full, held_z) = self.full(x);
        let values = self.model.values_held(&full, &held_z);
        let noise = self.model.noise_at(&full);
        self.model
            .solve_values(&values, noise, false, None)
            .solutions[block]
            .beta[column]
    }
}

impl Residuals for Constrained<'_> {
    fn parameters(&self) -> usize {
        self.model.dimension() + self.held.len()
            - usize::from(matches!(self.kept, Kept::Shape { .. }))
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        let fixed = match self.kept {
            Kept::Coefficient(fixed) => Some(fixed),
            Kept::Nothing | Kept::Shape { .. } => None,
        };
        let (full, held_z) = self.full(x);
        self.model.held_residuals(&full, &held_z, fixed)
    }
}

/// One parameter's profile.
struct Profile<'a, K> {
    free: Constrained<'a>,
    /// What keeping the parameter at a value is.
    kept: K,
    /// Where all is best, without what is kept.
    start: Vec<f64>,
    least: f64,
    threshold: f64,
}

impl<K: Fn(f64) -> Kept> Profile<'_, K> {
    /// How much less likely, over the threshold: 1 at the interval's ends. `warm` follows.
    fn excess(&self, value: f64, warm: &mut Vec<f64>) -> f64 {
        let problem = Constrained {
            kept: (self.kept)(value),
            ..self.free
        };
        let solver = TrustRegion { steps: 40 };
        let near = solver.minimum(&problem, warm);
        let fresh = solver.minimum(&problem, &self.start);
        let best = if fresh.cost < near.cost { fresh } else { near };
        *warm = best.x;
        let n = self.free.model.readings as f64;
        n * (best.cost / self.least).ln() / self.threshold
    }

    /// The end of the interval on one side, or the bound where even that is likely enough.
    fn end(&self, centre: f64, first_step: f64, bound: f64) -> f64 {
        /// Width of the last bracket over the half width.
        const FINE: f64 = 0.01;
        const MOST: usize = 30;
        let mut warm = self.start.clone();
        let (mut inside, mut outside) = (centre, None);
        let mut step = first_step;
        for _ in 0..MOST {
            let tried = match outside {
                None => {
                    let next = inside + step;
                    if (bound - next) * step <= 0.0 {
                        bound
                    } else {
                        next
                    }
                }
                Some(outside) => 0.5 * (inside + outside),
            };
            if self.excess(tried, &mut warm) < 1.0 {
                inside = tried;
                if tried == bound {
                    return bound;
                }
                step *= 1.7;
            } else {
                outside = Some(tried);
            }
            if let Some(outside) = outside
                && (outside - inside).abs() < FINE * (outside - centre).abs()
            {
                break;
            }
        }
        outside.map_or(inside, |outside| 0.5 * (inside + outside))
    }
}

/// Replaces intervals by those of the profile likelihood.
///
/// `n ln(S(v)/S) ≤ n ln(1 + t²/(n − k))`, the F test of a linear law, `S` the whitened squares
/// with the noise fitted along. What is held at a base rope's value counts as one more reading each, by that rope's interval.
pub(super) fn intervals(parameters: &mut [Parameter], model: &Model, best: &Draw, level: f64) {
    let held = moving(model, &best.unit);
    let free = Constrained {
        model,
        held: &held,
        kept: Kept::Nothing,
    };
    let mut likeliest = best.unit.clone();
    likeliest.resize(free.parameters(), 0.5);
    if !held.is_empty() {
        likeliest = TrustRegion { steps: 40 }.minimum(&free, &likeliest).x;
    }
    let residuals = free.residuals(&likeliest);
    let least = 0.5 * residuals.iter().map(|r| r * r).sum::<f64>();
    let n = model.readings as f64;
    let t = student_quantile(model.freedom(), level);
    let threshold = n * (t * t / model.freedom()).ln_1p();
    let mut ends = Vec::new();
    for index in 0..model.law_numbers() {
        let mut start = likeliest.clone();
        let centre = start.remove(index);
        let profile = Profile {
            free,
            kept: |value| Kept::Shape { index, value },
            start,
            least,
            threshold,
        };
        let low = profile.end(centre, -0.05, 0.0);
        let high = profile.end(centre, 0.05, 1.0);
        let shape = &model.shapes[index];
        ends.push((shape.value(low), shape.value(high)));
    }
    for (block, own) in model.blocks.iter().enumerate() {
        for column in 0..own.positive.len() {
            let profile = Profile {
                free,
                kept: |value| {
                    Kept::Coefficient(Fixed {
                        block,
                        column,
                        value,
                    })
                },
                start: likeliest.clone(),
                least,
                threshold,
            };
            let centre = free.coefficient(&likeliest, block, column);
            let step = (0.1 * centre.abs()).max(1e-3);
            let bound = if own.positive[column] { 0.0 } else { -1e9 };
            let low = profile.end(centre, -step, bound);
            let high = profile.end(centre, step, 1e9);
            let (a, b) = (model.number(column, low), model.number(column, high));
            ends.push((a.min(b), a.max(b)));
        }
    }
    for (parameter, (low, high)) in parameters.iter_mut().zip(ends) {
        parameter.low = low;
        parameter.high = high;
        parameter.interval = IntervalKind::Profile;
    }
}
