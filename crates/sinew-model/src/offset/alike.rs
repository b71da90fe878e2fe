//! Robots of one type: how alike they are, and what a further one of them starts from.
//!
//! Of every parameter a robot differs from its description by `x`, in units of its tolerance:
//!
//! ```text
//! x_k = μ + e_k      μ ~ N(0, 1 − ρ²)      e_k ~ N(0, ρ²)
//! ```
//!
//! `μ` is what the drawing or the data sheet has wrong for all of them, `e_k` what differs from one robot to the next.
//! Together they are what the tolerance allows: who has learned nothing of a parameter starts from its tolerance, whatever `ρ`.
//! `ρ` is one number for each kind of parameter and is found by the robots' marginal likelihood, by expectation and
//! maximisation over `μ` and `e_k` of all parameters together: what makes the masses look wrong makes the stiffness look
//! wrong with them, in every robot alike.
//!
//! With the marginal information `L_k` of a robot about its own parameters, that about `μ` is
//! `L_k − L_k (L_k + S⁻¹)⁻¹ L_k`, `S` diagonal with `ρ²`.

use super::belief::{Belief, Payload, UNKNOWN_OFFSET_RAD};
pub use super::effects::Kind;
use super::error::MapError;
use super::prior::Prior;
use crate::arm::PARAMETERS_PER_BODY;
use crate::cholesky;
use alloc::vec::Vec;

/// How alike robots of a type are in one kind of parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alike {
    /// The kind.
    pub kind: Kind,
    /// What one robot differs from the next by, over the tolerance: 1 says that robots have nothing in common.
    pub ratio: f64,
}

/// What robots differ by is no less than this part of a tolerance.
const LEAST: f64 = 0.02;
/// And no more than this: what all have in common isn't quite nothing.
const MOST: f64 = 0.995;
/// Steps of expectation and maximisation, and the change of a ratio below which they end.
const STEPS: usize = 40;
const STILL: f64 = 0.002;
/// Where ratios begin: robots that can't tell stay near to having nothing in common.
const BEGIN: f64 = 0.9;
/// What is held fixed isn't estimated.
const FIXED: f64 = 1e-8;

/// Prior of a further robot of a type, from what `parts`, robots of the type, have each learned: `(before, after)` per
/// robot; and how alike they are.
///
/// Offsets, slack, the encoders' zero and the payload belong to recordings: they are as before any.
///
/// # Errors
/// [`MapError`] when a belief is of another robot or no covariance.
///
/// # Source
/// The ratios' prior keeps them from 0: Y. Chung et al., *A nondegenerate penalized likelihood estimator for variance
/// parameters in multilevel models*, Psychometrika 78 (2013).
pub fn learn_type(prior: &Prior, parts: &[[Belief; 2]]) -> Result<(Belief, Vec<Alike>), MapError> {
    let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let d = prior.dimension();
    let is_open = |k: &usize| fresh.covariance[k * d + k] > FIXED * FIXED;
    let kinds: Vec<(usize, Kind)> = (0..d)
        .filter(is_open)
        .filter_map(|k| Some((k, prior.parameter(k)?.kind?)))
        .collect();
    let places: Vec<usize> = kinds.iter().map(|(k, _)| *k).collect();
    let model = Shared::of(&fresh, d, &places, parts)?;
    let mut alike: Vec<Alike> = (Kind::ALL.into_iter())
        .filter(|kind| kinds.iter().any(|(_, k)| k == kind))
        .map(|kind| Alike { kind, ratio: BEGIN })
        .collect();
    let of = |alike: &[Alike], kind: Kind| {
        let found = alike.iter().find(|a| a.kind == kind);
        found.map_or(MOST, |a| a.ratio)
    };
    let variances = |alike: &[Alike]| -> Vec<[f64; 2]> {
        let own = kinds.iter().map(|(_, kind)| of(alike, *kind));
        own.map(|r| [1.0 - r * r, r * r]).collect()
    };
    for _ in 0..STEPS {
        let squares = model.expect(&variances(&alike))?;
        let mut moved = 0.0_f64;
        for one in &mut alike {
            let own = kinds
                .iter()
                .zip(&squares)
                .filter(|((_, kind), _)| *kind == one.kind);
            let [mut n, mut common, mut differing] = [0.0; 3];
            for (_, [mu, e]) in own {
                (n, common, differing) = (n + 1.0, common + mu, differing + e);
            }
            let ratio = likeliest(n, parts.len() as f64, common, differing);
            moved = moved.max((ratio - one.ratio).abs());
            one.ratio = ratio;
        }
        if moved < STILL {
            break;
        }
    }
    let belief = model.further(&fresh, d, &variances(&alike))?;
    Ok((belief, alike))
}

