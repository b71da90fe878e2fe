//! Fit of a law: search from several starts, then draws for the intervals.

use super::bootstrap;
use super::curve::Curve;
use super::draw::Draw;
use super::draws::draw;
use super::error::CreepError;
use super::law::Law;
use super::model::Model;
use super::noise::Noise;
use super::options::{FitOptions, IntervalKind, NoiseKind};
use super::parameter::{Parameter, parameters};
use super::profile;
use super::rope_base::FixedParameter;
use super::solver::{Ending, Minimum, minimum};
use super::span::extremes;
use super::starts::starts;

/// Law fitted to one or several curves.
#[derive(Debug, Clone, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// Creep law that was fitted.
    pub law: Law,
    /// Akaike weight among the laws fitted to the same measurements; 1 for a law fitted alone.
    pub weight: f64,
    /// Number of measurements (or means of measurements) used.
    pub readings: usize,
    /// Number of fitted numbers, including those of the noise.
    pub fitted: usize,
    /// Natural logarithm of the maximum likelihood.
    pub log_likelihood: f64,
    /// Akaike's criterion with the correction for few measurements; smaller is better.
    pub aicc: f64,
    /// Schwarz's criterion; smaller is better.
    pub bic: f64,
    /// Standard deviation of a measurement's strain, m/m.
    pub residual_strain_ratio: f64,
    /// Noise parameters of maximum likelihood.
    pub noise: Noise,
    /// Termination of the best search.
    pub ending: Ending,
    /// Number of starts of the search.
    pub starts: usize,
    /// Parameters with values, units and intervals.
    pub parameters: Vec<Parameter>,
    /// Covariance of [`Self::parameters`] from the draws, in their units; empty without draws.
    pub covariance: Vec<Vec<f64>>,
    /// Parameters of [`Law::Rope`] that are not identifiable from the record and fixed at the base
    /// rope's value.
    pub fixed: Vec<FixedParameter>,
    #[serde(skip)]
    pub(super) model: Model,
    #[serde(skip)]
    pub(super) best: Draw,
    #[serde(skip)]
    pub(super) draws: Vec<Draw>,
    #[serde(skip)]
    pub(super) level: f64,
    #[serde(skip)]
    pub(super) seed: u64,
}

impl Fit {
    /// Finds a parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Maximum-likelihood strain, m/m, of the curve with index `curve`, at increasing times.
    pub fn strain(&self, curve: usize, time_s: &[f64]) -> Vec<f64> {
        self.best.strain(&self.model, curve, time_s)
    }
}

/// Number of replicates of a bootstrap: the 2.5 % quantile is based on eight of them.
const BOOTSTRAP: usize = 300;

