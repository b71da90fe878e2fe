//! Posterior draws of all parameters.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution};

use super::draw::Draw;
use super::fixed_parameters::HeldDraws;
use super::model::Model;
use super::sample::{Around, Plan, ensemble};
use super::solver::{half_squares, slopes};
use sinew_model::cholesky::{dot, factorise_singular};

/// Draws around `centre` and the `others`, further optima of similar likelihood; coefficients and
/// noise size are drawn from their conditional distributions.
pub(super) fn draw(model: &Model, centre: &[f64], others: &[Vec<f64>], seed: u64) -> Vec<Draw> {
    /// Number of draws of the coefficients per point of the ensemble.
    const PER_POINT: usize = 3;
    /// Number of draws of a law without nonlinear parameters.
    const ALL_LINEAR: usize = 2000;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let points = ensemble(
        &|x| model.log_restricted(x),
        &around(model, centre),
        others,
        Plan::of(centre.len()),
        &mut random,
    );
    let per_point = if centre.is_empty() {
        ALL_LINEAR
    } else {
        PER_POINT
    };
    let free = model.readings.saturating_sub(model.coefficients()).max(1);
    let Ok(chi) = ChiSquared::new(free as f64) else {
        return Vec::new();
    };
    let mut draws = Vec::with_capacity(points.len() * per_point);
    let held = HeldDraws::of(model, centre);
    let mut placed = model.clone();
    for unit in points {
        let unit = if model.held_z.is_empty() {
            unit
        } else {
            let (unit, z) = held.draw(model, &unit, &mut random);
            placed.held_z = z;
            unit
        };
        let point = placed.solve(&unit, false);
        for _ in 0..per_point {
            let spread: f64 = chi.sample(&mut random);
            let sigma = (point.squares / spread.max(f64::MIN_POSITIVE)).sqrt();
            draws.push(Draw {
                values: placed.values(&unit),
                unit: unit.clone(),
                noise: point.noise,
                sigma,
                beta: point
                    .solutions
                    .iter()
                    .zip(&model.blocks)
                    .map(|(solution, block)| solution.draw(sigma, &block.positive, &mut random))
                    .collect(),
            });
        }
    }
    // The order must not depend on the walker, because forecasts use parts of the list.
    for i in (1..draws.len()).rev() {
        let j = random.random_range(0..=i);
        draws.swap(i, j);
    }
    draws
}

/// Initial distribution of the walkers from the curvature of the squares at the optimum.
fn around(model: &Model, centre: &[f64]) -> Around {
    /// Step size of the finite differences.
    const STEP: f64 = 1e-4;
    /// Prior standard deviation of each parameter in the searched range of 0 to 1.
    const PRIOR_STD: f64 = 0.3;
    let d = centre.len();
    let residuals = |x: &[f64]| model.residuals(x);
    let squares = 2.0 * half_squares(&residuals(centre));
    let variance = (squares / model.freedom()).max(f64::MIN_POSITIVE);
    let slopes = slopes(&residuals, centre, STEP);
    let mut precision: Vec<f64> = (slopes.iter())
        .flat_map(|a| slopes.iter().map(|b| dot(a, b) / variance))
        .collect();
    (0..d).for_each(|i| precision[i * d + i] += PRIOR_STD.powi(-2));
    let mut factor = vec![0.0; d * d];
    let least = |pivot: f64| Some(pivot.max(f64::MIN_POSITIVE).sqrt());
    // Every pivot is positive, so that no row is rejected.
    let _ = factorise_singular(&precision, &mut factor, d, least);
    Around {
        centre: centre.to_vec(),
        factor,
    }
}
