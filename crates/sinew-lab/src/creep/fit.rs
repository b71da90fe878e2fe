//! Fitting a law: search from several starts, then draws for the intervals.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution};

use super::CreepError;
use super::curve::Curve;
use super::law::Law;
use super::model::{Model, NoiseKind, Share};
use super::noise::Noise;
use super::sample::{Plan, ensemble, quantile};
use super::solver::{LeastSquares, Residuals, TrustRegion};

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
    /// Seed of the draws; the same seed gives the same numbers.
    pub seed: u64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            share: Share::All,
            noise: NoiseKind::Correlated,
            level: 0.95,
            intervals: true,
            seed: 1,
        }
    }
}

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Symbol.
    pub name: String,
    /// Unit of the numbers below.
    pub unit: String,
    /// Specimen it belongs to; `None`: common to all.
    pub specimen: Option<String>,
    /// Value of largest likelihood.
    pub value: f64,
    /// Standard deviation of the draws; NaN without them.
    pub std_error: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
    /// Why the record doesn't tell this parameter, where it doesn't.
    pub not_identifiable: Option<String>,
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

struct Search<'a>(&'a Model);

impl Residuals for Search<'_> {
    fn parameters(&self) -> usize {
        self.0.dimension()
    }

    fn residuals(&self, x: &[f64]) -> Vec<f64> {
        self.0.likelihood_residuals(x)
    }
}

/// Starts that are searched from, the best of a grid.
const STARTS: usize = 3;
/// Places of the grid of starts per parameter, by their number.
const GRID: [usize; 5] = [1, 12, 7, 5, 4];

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
    let model = Model::new(law, curves, options.share, options.noise);
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

    let n = model.readings as f64;
    let point = model.solve(&minimum.x, false);
    let variance = (point.squares / n).max(f64::MIN_POSITIVE);
    // Likelihood of strain in its own unit.
    let log_likelihood = -0.5
        * (n * ((2.0 * std::f64::consts::PI * variance).ln() + 1.0) + point.log_det_noise)
        - n * model.scale.ln();
    let k = fitted as f64;
    let free = n - model.coefficients() as f64 - model.shapes.len() as f64;
    let best = Draw {
        values: model.values(&minimum.x),
        places: minimum.x.clone(),
        noise: point.noise,
        sigma: (point.squares / free.max(1.0)).sqrt(),
        beta: point.solutions.iter().map(|s| s.beta.clone()).collect(),
    };
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
        model,
        best,
        draws,
        level: options.level,
        seed: options.seed,
    };
    fit.tell_parameters();
    Ok(fit)
}

fn extremes(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(*v), h.max(*v))
        })
}

/// The best places of a grid over the shapes, with independent and with slow noise.
fn starts(model: &Model) -> Vec<Vec<f64>> {
    let shapes = model.shapes.len();
    let per = GRID.get(shapes).copied().unwrap_or(3);
    let total = per.pow(shapes as u32);
    let mut white = model.clone();
    white.noise = NoiseKind::White;
    let mut places: Vec<(f64, Vec<f64>)> = (0..total)
        .map(|index| {
            let mut rest = index;
            let x: Vec<f64> = (0..shapes)
                .map(|_| {
                    let place = (rest % per) as f64 + 0.5;
                    rest /= per;
                    place / per as f64
                })
                .collect();
            (white.solve(&x, false).squares, x)
        })
        .collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    places.truncate(STARTS);
    match model.noise {
        NoiseKind::White => places.into_iter().map(|(_, x)| x).collect(),
        NoiseKind::Correlated => places
            .into_iter()
            .zip([(0.1, 0.5), (0.6, 0.5), (0.5, 0.8)])
            .map(|((_, mut x), (share, memory))| {
                x.extend([share, memory]);
                x
            })
            .collect(),
    }
}

