//! Intervals by parametric bootstrap: fits of synthetic measurements.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::draw::Draw;
use super::fixed_parameters::HeldDraws;
use super::model::Model;
use super::noise::Noise;
use super::options::IntervalKind;
use super::parameter::Parameter;
use super::solver::minimum;
use super::student::{normal_quantile, normal_share};
use sinew_model::statistics::quantile;

/// Replaces intervals by bias-corrected quantiles of `count` replicates: the fitted strain with new
/// noise of the fitted size, slow share and correlation time, fitted again from the best point. The
/// bias is that of the search alone; each replicate then draws its own values of the fixed
/// parameters.
///
/// # Source
/// B. Efron, R. Tibshirani: *An Introduction to the Bootstrap*, 1993, chapters 6 and 14.
pub(super) fn intervals(
    parameters: &mut [Parameter],
    model: &Model,
    best: &Draw,
    tail: f64,
    count: usize,
    seed: u64,
) {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0xb007);
    let numbers = best.numbers(model);
    let fitted: Vec<Vec<f64>> = (0..model.curves.len())
        .map(|c| best.strain(model, c, &model.curves[c].time_s))
        .collect();
    let mut replicates: Vec<[Vec<f64>; 2]> = Vec::with_capacity(count);
    let held = HeldDraws::of(model, &best.unit);
    for _ in 0..count {
        let mut replicate = replicate(model, best, &fitted, &mut random);
        let minimum = minimum(&|x| replicate.residuals(x), &best.unit, 40);
        if minimum.cost.is_finite() {
            let as_held = Draw::at(&replicate, &minimum.x).numbers(model);
            let (moved, z) = held.draw(&replicate, &minimum.x, &mut random);
            replicate.held_z = z;
            replicates.push([as_held, Draw::at(&replicate, &moved).numbers(model)]);
        }
    }
    for (i, parameter) in parameters.iter_mut().enumerate() {
        let [as_held, mut values] =
            [0, 1].map(|which| replicates.iter().map(|r| r[which][i]).collect::<Vec<f64>>());
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let below = as_held.iter().filter(|v| **v < numbers[i]).count() as f64;
        // Half a replicate keeps the bias of a parameter that always ends at its bound finite.
        let bias = normal_quantile(((below + 0.5) / (n + 1.0)).clamp(0.01, 0.99));
        let at = |p: f64| quantile(&values, normal_share(2.0 * bias + normal_quantile(p)));
        parameter.low = at(tail);
        parameter.high = at(1.0 - tail);
        parameter.interval = IntervalKind::Bootstrap;
    }
}

fn replicate(model: &Model, best: &Draw, fitted: &[Vec<f64>], random: &mut ChaCha8Rng) -> Model {
    let mut model = model.clone();
    let sigma = best.sigma * model.scale;
    let clocks = model.clocks.clone();
    for ((curve, fitted), clock) in model.curves.iter_mut().zip(fitted).zip(clocks) {
        let errors = errors(&clock, &curve.count, best.noise, random);
        for ((strain, fitted), error) in curve.strain.iter_mut().zip(fitted).zip(errors) {
            *strain = fitted + sigma * error;
        }
    }
    model
}

/// Draws noise of unit size at increasing clock values: slow part and independent part.
fn errors(clock: &[f64], count: &[f64], noise: Noise, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut normal = || -> f64 { StandardNormal.sample(random) };
    let mut slow = noise.share.sqrt() * normal();
    let mut before = clock.first().copied().unwrap_or(0.0);
    clock
        .iter()
        .zip(count)
        .map(|(&t, count)| {
            let decay = (-(t - before) / noise.memory).exp();
            before = t;
            slow = decay * slow + (noise.share * (1.0 - decay * decay)).sqrt() * normal();
            slow + ((1.0 - noise.share) / count).sqrt() * normal()
        })
        .collect()
}
