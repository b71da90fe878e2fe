//! Fitting a law: search from several starts, then draws for the intervals.

use super::CreepError;
use super::curve::Curve;
use super::draws::draw;
use super::law::Law;
use super::model::{Model, NoiseKind, Share};
use super::noise::Noise;
use super::parameter::Parameter;
use super::rope_law::{Held, RopeBase};
use super::solver::{LeastSquares, Residuals, TrustRegion};
use super::starts::starts;

/// How to fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// What specimens have in common.
    pub share: Share,
    /// What is assumed of the readings' errors.
    pub noise: NoiseKind,
    /// Level of the intervals, such as 0.95.
    pub level: f64,
    /// Whether draws for intervals and forecasts are made; the search alone is much faster.
    pub intervals: bool,
    /// How the intervals of the parameters are made; forecasts always rest on draws.
    pub kind: IntervalKind,
    /// Seed of the draws; the same seed gives the same numbers.
    pub seed: u64,
    /// The rope that [`Law::Rope`] starts from.
    pub rope: Option<std::sync::Arc<RopeBase>>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            share: Share::All,
            noise: NoiseKind::Correlated,
            level: 0.95,
            intervals: true,
            kind: IntervalKind::Draws,
            seed: 1,
            rope: None,
        }
    }
}

/// How an interval is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum IntervalKind {
    /// Quantiles of draws from what the readings leave open (flat within the searched ranges).
    #[default]
    Draws,
    /// Profile likelihood: all else fitted anew at every value, F-distributed.
    Profile,
    /// Parametric bootstrap: readings made anew with the fitted noise, slow part included,
    /// and fitted again; bias-corrected quantiles.
    Bootstrap,
}

impl IntervalKind {
    /// Name in options and tables.
    pub fn name(self) -> &'static str {
        match self {
            IntervalKind::Draws => "draws",
            IntervalKind::Profile => "profile likelihood",
            IntervalKind::Bootstrap => "parametric bootstrap",
        }
    }
}

/// A law fitted to one or several curves.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The law.
    pub law: Law,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Covariance of [`Self::parameters`] from the draws, in their units; empty without draws.
    pub covariance: Vec<Vec<f64>>,
    /// Readings (or means of readings) used.
    pub readings: usize,
    /// Numbers fitted, those of the noise among them.
    pub fitted: usize,
    /// Natural logarithm of the largest likelihood.
    pub log_likelihood: f64,
    /// Akaike's criterion with the correction for few readings; smaller is better.
    pub aicc: f64,
    /// Schwarz's criterion; smaller is better.
    pub bic: f64,
    /// Standard deviation of a reading, strain in %.
    pub residual_percent: f64,
    /// Noise of largest likelihood.
    pub noise: Noise,
    /// Whether the best search ended by its own criterion.
    pub converged: bool,
    /// Starts searched from.
    pub starts: usize,
    /// Parameters of [`Law::Rope`] that the record can't tell, taken from the base rope.
    pub held: Vec<Held>,
    pub(super) model: Model,
    pub(super) best: Draw,
    pub(super) draws: Vec<Draw>,
    pub(super) level: f64,
    pub(super) seed: u64,
}

/// One set of all parameters.
#[derive(Debug, Clone)]
pub(super) struct Draw {
    pub(super) values: Vec<f64>,
    pub(super) places: Vec<f64>,
    pub(super) noise: Noise,
    pub(super) sigma: f64,
    /// Coefficients of every block, strain over the model's scale.
    pub(super) beta: Vec<Vec<f64>>,
}

impl Draw {
    /// The largest likelihood's own numbers at places of the nonlinear parameters.
    pub(super) fn at(model: &Model, places: &[f64]) -> Draw {
        let point = model.solve(places, false);
        Draw {
            values: model.values(places),
            places: places.to_vec(),
            noise: point.noise,
            sigma: (point.squares / model.freedom()).sqrt(),
            beta: point.solutions.iter().map(|s| s.beta.clone()).collect(),
        }
    }
}

/// The search over the nonlinear parameters.
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

/// Replicates of a bootstrap: the 2.5 % quantile rests on eight of them.
const BOOTSTRAP: usize = 300;

/// Fits a law to curves.
///
/// # Errors
/// [`CreepError::TooFew`] when there are not more readings than numbers to fit, and
/// [`CreepError::Flat`] when a curve doesn't change.
pub fn fit(law: Law, curves: &[Curve], options: &FitOptions) -> Result<Fit, CreepError> {
    let curves: Vec<Curve> = curves.iter().map(Curve::thinned).collect();
    for curve in &curves {
        let (low, high) = extremes(&curve.strain);
        if low.partial_cmp(&high) != Some(std::cmp::Ordering::Less) {
            return Err(CreepError::Flat(curve.name.clone()));
        }
    }
    let model = Model::new(law, curves, options)?;
    let fitted = model.dimension() + model.coefficients() + 1;
    // AICc divides by n − k − 1.
    if model.readings < fitted + 2 {
        return Err(CreepError::TooFew {
            law: law.name(),
            readings: model.readings,
            needed: fitted + 2,
        });
    }
    let solver = TrustRegion::default();
    let starts = starts(&model);
    let minimum = starts
        .iter()
        .map(|start| solver.minimum(&Search(&model), start))
        .filter(|m| m.cost.is_finite())
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
        .ok_or(CreepError::NotFinite(law.name()))?;

    let point = model.solve(&minimum.x, false);
    // Strain zeros that the rope law explains and other laws leave to ε₀ are readings that those
    // fit exactly, with a number each: only then do criteria compare laws on the same data.
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
    // Likelihood of strain in its own unit.
    let log_likelihood = -0.5
        * (n * ((2.0 * std::f64::consts::PI * variance).ln() + 1.0)
            + point.log_det_noise
            + of_zeros)
        - n * model.scale.ln();
    let k = (fitted + zeros.len()) as f64;
    let best = Draw::at(&model, &minimum.x);
    let draws = if options.intervals {
        draw(&model, &minimum.x, options.seed)
    } else {
        Vec::new()
    };
    let mut fit = Fit {
        law,
        parameters: Vec::new(),
        covariance: Vec::new(),
        readings: model.readings,
        fitted,
        log_likelihood,
        aicc: -2.0 * log_likelihood + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0),
        bic: -2.0 * log_likelihood + k * n.ln(),
        residual_percent: 100.0 * best.sigma * model.scale,
        noise: point.noise,
        converged: minimum.converged,
        starts: starts.len(),
        held: model.rope.as_ref().map_or(Vec::new(), |r| r.held.clone()),
        model,
        best,
        draws,
        level: options.level,
        seed: options.seed,
    };
    fit.tell_parameters();
    match options.kind {
        IntervalKind::Draws => {}
        IntervalKind::Profile => fit.profile(),
        IntervalKind::Bootstrap => fit.bootstrap(BOOTSTRAP, options.seed),
    }
    Ok(fit)
}

fn extremes(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(*v), h.max(*v))
        })
}
