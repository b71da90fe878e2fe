//! Intervals by profile likelihood: a value belongs to the interval when all the other numbers,
//! fitted anew with it kept, make the readings not much less likely.

use super::draw::Draw;
use super::model::{Fixed, Model};
use super::options::IntervalKind;
use super::parameter::Parameter;
use super::search::Search;
use super::solver::{LeastSquares, Residuals, TrustRegion};
use super::student::student_quantile;

/// What is kept.
#[derive(Debug, Clone, Copy)]
enum Kept {
    Shape(usize),
    Coefficient { block: usize, column: usize },
}

struct Constrained<'a> {
    model: &'a Model,
    kept: Kept,
    value: f64,
}

impl Constrained<'_> {
    fn full(&self, x: &[f64]) -> Vec<f64> {
        let mut full = x.to_vec();
        if let Kept::Shape(index) = self.kept {
            full.insert(index, self.value);
        }
        full
    }
}

impl Residuals for Constrained<'_> {
    fn parameters(&self) -> usize {
        self.model.dimension() - usize::from(matches!(self.kept, Kept::Shape(_)))
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        let fixed = match self.kept {
            Kept::Shape(_) => None,
            Kept::Coefficient { block, column } => Some(Fixed {
                block,
                column,
                value: self.value,
            }),
        };
        self.model.likelihood_residuals(&self.full(x), fixed)
    }
}

/// One parameter's profile.
struct Profile<'a> {
    model: &'a Model,
    kept: Kept,
    /// Where all is best, without what is kept.
    start: Vec<f64>,
    least: f64,
    threshold: f64,
}

impl Profile<'_> {
    /// How much less likely, over the threshold: 1 at the interval's ends. `warm` follows.
    fn excess(&self, value: f64, warm: &mut Vec<f64>) -> f64 {
        let problem = Constrained {
            model: self.model,
            kept: self.kept,
            value,
        };
        let solver = TrustRegion { steps: 40 };
        let near = solver.minimum(&problem, warm);
        let fresh = solver.minimum(&problem, &self.start);
        let best = if fresh.cost < near.cost { fresh } else { near };
        *warm = best.x;
        let n = self.model.readings as f64;
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
/// with the noise fitted along.
pub(super) fn intervals(parameters: &mut [Parameter], model: &Model, best: &Draw, level: f64) {
    let residuals = Search(model).residuals(&best.unit);
    let least = 0.5 * residuals.iter().map(|r| r * r).sum::<f64>();
    let n = model.readings as f64;
    let t = student_quantile(model.freedom(), level);
    let threshold = n * (t * t / model.freedom()).ln_1p();
    let mut ends = Vec::new();
    for index in 0..model.law_numbers() {
        let mut start = best.unit.clone();
        let centre = start.remove(index);
        let profile = Profile {
            model,
            kept: Kept::Shape(index),
            start,
            least,
            threshold,
        };
        let low = profile.end(centre, -0.05, 0.0);
        let high = profile.end(centre, 0.05, 1.0);
        let shape = &model.shapes[index];
        ends.push((shape.value(low), shape.value(high)));
    }
    for (b, block) in model.blocks.iter().enumerate() {
        for column in 0..block.positive.len() {
            let profile = Profile {
                model,
                kept: Kept::Coefficient { block: b, column },
                start: best.unit.clone(),
                least,
                threshold,
            };
            let centre = best.beta[b][column];
            let step = (0.1 * centre.abs()).max(1e-3);
            let bound = if block.positive[column] { 0.0 } else { -1e9 };
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