fn draw(model: &Model, centre: &[f64], seed: u64) -> Vec<Draw> {
    /// Draws of coefficients for each place of the ensemble.
    const PER_PLACE: usize = 3;
    /// Draws of a law without nonlinear parameters.
    const ALL_LINEAR: usize = 2000;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let places = ensemble(
        &|x| model.log_restricted(x),
        centre,
        Plan::FULL,
        &mut random,
    );
    let per_place = if centre.is_empty() {
        ALL_LINEAR
    } else {
        PER_PLACE
    };
    let free = model.readings.saturating_sub(model.coefficients()).max(1);
    let Ok(chi) = ChiSquared::new(free as f64) else {
        return Vec::new();
    };
    let mut draws = Vec::with_capacity(places.len() * per_place);
    for place in places {
        let point = model.solve(&place, false);
        for _ in 0..per_place {
            let spread: f64 = chi.sample(&mut random);
            let sigma = (point.squares / spread.max(f64::MIN_POSITIVE)).sqrt();
            draws.push(Draw {
                values: model.values(&place),
                places: place.clone(),
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
    // Order must not tell the walker: forecasts take stretches of the list.
    for i in (1..draws.len()).rev() {
        let j = random.random_range(0..=i);
        draws.swap(i, j);
    }
    draws
}

impl Fit {
    /// Numbers of a draw in the order and units of [`Self::parameters`].
    fn numbers(&self, draw: &Draw) -> Vec<f64> {
        let mut numbers = draw.values.clone();
        let terms = self.law.terms();
        for (block, beta) in self.model.blocks.iter().zip(&draw.beta) {
            for (j, b) in beta.iter().enumerate() {
                let factor = if j < terms.len() {
                    terms[j].factor
                } else {
                    100.0
                };
                let _ = block;
                numbers.push(b * self.model.scale * factor);
            }
        }
        numbers
    }

    fn tell_parameters(&mut self) {
        let terms = self.law.terms();
        let mut names: Vec<(String, String, Option<String>, bool)> = self
            .model
            .shapes
            .iter()
            .map(|s| (s.name.to_owned(), s.unit.to_owned(), None, false))
            .collect();
        for block in &self.model.blocks {
            let name = |m: usize| Some(self.model.curves[m].name.clone());
            let owner = match block.members.as_slice() {
                [only] if self.model.blocks.len() > 1 => name(*only),
                _ => None,
            };
            for t in terms {
                names.push((
                    t.name.to_owned(),
                    t.unit.to_owned(),
                    owner.clone(),
                    t.positive,
                ));
            }
            if block.elastic {
                names.push(("J_0".to_owned(), "%".to_owned(), owner.clone(), true));
            }
            for &m in &block.members {
                let single = self.model.curves.len() == 1;
                let of = if single { None } else { name(m) };
                names.push(("epsilon_0".to_owned(), "%".to_owned(), of, false));
            }
        }
        let best = self.numbers(&self.best);
        let drawn: Vec<Vec<f64>> = self.draws.iter().map(|d| self.numbers(d)).collect();
        let count = drawn.len() as f64;
        let mean: Vec<f64> = (0..best.len())
            .map(|i| drawn.iter().map(|d| d[i]).sum::<f64>() / count)
            .collect();
        if !drawn.is_empty() {
            self.covariance = (0..best.len())
                .map(|i| {
                    (0..best.len())
                        .map(|j| {
                            drawn
                                .iter()
                                .map(|d| (d[i] - mean[i]) * (d[j] - mean[j]))
                                .sum::<f64>()
                                / (count - 1.0)
                        })
                        .collect()
                })
                .collect();
        }
        self.parameters = names
            .into_iter()
            .enumerate()
            .map(|(i, (name, unit, specimen, positive))| {
                let mut values: Vec<f64> = drawn.iter().map(|d| d[i]).collect();
                values.sort_by(f64::total_cmp);
                let tail = 0.5 * (1.0 - self.level);
                let (low, high) = (quantile(&values, tail), quantile(&values, 1.0 - tail));
                let not_identifiable = if drawn.is_empty() {
                    None
                } else if let Some(shape) = self.model.shapes.get(i) {
                    let mut places: Vec<f64> = self.draws.iter().map(|d| d.places[i]).collect();
                    places.sort_by(f64::total_cmp);
                    let low = quantile(&places, tail);
                    let high = quantile(&places, 1.0 - tail);
                    undecided_shape(shape, low, high)
                } else {
                    undecided_amplitude(&name, positive, low, high)
                };
                Parameter {
                    name,
                    unit,
                    specimen,
                    value: best[i],
                    std_error: self
                        .covariance
                        .get(i)
                        .map_or(f64::NAN, |row| row[i].max(0.0).sqrt()),
                    low,
                    high,
                    not_identifiable,
                }
            })
            .collect();
    }

    /// A parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }
}

/// An interval that fills most of what was searched, or ends at a bound, is no answer.
fn undecided_shape(shape: &super::law::Shape, low: f64, high: f64) -> Option<String> {
    /// An end this close to a bound (in parts of the searched range) is the bound.
    const AT_BOUND: f64 = 0.03;
    /// An interval this wide says nothing.
    const WIDE: f64 = 0.8;
    let (v_low, v_high) = (shape.value(low), shape.value(high));
    if high - low > WIDE {
        Some(format!(
            "anything from {v_low:.2e} to {v_high:.2e} {} fits",
            shape.unit
        ))
    } else if low < AT_BOUND && high > AT_BOUND {
        Some(format!("anything below {v_high:.3e} {} fits", shape.unit))
    } else if high > 1.0 - AT_BOUND && low < 1.0 - AT_BOUND {
        Some(format!("anything above {v_low:.3e} {} fits", shape.unit))
    } else {
        None
    }
}

/// An amplitude that is nothing or within a factor of thirty is not told.
fn undecided_amplitude(name: &str, positive: bool, low: f64, high: f64) -> Option<String> {
    /// From a thirtieth of the upper end on, zero is as good.
    const FACTOR: f64 = 30.0;
    (positive && name != "epsilon_0" && high > FACTOR * low)
        .then(|| format!("anything below {high:.3e} fits"))
}
