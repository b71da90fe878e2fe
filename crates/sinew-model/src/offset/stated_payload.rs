//! Evidence for a stated payload against an unknown one.
//!
//! Both hypotheses have the same likelihood and differ in the prior of the payload `x` (mass and first moments), which is
//! independent of that of the other parameters. The likelihood of `x` follows from the posterior `N(m, S)` with the
//! prior `N(m0, S0)` of an unknown payload, and the evidence of any other prior `N(a, A)` from it:
//!
//! ```text
//! L = S⁻¹ − S0⁻¹,   ℓ = S⁻¹ m − S0⁻¹ m0
//! ln Z(a, A) = ℓᵀ a − ½ aᵀ L a + ½ gᵀ A^½ (I + A^½ L A^½)⁻¹ A^½ g − ½ ln |I + A^½ L A^½|,   g = ℓ − L a
//! ```
//!
//! This is the Savage–Dickey density ratio where the stated payload is exact (`A = 0`).

use super::effects::PAYLOAD;
use super::error::MapError;
use super::estimate::MapEstimate;
use super::prior::Prior;
use super::state_estimate::{Payload, StateEstimate};
use crate::cholesky::{self, dot};

/// Matrix of the payload's entries, row-major.
type Matrix = [f64; PAYLOAD * PAYLOAD];

/// Likelihood of the payload: information and information times mean.
struct Likelihood {
    information: Matrix,
    pull: [f64; PAYLOAD],
}

impl Likelihood {
    /// Evidence of a prior with independent entries, up to a constant.
    fn ln_evidence(&self, mean: [f64; PAYLOAD], std: [f64; PAYLOAD]) -> Result<f64, MapError> {
        let times = |x: &[f64; PAYLOAD]| product(&self.information, x);
        let at_mean = times(&mean);
        let mut scaled: [f64; PAYLOAD] =
            core::array::from_fn(|k| std[k] * (self.pull[k] - at_mean[k]));
        let matrix: Matrix = core::array::from_fn(|at| {
            let (i, k) = (at / PAYLOAD, at % PAYLOAD);
            let unit = if i == k { 1.0 } else { 0.0 };
            unit + std[i] * self.information[at] * std[k]
        });
        let mut lower = [0.0; PAYLOAD * PAYLOAD];
        cholesky::factorise(&matrix, &mut lower, PAYLOAD).map_err(MapError::Prior)?;
        cholesky::forward(&lower, PAYLOAD, &mut scaled);
        let ln_root: f64 = (0..PAYLOAD)
            .map(|k| libm::log(lower[k * PAYLOAD + k]))
            .sum();
        Ok(
            dot(&self.pull, &mean) - 0.5 * dot(&at_mean, &mean) + 0.5 * dot(&scaled, &scaled)
                - ln_root,
        )
    }
}

/// Returns the logarithm of the Bayes factor for `stated` against an unknown payload, which was estimated in `map` from
/// the prior `before`.
///
/// # Errors
/// Returns [`MapError`] if a covariance is not positive definite.
pub fn ln_bayes_factor(
    prior: &Prior,
    before: &StateEstimate,
    map: &MapEstimate,
    stated: Payload,
) -> Result<f64, MapError> {
    let place = prior.payload_place();
    let part = |mean: &[f64], covariance: &[f64]| -> Result<Likelihood, MapError> {
        let total = mean.len();
        let matrix: Matrix = core::array::from_fn(|at| {
            let (i, k) = (place + at / PAYLOAD, place + at % PAYLOAD);
            covariance.get(i * total + k).copied().unwrap_or(f64::NAN)
        });
        let inverse = cholesky::inverse(&matrix, PAYLOAD).map_err(MapError::Prior)?;
        let information: Matrix =
            core::array::from_fn(|at| inverse.get(at).copied().unwrap_or(f64::NAN));
        let mean = core::array::from_fn(|k| mean.get(place + k).copied().unwrap_or(f64::NAN));
        Ok(Likelihood {
            information,
            pull: product(&information, &mean),
        })
    };
    let posterior = part(&map.state, &map.covariance)?;
    let unknown = part(&before.mean, &before.covariance)?;
    let likelihood = Likelihood {
        information: core::array::from_fn(|k| posterior.information[k] - unknown.information[k]),
        pull: core::array::from_fn(|k| posterior.pull[k] - unknown.pull[k]),
    };
    let evidence = |payload: Payload| {
        let expected = prior.payload_prior(payload);
        likelihood.ln_evidence(expected.map(|x| x.mean), expected.map(|x| x.std))
    };
    Ok(evidence(stated)? - evidence(Payload::Unknown)?)
}

fn product(matrix: &Matrix, x: &[f64; PAYLOAD]) -> [f64; PAYLOAD] {
    core::array::from_fn(|i| dot(&matrix[i * PAYLOAD..(i + 1) * PAYLOAD], x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One informative entry, the others without data: the Savage–Dickey ratio of two normal densities.
    #[test]
    fn exact_prior_has_savage_dickey_ratio() {
        let (measured, std) = (0.1, 0.02);
        let mut information = [0.0; PAYLOAD * PAYLOAD];
        information[0] = 1.0 / (std * std);
        let likelihood = Likelihood {
            information,
            pull: [measured / (std * std), 0.0, 0.0, 0.0],
        };
        let wide = 0.3_f64;
        let of = |mean: f64, std: f64| {
            let stds = [std, 1e-9, 1e-9, 1e-9];
            likelihood.ln_evidence([mean, 0.0, 0.0, 0.0], stds).unwrap()
        };
        let ln_density = |x: f64, mean: f64, std: f64| -0.5 * ((x - mean) / std).powi(2) - std.ln();
        for stated in [0.0, 0.08, 0.5] {
            let found = of(stated, 1e-9) - of(0.25, wide);
            // Density of the measurement under both priors.
            let expected =
                ln_density(measured, stated, std) - ln_density(measured, 0.25, std.hypot(wide));
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }

    /// All entries informative and correlated: the evidence of a wide prior equals a sum over a grid of exact ones.
    #[test]
    fn evidence_equals_average_over_prior() {
        let mut information = [0.0; PAYLOAD * PAYLOAD];
        for i in 0..PAYLOAD {
            for k in 0..PAYLOAD {
                information[i * PAYLOAD + k] = if i == k { 9.0 } else { 2.0 };
            }
        }
        let likelihood = Likelihood {
            information,
            pull: [1.0, -0.5, 0.3, 0.2],
        };
        let std = [0.4, 1e-9, 1e-9, 1e-9];
        let wide = likelihood.ln_evidence([0.1, 0.2, 0.0, -0.1], std).unwrap();
        let (mut sum, mut weights) = (0.0, 0.0);
        for step in -600..=600 {
            let z = 0.01 * f64::from(step);
            let at = [0.1 + 0.4 * z, 0.2, 0.0, -0.1];
            let exact = likelihood.ln_evidence(at, [1e-9; PAYLOAD]).unwrap();
            let weight = libm::exp(-0.5 * z * z);
            sum += weight * libm::exp(exact);
            weights += weight;
        }
        let expected = libm::log(sum / weights);
        assert!((wide - expected).abs() < 1e-6, "{wide} {expected}");
    }
}