/// Prior of a further robot of a type whose links are alike to `alike` of their tolerance, and in nothing else.
///
/// # Errors
/// As [`learn_type`].
pub fn pool_bodies(prior: &Prior, parts: &[[Belief; 2]], alike: f64) -> Result<Belief, MapError> {
    // Nothing is alike to more than a thousandth of its tolerance.
    let alike = alike.max(1e-3);
    let d = prior.dimension();
    let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    let from = prior.body_start();
    let places: Vec<usize> = (from..from + prior.joints() * PARAMETERS_PER_BODY).collect();
    let model = Shared::of(&fresh, d, &places, parts)?;
    let variances = alloc::vec![[1.0, alike * alike]; places.len()];
    model.further(&fresh, d, &variances)
}

/// The ratio at which `n` parameters of `robots` robots have `Σ E μ²` and `Σ E e²`.
fn likeliest(n: f64, robots: f64, common: f64, differing: f64) -> f64 {
    const GRID: usize = 200;
    let log = |x: f64| libm::log(x);
    let step = (log(MOST) - log(LEAST)) / (GRID - 1) as f64;
    let ratios = (0..GRID).map(|i| libm::exp(log(LEAST) + step * i as f64));
    let of = |ratio: f64| {
        let (own, shared) = (ratio * ratio, 1.0 - ratio * ratio);
        let e = n * robots * log(own) + differing / own;
        let mu = n * log(shared) + common / shared;
        log(ratio) - 0.5 * (e + mu)
    };
    let best = ratios.max_by(|a, b| of(*a).total_cmp(&of(*b)));
    best.unwrap_or(MOST)
}

/// What robots have learned of some parameters, in units of their tolerances about what the description says.
struct Shared {
    places: Vec<usize>,
    /// Tolerances.
    scale: Vec<f64>,
    /// Of each robot its information, and that times what it says.
    robots: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Shared {
    fn of(
        fresh: &Belief,
        d: usize,
        places: &[usize],
        parts: &[[Belief; 2]],
    ) -> Result<Self, MapError> {
        let m = places.len();
        let scale: Vec<f64> = (places.iter())
            .map(|k| libm::sqrt(fresh.covariance[k * d + k]))
            .collect();
        let of = |belief: &Belief| -> Result<(Vec<f64>, Vec<f64>), MapError> {
            belief.check_dimension(d)?;
            let mut block = alloc::vec![0.0; m * m];
            for (i, a) in places.iter().enumerate() {
                for (k, b) in places.iter().enumerate() {
                    block[i * m + k] = belief.covariance[a * d + b] / (scale[i] * scale[k]);
                }
            }
            let information = cholesky::inverse(&block, m).map_err(MapError::Prior)?;
            let about = places.iter().zip(&scale);
            let about = about.map(|(k, s)| (belief.mean[*k] - fresh.mean[*k]) / s);
            let pull = times(&information, &about.collect::<Vec<_>>());
            Ok((information, pull))
        };
        let robot = |[before, after]: &[Belief; 2]| {
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

    /// `(L_k + S⁻¹)⁻¹` of each robot, and covariance and mean of `μ`.
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

    /// Of each parameter `E μ²`, and the sum over robots of `E e²`.
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

    /// What a further robot starts from.
    fn further(
        &self,
        fresh: &Belief,
        d: usize,
        variances: &[[f64; 2]],
    ) -> Result<Belief, MapError> {
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

/// What is known at given ratios.
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
