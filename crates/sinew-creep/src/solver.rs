//! Least squares within the unit box: Levenberg-Marquardt method with an active set of bounds.
//!
//! A step minimises `gᵀs + ½ sᵀ(JᵀJ + S + λD)s` within the box, `D` the largest diagonal of `JᵀJ`
//! so far. `S` is a secant estimate of the curvature that `JᵀJ` neglects: residuals of a fit are
//! not small, and the noise parameters have as much curvature in `S` as in `JᵀJ`. Each step uses
//! the model, with or without `S`, that predicted the previous one better.
//!
//! # Source
//! J. J. Moré, *The Levenberg–Marquardt Algorithm*, Lecture Notes in Mathematics 630, 1978 (scaling); H. B. Nielsen, *Damping
//! Parameter in Marquardt's Method*, IMM-REP-1999-05 (damping); J. E. Dennis, D. M. Gay, R. E. Welsch, *An Adaptive Nonlinear
//! Least-Squares Algorithm*, ACM TOMS 7, 1981 (secant estimate and its size).

use serde::{Deserialize, Serialize};
use sinew_files::interrupt;
use sinew_model::cholesky::{dot, factorise, solve};

/// Reason for the termination of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// No searched parameter: the linear problem has one solution.
    Linear,
    /// Projected gradient zero within its tolerance.
    Gradient,
    /// Last step shorter than its tolerance.
    Step,
    /// Last decrease of the cost below its tolerance.
    Cost,
    /// No further progress within rounding errors.
    NoProgress,
    /// Maximum number of steps reached.
    StepLimit,
    /// Search aborted because of a non-finite cost.
    Failed,
}

impl Termination {
    /// Whether the search ended by a convergence criterion.
    pub fn converged(self) -> bool {
        !matches!(self, Termination::StepLimit | Termination::Failed)
    }
}

/// Termination of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ending {
    /// Reason of the termination.
    pub termination: Termination,
    /// Number of steps.
    pub steps: u64,
}

/// Result of a search.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Minimum {
    /// Parameters, each between 0 and 1.
    pub(super) x: Vec<f64>,
    /// Half the sum of squares.
    pub(super) cost: f64,
    pub(super) ending: Ending,
}

/// Residuals at parameters between 0 and 1; their number is constant.
pub(super) type Residuals<'a> = dyn Fn(&[f64]) -> Vec<f64> + 'a;

/// Derivatives of residuals, parameter by parameter, by central differences within the box.
pub(super) fn slopes(residuals: &Residuals<'_>, x: &[f64], step: f64) -> Vec<Vec<f64>> {
    let mut at = x.to_vec();
    let slope = |j: usize| {
        let (low, high) = ((x[j] - step).max(0.0), (x[j] + step).min(1.0));
        let [down, up] = [low, high].map(|end| {
            at[j] = end;
            residuals(&at)
        });
        at[j] = x[j];
        let pairs = up.iter().zip(&down);
        pairs.map(|(u, d)| (u - d) / (high - low)).collect()
    };
    (0..x.len()).map(slope).collect()
}

/// Computes half the sum of squares.
pub(super) fn half_squares(residuals: &[f64]) -> f64 {
    0.5 * dot(residuals, residuals)
}