/// Fits a law to curves.
///
/// # Errors
/// Returns [`CreepError::TooFew`] if there are fewer measurements than numbers to fit plus two,
/// [`CreepError::Flat`] if a curve is constant, and the errors of [`Law::Rope`] for an unsuitable
/// base rope.
pub fn fit(law: Law, curves: &[Curve], options: &FitOptions) -> Result<Fit, CreepError> {
    let curves: Vec<Curve> = curves.iter().map(Curve::thinned).collect();
    for curve in &curves {
        let (low, high) = extremes(&curve.strain);
        if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
            return Err(CreepError::Flat {
                specimen: curve.name.clone(),
            });
        }
    }
    let model = Model::new(law, curves, options)?;
    let fitted = model.dimension() + model.coefficients() + 1;
    // AICc divides by n − k − 1.
    if model.readings < fitted + 2 {
        return Err(CreepError::TooFew {
            law,
            readings: model.readings,
            needed: fitted + 2,
        });
    }
    /// Maximum number of steps of a search.
    const STEPS: u64 = 60;
    let residuals = |x: &[f64]| model.residuals(x);
    let search = |start: &Vec<f64>| minimum(&residuals, start, STEPS);
    let by_cost = |minima: &mut Vec<Minimum>| {
        minima.retain(|m| m.cost.is_finite());
        minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    };
    let mut starts = starts(&model);
    let mut minima: Vec<Minimum> = starts.iter().map(search).collect();
    by_cost(&mut minima);
    if let (NoiseKind::Correlated, Some(best)) = (model.noise, minima.first()) {
        // Nearly slow noise is a separate optimum, which remote shapes do not lead to.
        starts.push([&best.x[..model.shapes.len()], &[0.95, 0.6]].concat());
        minima.extend(starts.last().map(search));
        by_cost(&mut minima);
    }
    let mut minima = minima.into_iter();
    let minimum = minima.next().ok_or(CreepError::NotFinite { law })?;
    let others = others(&model, &minimum.x, minima.map(|m| m.x));

    let point = model.solve(&minimum.x, false);
    // Strain zeros that the rope law explains and other laws leave to ε₀ are measurements that
    // those laws fit exactly, with one number each: only then do the criteria compare laws on the
    // same data.
    let zeros: Vec<f64> = if options.rope.is_some() && model.rope.is_none() {
        let counts = model.curves.iter().map(|c| c.zero_count);
        counts.filter(|c| *c > 0.0).collect()
    } else {
        Vec::new()
    };
    let n = (model.readings + zeros.len()) as f64;
    let variance = (point.squares / n).max(f64::MIN_POSITIVE);
    let share = point.noise.share;
    let of_zeros: f64 = zeros.iter().map(|c| (share + (1.0 - share) / c).ln()).sum();
    // Likelihood of the strain in its own unit.
    let log_likelihood = -0.5
        * (n * ((2.0 * std::f64::consts::PI * variance).ln() + 1.0)
            + point.log_det_noise
            + of_zeros)
        - n * model.scale.ln();
    let k = (fitted + zeros.len()) as f64;
    let best = Draw::at(&model, &minimum.x);
    let draws = if options.intervals {
        draw(&model, &minimum.x, &others, options.seed)
    } else {
        Vec::new()
    };
    let (mut parameters, covariance) = parameters(&model, &best, &draws, options.level);
    match options.kind {
        IntervalKind::Draws => {}
        IntervalKind::Profile => profile::intervals(&mut parameters, &model, &best, options.level),
        IntervalKind::Bootstrap => {
            let tail = 0.5 * (1.0 - options.level);
            bootstrap::intervals(
                &mut parameters,
                &model,
                &best,
                tail,
                BOOTSTRAP,
                options.seed,
            );
        }
    }
    Ok(Fit {
        law,
        weight: 1.0,
        readings: model.readings,
        fitted,
        log_likelihood,
        aicc: -2.0 * log_likelihood + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0),
        bic: -2.0 * log_likelihood + k * n.ln(),
        residual_strain_ratio: best.sigma * model.scale,
        noise: point.noise,
        ending: minimum.ending,
        starts: starts.len(),
        parameters,
        covariance,
        fixed: model.rope.as_ref().map_or(Vec::new(), |r| r.fixed.clone()),
        model,
        best,
        draws,
        level: options.level,
        seed: options.seed,
    })
}

/// Further optima that the draws must cover: probable ones, each separate from the previous ones.
fn others(model: &Model, best: &[f64], found: impl Iterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    /// Maximum difference of the log-likelihood to the best optimum.
    const MAX_LOG_LIKELIHOOD_DIFFERENCE: f64 = 20.0;
    /// Minimum distance of separate optima, as a share of the searched ranges.
    const MIN_DISTANCE: f64 = 0.02;
    let least = model.log_restricted(best) - MAX_LOG_LIKELIHOOD_DIFFERENCE;
    let mut out = vec![best.to_vec()];
    for x in found {
        let apart = |y: &Vec<f64>| x.iter().zip(y).any(|(a, b)| (a - b).abs() > MIN_DISTANCE);
        if out.iter().all(apart) && model.log_restricted(&x) > least {
            out.push(x);
        }
    }
    out.split_off(1)
}
