//! Robots of one type: correlation of their parameters, and the prior of a further robot.
//!
//! The parameters of a robot differ from its description by `x`, in units of the tolerance:
//!
//! ```text
//! x_k = μ + e_k      μ ~ N(0, 1 − ρ²)      e_k ~ N(0, ρ²)
//! ```
//!
//! `μ` is the error of the drawing or the data sheet common to all robots, `e_k` the individual deviation of a robot.
//! Together they have the variance of the tolerance: a robot without data on a parameter starts from its tolerance, for
//! any `ρ`. `ρ` is one number for each kind of parameter. It maximises the marginal likelihood of the robots, by
//! expectation maximisation over `μ` and `e_k` of all parameters jointly, because an error of the masses that appears
//! as an error of the stiffness does so in every robot.
//!
//! With the marginal information `L_k` of a robot about its own parameters, that about `μ` is
//! `L_k − L_k (L_k + S⁻¹)⁻¹ L_k`, `S` diagonal with `ρ²`.

pub use super::effects::Kind;
use super::error::MapError;
use super::prior::Prior;
use super::state_estimate::{Payload, StateEstimate, UNKNOWN_OFFSET_RAD};
use crate::cholesky;
use alloc::vec::Vec;

/// Correlation of the robots of a type in one kind of parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedParameters {
    /// Kind of the parameter.
    pub kind: Kind,
    /// Standard deviation between robots, divided by the tolerance: 1 means that robots have nothing in common.
    pub ratio: f64,
}

/// Minimum of the individual ratio, in tolerances.
const MIN_RATIO: f64 = 0.02;
/// Maximum of the individual ratio: the common part is never exactly zero.
const MAX_RATIO: f64 = 0.995;
/// Steps of expectation and maximisation, and the change of a ratio below which they end.
const STEPS: usize = 40;
const STILL: f64 = 0.002;
/// Initial value of the ratios: without information they remain close to 1, at which robots share nothing.
const INITIAL_RATIO: f64 = 0.9;
/// Prior standard deviation of fixed parameters, which are not estimated.
const FIXED_STD: f64 = 1e-8;

/// Returns the prior of a further robot of a type, from the priors and posteriors of `parts`, robots of the type:
/// `(before, after)` per robot; and the ratio of each kind of parameter.
///
/// Offsets, slack, the encoder zero offsets and the payload belong to recordings: their priors are those of a new
/// recording.
///
/// # Errors
/// Returns a [`MapError`] if a posterior belongs to another robot or its covariance is not positive definite.
///
/// # Source
/// The ratios' prior keeps them from 0: Y. Chung et al., *A nondegenerate penalized likelihood estimator for variance
/// parameters in multilevel models*, Psychometrika 78 (2013).
pub fn learn_type(
    prior: &Prior,
    parts: &[[StateEstimate; 2]],
) -> Result<(StateEstimate, Vec<SharedParameters>), MapError> {
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let d = prior.dimension();
    let is_open = |k: &usize| fresh.covariance[k * d + k] > FIXED_STD * FIXED_STD;
    let kinds: Vec<(usize, Kind)> = (0..d)
        .filter(is_open)
        .filter_map(|k| Some((k, prior.parameter(k)?.kind?)))
        .collect();
    let places: Vec<usize> = kinds.iter().map(|(k, _)| *k).collect();
    let model = Shared::of(&fresh, d, &places, parts)?;
    let mut parameters: Vec<SharedParameters> = (Kind::ALL.into_iter())
        .filter(|kind| kinds.iter().any(|(_, k)| k == kind))
        .map(|kind| SharedParameters {
            kind,
            ratio: INITIAL_RATIO,
        })
        .collect();
    let of = |parameters: &[SharedParameters], kind: Kind| {
        let found = parameters.iter().find(|a| a.kind == kind);
        found.map_or(MAX_RATIO, |a| a.ratio)
    };
    let variances = |parameters: &[SharedParameters]| -> Vec<[f64; 2]> {
        let own = kinds.iter().map(|(_, kind)| of(parameters, *kind));
        own.map(|r| [1.0 - r * r, r * r]).collect()
    };
    for _ in 0..STEPS {
        let squares = model.expect(&variances(&parameters))?;
        let mut moved = 0.0_f64;
        for one in &mut parameters {
            let own = kinds
                .iter()
                .zip(&squares)
                .filter(|((_, kind), _)| *kind == one.kind);
            let [mut n, mut common, mut differing] = [0.0; 3];
            for (_, [mu, e]) in own {
                (n, common, differing) = (n + 1.0, common + mu, differing + e);
            }
            let ratio = max_likelihood_ratio(n, parts.len() as f64, common, differing);
            moved = moved.max((ratio - one.ratio).abs());
            one.ratio = ratio;
        }
        if moved < STILL {
            break;
        }
    }
    let state_estimate = model.further(&fresh, d, &variances(&parameters))?;
    Ok((state_estimate, parameters))
}