/// Minimises the squares from `start`, with a maximum number of steps.
pub(super) fn minimum(residuals: &Residuals<'_>, start: &[f64], most: u64) -> Minimum {
    /// Width of the differences: the cube root of the rounding error balances truncation.
    const WIDTH: f64 = 6e-6;
    /// Tolerances of the relative change of the cost, and of the change of any parameter.
    const SAME_COST: f64 = 1e-10;
    const SAME_PLACE: f64 = 1e-8;
    /// Initial and maximum damping.
    const DAMPING: f64 = 1e-3;
    const DAMPING_MOST: f64 = 1e12;
    let n = start.len();
    let mut x = start.to_vec();
    let mut left = residuals(&x);
    let mut cost = half_squares(&left);
    let end = |x, cost, termination, steps| Minimum {
        x,
        cost,
        ending: Ending { termination, steps },
    };
    if n == 0 || !cost.is_finite() {
        let linear = n == 0;
        let reason = if linear {
            Termination::Linear
        } else {
            Termination::Failed
        };
        return end(x, cost, reason, 0);
    }
    let along = |columns: &[Vec<f64>], left: &[f64]| -> Vec<f64> {
        columns.iter().map(|column| dot(column, left)).collect()
    };
    let mut columns = slopes(residuals, &x, WIDTH);
    let mut gradient = along(&columns, &left);
    let mut scale = vec![f64::MIN_POSITIVE; n];
    let mut secant = vec![0.0; n * n];
    let mut with_secant = false;
    let (mut damping, mut growth) = (DAMPING, 2.0);
    // Whether the damping was reset since the cost last decreased.
    let mut let_go = false;
    for steps in 0..most {
        interrupt::check();
        let normal: Vec<f64> = columns.iter().flat_map(|a| along(&columns, a)).collect();
        for (j, scale) in scale.iter_mut().enumerate() {
            *scale = scale.max(normal[j * n + j]);
        }
        // A parameter without effect is not moved.
        let least = f64::EPSILON * scale.iter().copied().fold(0.0, f64::max);
        // The damping increases until the cost decreases.
        let (step, tried) = loop {
            let mut hessian = normal.clone();
            if with_secant {
                hessian.iter_mut().zip(&secant).for_each(|(h, s)| *h += s);
            }
            let undamped = hessian.clone();
            for (j, scale) in scale.iter().enumerate() {
                hessian[j * n + j] += damping * scale.max(least);
            }
            if let Some(step) = bounded_step(&hessian, &gradient, &x) {
                let foretold = -foretold(&gradient, &undamped, &step);
                if step.iter().all(|s| *s == 0.0) {
                    return end(x, cost, Termination::Gradient, steps);
                }
                let tried: Vec<f64> = x
                    .iter()
                    .zip(&step)
                    .map(|(x, s)| (x + s).clamp(0.0, 1.0))
                    .collect();
                let tried_left = residuals(&tried);
                let gain = (cost - half_squares(&tried_left)) / foretold;
                if gain > 1e-4 && foretold > 0.0 {
                    // Nielsen's rule: a third if the model was right, twice if it was half right.
                    damping =
                        (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0)).max(1e-12);
                    growth = 2.0;
                    break (step, (tried, tried_left));
                }
            }
            if damping > DAMPING_MOST {
                return end(x, cost, Termination::NoProgress, steps);
            }
            damping *= growth;
            growth *= 2.0;
        };
        let before = (cost, gradient, columns);
        (x, left) = tried;
        cost = half_squares(&left);
        columns = slopes(residuals, &x, WIDTH);
        gradient = along(&columns, &left);
        let fell = before.0 - cost;
        // Secant: change of the gradient beyond JᵀJ s.
        let bare = foretold(&before.1, &normal, &step);
        let bent = 0.5 * quadratic(&secant, &step, &step);
        with_secant = (bare + bent + fell).abs() < (bare + fell).abs();
        update(
            &mut secant,
            &step,
            &gradient,
            &before.1,
            &along(&before.2, &left),
        );
        let moved = step.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
        let (small_cost, small_step) = (fell < SAME_COST * cost, moved < SAME_PLACE);
        if small_cost || small_step {
            // Damping increased at a bend makes short steps: without it there may be further
            // progress.
            if let_go || damping < DAMPING {
                let reason = if small_cost {
                    Termination::Cost
                } else {
                    Termination::Step
                };
                return end(x, cost, reason, steps + 1);
            }
            damping = 1e-6;
            let_go = true;
        } else {
            let_go = false;
        }
    }
    end(x, cost, Termination::StepLimit, most)
}

/// Evaluates the quadratic model `gᵀs + ½ sᵀHs`.
fn foretold(gradient: &[f64], hessian: &[f64], step: &[f64]) -> f64 {
    dot(gradient, step) + 0.5 * quadratic(hessian, step, step)
}

/// Evaluates the bilinear form `aᵀHb`.
fn quadratic(hessian: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let rows = hessian.chunks_exact(b.len());
    a.iter().zip(rows).map(|(a, row)| a * dot(row, b)).sum()
}

/// Step to the minimum of `gᵀs + ½ sᵀHs` within the box; `None` if `H` is not positive definite.
///
/// Components that would leave the box stop at their bound, and the others compensate.
fn bounded_step(hessian: &[f64], gradient: &[f64], x: &[f64]) -> Option<Vec<f64>> {
    const EDGE: f64 = 1e-6;
    const SHARE: f64 = 0.9;
    let n = x.len();
    let mut step = vec![0.0; n];
    let outward =
        |j: usize| (x[j] <= 0.0 && gradient[j] >= 0.0) || (x[j] >= 1.0 && gradient[j] <= 0.0);
    let mut free: Vec<usize> = (0..n).filter(|j| !outward(*j)).collect();
    loop {
        let m = free.len();
        let mut of_free = Vec::with_capacity(m * m);
        let mut to = Vec::with_capacity(m);
        for &i in &free {
            let row = &hessian[i * n..(i + 1) * n];
            of_free.extend(free.iter().map(|j| row[*j]));
            let stopped = (0..n).filter(|j| !free.contains(j));
            to.push(-gradient[i] - stopped.map(|j| row[j] * step[j]).sum::<f64>());
        }
        let mut factor = vec![0.0; m * m];
        factorise(&of_free, &mut factor, m).ok()?;
        solve(&factor, m, &mut to);
        let mut inside = Vec::with_capacity(m);
        for (&j, to) in free.iter().zip(to) {
            let room = |side: f64| if side < EDGE { side } else { SHARE * side };
            step[j] = to.clamp(-room(x[j]), room(1.0 - x[j]));
            if step[j] == to {
                inside.push(j);
            }
        }
        if inside.len() == m {
            return Some(step);
        }
        free = inside;
    }
}

