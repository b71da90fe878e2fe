//! What the rope law's held parameters leave open in the others.
//!
//! A parameter that the records can't tell keeps the base rope's value, which is known within an interval only. So each draw
//! takes its own value of it, and the search says how the others follow: bedding-in under one load goes with the load ratio
//! that is held. Else intervals would be those of a rope whose held values were certain.

use super::model::Model;
use super::search::Search;
use super::solver::{LeastSquares, TrustRegion};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// A held parameter that moves the others.
struct Held {
    index: usize,
    /// Change of the nonlinear parameters per deviation, in the unit cube.
    shift: Vec<f64>,
    /// What the records say of it: a normal distribution of its deviations.
    mean: f64,
    deviation: f64,
}

/// How draws follow what is held.
#[derive(Default)]
pub(super) struct HeldDraws(Vec<Held>);

impl HeldDraws {
    /// Searches again at one deviation to either side of every held parameter that moves the fit.
    pub(super) fn of(model: &Model, centre: &[f64]) -> Self {
        let count = model.held_z.len();
        Self((0..count).filter_map(|i| held(model, centre, i)).collect())
    }

    /// One draw: the point moved along, and the deviations of all held parameters.
    pub(super) fn draw(
        &self,
        model: &Model,
        unit: &[f64],
        random: &mut impl Rng,
    ) -> (Vec<f64>, Vec<f64>) {
        let mut z: Vec<f64> = model
            .held_z
            .iter()
            .map(|_| StandardNormal.sample(random))
            .collect();
        let mut moved = unit.to_vec();
        for held in &self.0 {
            z[held.index] = held.mean + held.deviation * z[held.index];
            for (x, shift) in moved.iter_mut().zip(&held.shift) {
                *x += z[held.index] * shift;
            }
        }
        moved.iter_mut().for_each(|x| *x = x.clamp(0.0, 1.0));
        (moved, z)
    }
}

fn held(model: &Model, centre: &[f64], index: usize) -> Option<Held> {
    /// A change of the squares at the optimum, over their variance, that one deviation must make.
    const MATTERS: f64 = 0.01;
    let cost = |model: &Model, x: &[f64]| -> f64 {
        let residuals = model.likelihood_residuals(x, None);
        residuals.iter().map(|r| r * r).sum()
    };
    let least = cost(model, centre);
    let n = model.readings as f64;
    let mut aside = model.clone();
    let mut at = |z: f64| {
        aside.held_z[index] = z;
        // Where nothing moves no search is needed.
        let moved = n * (cost(&aside, centre) / least).ln().abs() > MATTERS;
        moved.then(|| TrustRegion { steps: 40 }.minimum(&Search(&aside), centre))
    };
    let (up, down) = (at(1.0), at(-1.0));
    if up.is_none() && down.is_none() {
        return None;
    }
    let end = |found: &Option<super::solver::Minimum>| {
        found
            .as_ref()
            .map_or_else(|| (centre.to_vec(), least), |m| (m.x.clone(), 2.0 * m.cost))
    };
    let ((up, more), (down, less)) = (end(&up), end(&down));
    let shift = up.iter().zip(&down).map(|(u, d)| 0.5 * (u - d)).collect();
    // −2 ln of the likelihood at ±1 against the middle: a parabola, and the base rope's own deviation beside it.
    let [up, down] = [more, less].map(|s| n * (s / least).ln());
    let precision = 1.0 + (0.5 * (up + down)).max(0.0);
    let mean = -0.25 * (up - down) / precision;
    Some(Held {
        index,
        shift,
        mean: mean.clamp(-2.0, 2.0),
        deviation: precision.sqrt().recip(),
    })
}
