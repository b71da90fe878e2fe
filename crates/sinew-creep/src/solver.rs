//! Least squares within bounds, behind a trait so that the library can be changed.

use serde::{Deserialize, Serialize};
use std::convert::Infallible;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, Constraints, DenseMatrix, Executor, Jacobian,
    Residual, TerminationCode, TrustRegionReflective,
};

/// Residuals of a model whose parameters lie between 0 and 1.
pub trait Residuals {
    /// Number of parameters.
    fn parameters(&self) -> usize;
    /// Residuals at `x`; their number doesn't change.
    fn residuals(&self, x: &[f64]) -> Vec<f64>;

    /// Their derivatives, parameter after parameter; central differences where nothing better is
    /// known.
    fn slopes(&self, x: &[f64]) -> Vec<f64> {
        /// Step of the differences: the cube root of the rounding error balances truncation.
        const STEP: f64 = 6e-6;
        let mut at = x.to_vec();
        let mut slopes = Vec::new();
        for j in 0..x.len() {
            let (low, high) = ((x[j] - STEP).max(0.0), (x[j] + STEP).min(1.0));
            at[j] = high;
            let up = self.residuals(&at);
            at[j] = low;
            let down = self.residuals(&at);
            at[j] = x[j];
            slopes.extend(up.iter().zip(&down).map(|(u, d)| (u - d) / (high - low)));
        }
        slopes
    }
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// No parameter is searched: the linear problem has one solution.
    Linear,
    /// The projected gradient is zero within its tolerance.
    Gradient,
    /// The last step was shorter than its tolerance.
    Step,
    /// The last step lowered the cost by less than its tolerance.
    Cost,
    /// No further progress within rounding.
    NoProgress,
    /// The limit of steps was reached.
    StepLimit,
    /// The search broke off.
    Failed,
}

impl Termination {
    /// Whether the search ended by a criterion of its own.
    pub fn converged(self) -> bool {
        use Termination::{Cost, Gradient, Linear, NoProgress, Step};
        matches!(self, Linear | Gradient | Step | Cost | NoProgress)
    }
}

impl From<TerminationCode> for Termination {
    fn from(code: TerminationCode) -> Self {
        use TerminationCode as C;
        match code {
            C::GradientTolerance
            | C::RelativeGradientTolerance
            | C::ProjectedGradientTolerance
            | C::SolverConverged => Termination::Gradient,
            C::ParamTolerance | C::RelativeParamTolerance | C::RhoTolerance => Termination::Step,
            C::CostTolerance | C::RelativeCostTolerance => Termination::Cost,
            C::MaxIter => Termination::StepLimit,
            C::NumericalNoProgress => Termination::NoProgress,
            _ => Termination::Failed,
        }
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Ending {
    /// Why.
    pub termination: Termination,
    /// Steps taken.
    pub steps: u64,
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Parameters, each between 0 and 1.
    pub x: Vec<f64>,
    /// Half the sum of squares.
    pub cost: f64,
    /// How the search ended.
    pub ending: Ending,
}

/// A search for the least squares within the unit box.
pub trait LeastSquares {
    /// Searches from `start`.
    fn minimum(&self, problem: &dyn Residuals, start: &[f64]) -> Minimum;
}

/// Trust region reflective (Branch, Coleman and Li, SIAM J. Sci. Comput. 21, 1999), from `basin`.
#[derive(Debug, Clone, Copy)]
pub struct TrustRegion {
    /// Most steps.
    pub steps: u64,
}

impl Default for TrustRegion {
    fn default() -> Self {
        Self { steps: 60 }
    }
}

struct Adapter<'a> {
    problem: &'a dyn Residuals,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Constraints for Adapter<'_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl Residual for Adapter<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Infallible;

    fn residual(&self, x: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        Ok(self.problem.residuals(x))
    }
}

impl Jacobian for Adapter<'_> {
    type Jacobian = DenseMatrix;

    fn jacobian(&self, x: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let n = x.len();
        let slopes = self.problem.slopes(x);
        let rows = slopes.len() / n.max(1);
        let mut flat = Vec::with_capacity(slopes.len());
        for i in 0..rows {
            flat.extend((0..n).map(|j| slopes[j * rows + i]));
        }
        Ok(DenseMatrix::from_row_slice(rows, n, &flat))
    }
}

impl LeastSquares for TrustRegion {
    fn minimum(&self, problem: &dyn Residuals, start: &[f64]) -> Minimum {
        let n = start.len();
        let cost = |x: &[f64]| 0.5 * problem.residuals(x).iter().map(|r| r * r).sum::<f64>();
        let unmoved = |termination| Minimum {
            x: start.to_vec(),
            cost: cost(start),
            ending: Ending {
                termination,
                steps: 0,
            },
        };
        if n == 0 {
            return unmoved(Termination::Linear);
        }
        let adapter = Adapter {
            problem,
            lower: vec![0.0; n],
            upper: vec![1.0; n],
        };
        let solver = TrustRegionReflective::new()
            .with_relative_cost_change_tolerance(1e-10)
            .with_relative_step_tolerance(1e-8);
        let run = Executor::from_start(adapter, solver, start.to_vec())
            .max_iter(self.steps)
            .run();
        let Ok(result) = run else {
            return unmoved(Termination::Failed);
        };
        Minimum {
            x: result.param().clone(),
            cost: result.cost(),
            ending: Ending {
                termination: result.report.code().into(),
                steps: result.iter(),
            },
        }
    }
}