/// Dennis-Gay-Welsch update of the secant estimate `S`: `S s` becomes `J₁ᵀr₁ − J₀ᵀr₁`.
fn update(secant: &mut [f64], step: &[f64], gradient: &[f64], before: &[f64], mixed: &[f64]) {
    let n = step.len();
    let y: Vec<f64> = gradient.iter().zip(before).map(|(g, b)| g - b).collect();
    let wanted: Vec<f64> = gradient.iter().zip(mixed).map(|(g, m)| g - m).collect();
    let along = dot(&y, step);
    if along <= 0.0 {
        return;
    }
    let size = (dot(step, &wanted) / quadratic(secant, step, step)).abs();
    if size < 1.0 {
        secant.iter_mut().for_each(|s| *s *= size);
    }
    let rows = secant.chunks_exact(n).zip(&wanted);
    let apart: Vec<f64> = rows.map(|(row, w)| w - dot(row, step)).collect();
    let share = dot(&apart, step) / along;
    for i in 0..n {
        for j in 0..n {
            secant[i * n + j] += (apart[i] * y[j] + y[i] * apart[j] - share * y[i] * y[j]) / along;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(residuals: &Residuals<'_>, start: &[f64], wanted: &[f64], most: u64) {
        let found = minimum(residuals, start, 60);
        assert!(found.ending.termination.converged(), "{found:?}");
        assert!(found.ending.steps <= most, "{found:?}");
        for (x, wanted) in found.x.iter().zip(wanted) {
            assert!((x - wanted).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn bent_valley_is_minimised() {
        // Rosenbrock's, x from −1 to 2.
        let valley = |u: &[f64]| {
            let [x, y] = [3.0 * u[0] - 1.0, 3.0 * u[1] - 1.0];
            vec![10.0 * (y - x * x), 1.0 - x]
        };
        check(&valley, &[0.1, 0.8], &[2.0 / 3.0; 2], 30);
    }

    #[test]
    fn bounds_are_reached_and_left_again() {
        // Without bounds at (1.5, −0.5).
        let corner = |u: &[f64]| vec![u[0] - 1.5, u[0] + u[1] - 1.0];
        check(&corner, &[0.3, 0.4], &[1.0, 0.0], 20);
        let inside = |u: &[f64]| vec![u[0] - 0.2, u[1] - 0.9, u[0] * u[1] - 0.18];
        check(&inside, &[1.0, 0.0], &[0.2, 0.9], 20);
    }

    // Two groups of measurements whose variances are `exp(±a)`, as the noise of a fit: `JᵀJ` is
    // half of the curvature. The optimum of `a` is half the logarithm of the ratio of their
    // squares.
    #[test]
    fn large_residuals_do_not_slow_it_down() {
        let noise = |u: &[f64]| {
            let a = 4.0 * u[0] - 2.0;
            vec![3.0 * (-0.5 * a).exp(), 2.0 * (0.5 * a).exp()]
        };
        let best = 0.5 * (9.0_f64 / 4.0).ln();
        check(&noise, &[0.05], &[(best + 2.0) / 4.0], 10);
    }

    #[test]
    fn parameter_without_effect_is_unchanged() {
        let one = |u: &[f64]| vec![u[0] - 0.25, 0.1];
        let found = minimum(&one, &[0.9, 0.4], 60);
        assert!(
            (found.x[0] - 0.25).abs() < 1e-8 && found.x[1] == 0.4,
            "{found:?}"
        );
        assert_eq!(
            minimum(&|_| vec![1.0], &[], 60).ending.termination,
            Termination::Linear
        );
        let never = minimum(&|_| vec![f64::NAN], &[0.5], 60);
        assert_eq!(never.ending.termination, Termination::Failed);
    }
}