/// Returns the prior of a further robot of a type that shares only the inertial parameters of the links, up to the
/// ratio `shared` of their tolerance.
///
/// # Errors
/// Returns the errors of [`learn_type`].
pub fn pool_bodies(
    prior: &Prior,
    parts: &[[StateEstimate; 2]],
    shared: f64,
) -> Result<StateEstimate, MapError> {
    // The ratio is at least 0.001 of the tolerance.
    let shared = shared.max(1e-3);
    let d = prior.dimension();
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let from = prior.body_start();
    let places: Vec<usize> = (from..prior.payload_place()).collect();
    let model = Shared::of(&fresh, d, &places, parts)?;
    let variances = alloc::vec![[1.0, shared * shared]; places.len()];
    model.further(&fresh, d, &variances)
}

/// Returns the ratio that maximises the likelihood of `n` parameters of `robots` robots with `Σ E μ²` and `Σ E e²`.
fn max_likelihood_ratio(n: f64, robots: f64, common: f64, differing: f64) -> f64 {
    const GRID: usize = 200;
    let log = |x: f64| libm::log(x);
    let step = (log(MAX_RATIO) - log(MIN_RATIO)) / (GRID - 1) as f64;
    let ratios = (0..GRID).map(|i| libm::exp(log(MIN_RATIO) + step * i as f64));
    let of = |ratio: f64| {
        let (own, shared) = (ratio * ratio, 1.0 - ratio * ratio);
        let e = n * robots * log(own) + differing / own;
        let mu = n * log(shared) + common / shared;
        log(ratio) - 0.5 * (e + mu)
    };
    let best = ratios.max_by(|a, b| of(*a).total_cmp(&of(*b)));
    best.unwrap_or(MAX_RATIO)
}

