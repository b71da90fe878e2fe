//! The search over the nonlinear parameters of a model.

use super::model::Model;
use super::solver::Residuals;

/// A model's residuals with all parameters free.
pub(super) struct Search<'a>(pub(super) &'a Model);

impl Residuals for Search<'_> {
    fn parameters(&self) -> usize {
        self.0.dimension()
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.0.likelihood_residuals(x, None)
    }

    fn slopes(&self, x: &[f64]) -> Vec<f64> {
        self.0.likelihood_slopes(x)
    }
}