/// Information of robots on some parameters, in units of their tolerances about the description.
struct Shared {
    places: Vec<usize>,
    /// Tolerance of each parameter.
    scale: Vec<f64>,
    /// Information matrix and information vector of each robot.
    robots: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Shared {
    fn of(
        fresh: &StateEstimate,
        d: usize,
        places: &[usize],
        parts: &[[StateEstimate; 2]],
    ) -> Result<Self, MapError> {
        let m = places.len();
        let scale: Vec<f64> = (places.iter())
            .map(|k| libm::sqrt(fresh.covariance[k * d + k]))
            .collect();
        let of = |state_estimate: &StateEstimate| -> Result<(Vec<f64>, Vec<f64>), MapError> {
            state_estimate.check_dimension(d)?;
            let mut block = alloc::vec![0.0; m * m];
            for (i, a) in places.iter().enumerate() {
                for (k, b) in places.iter().enumerate() {
                    block[i * m + k] = state_estimate.covariance[a * d + b] / (scale[i] * scale[k]);
                }
            }
            let information = cholesky::inverse(&block, m).map_err(MapError::Prior)?;
            let about = places.iter().zip(&scale);
            let about = about.map(|(k, s)| (state_estimate.mean[*k] - fresh.mean[*k]) / s);
            let pull = times(&information, &about.collect::<Vec<_>>());
            Ok((information, pull))
        };
        let robot = |[before, after]: &[StateEstimate; 2]| {
            let (then, now) = (of(before)?, of(after)?);
            let apart =
                |a: Vec<f64>, b: Vec<f64>| a.into_iter().zip(b).map(|(a, b)| a - b).collect();
            Ok((apart(now.0, then.0), apart(now.1, then.1)))
        };
        Ok(Self {
            robots: parts.iter().map(robot).collect::<Result<_, MapError>>()?,
            places: places.to_vec(),
            scale,
        })
    }

    /// Returns `(L_k + S⁻¹)⁻¹` of each robot, and the covariance and mean of `μ`.
    fn solve(&self, variances: &[[f64; 2]]) -> Result<Solved, MapError> {
        let m = self.places.len();
        let inverse = |a: &[f64]| cholesky::inverse(a, m).map_err(MapError::Prior);
        let mut information = alloc::vec![0.0; m * m];
        let mut vector = alloc::vec![0.0; m];
        for (i, [common, _]) in variances.iter().enumerate() {
            information[i * m + i] = 1.0 / common;
        }
        let mut own = Vec::with_capacity(self.robots.len());
        for (learned, pull) in &self.robots {
            let mut widened = learned.clone();
            for (i, [_, differing]) in variances.iter().enumerate() {
                widened[i * m + i] += 1.0 / differing;
            }
            let widened = inverse(&widened)?;
            // L (L + S⁻¹)⁻¹, row by row: all three are symmetric.
            for i in 0..m {
                let share = times(&widened, &learned[i * m..(i + 1) * m]);
                vector[i] += pull[i] - cholesky::dot(&share, pull);
                for (k, taken) in times(learned, &share).iter().enumerate() {
                    information[i * m + k] += learned[i * m + k] - taken;
                }
            }
            own.push(widened);
        }
        let covariance = inverse(&information)?;
        let mean = times(&covariance, &vector);
        Ok(Solved {
            own,
            covariance,
            mean,
        })
    }

    /// Returns `E μ²` of each parameter, and the sum over robots of `E e²`.
    fn expect(&self, variances: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, MapError> {
        let m = self.places.len();
        let solved = self.solve(variances)?;
        let mut out: Vec<[f64; 2]> = (0..m)
            .map(|i| {
                let mean = solved.mean[i];
                [mean * mean + solved.covariance[i * m + i], 0.0]
            })
            .collect();
        for ((learned, pull), own) in self.robots.iter().zip(&solved.own) {
            let common = times(learned, &solved.mean);
            let left: Vec<f64> = pull.iter().zip(common).map(|(h, c)| h - c).collect();
            let mean = times(own, &left);
            for i in 0..m {
                // Var e = (L + S⁻¹)⁻¹ + G cov μ Gᵀ, G = (L + S⁻¹)⁻¹ L.
                let g = times(learned, &own[i * m..(i + 1) * m]);
                let of_common = cholesky::dot(&g, &times(&solved.covariance, &g));
                out[i][1] += mean[i] * mean[i] + own[i * m + i] + of_common;
            }
        }
        Ok(out)
    }

    /// Returns the prior of a further robot.
    fn further(
        &self,
        fresh: &StateEstimate,
        d: usize,
        variances: &[[f64; 2]],
    ) -> Result<StateEstimate, MapError> {
        let m = self.places.len();
        let Solved {
            covariance, mean, ..
        } = self.solve(variances)?;
        let mut out = fresh.clone();
        for (i, a) in self.places.iter().enumerate() {
            out.mean[*a] = fresh.mean[*a] + self.scale[i] * mean[i];
            for (k, b) in self.places.iter().enumerate() {
                let own = if i == k { variances[i][1] } else { 0.0 };
                // What rounding leaves unsymmetric is no information.
                let both = 0.5 * (covariance[i * m + k] + covariance[k * m + i]);
                out.covariance[a * d + b] = self.scale[i] * self.scale[k] * (both + own);
            }
        }
        Ok(out)
    }
}

/// Posterior at given ratios.
struct Solved {
    own: Vec<Vec<f64>>,
    covariance: Vec<f64>,
    mean: Vec<f64>,
}

fn times(a: &[f64], x: &[f64]) -> Vec<f64> {
    a.chunks_exact(x.len().max(1))
        .map(|line| cholesky::dot(line, x))
        .collect()
}

#[cfg(test)]
mod tests;
