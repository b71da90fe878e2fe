//! Beliefs between recordings: aged, merged, at another temperature.

use super::belief::{Belief, Payload, UNKNOWN_OFFSET_RAD};
use super::effects::JointParameter as P;
use super::effects::thermal::Thermal;
use super::error::MapError;
use super::prior::Prior;
use crate::cholesky;
use alloc::vec::Vec;

/// Widens the belief for what changes from one day to the next, by the [lifetime](super::effects::Lifetime) of every
/// parameter. A stiffness that fell by more is found as a change.
///
/// Variances add and stop at the prior's: a chain of recordings can't become surer of
/// friction than friction is constant.
pub fn age(prior: &Prior, belief: &mut Belief) {
    age_by(prior, belief, 1.0);
}

/// [`age`] for a number of days, of which parts count: variances grow with time, however often they are told.
/// What is no number of days leaves the belief as it is.
pub fn age_by(prior: &Prior, belief: &mut Belief, days: f64) {
    if !(days > 0.0) {
        return;
    }
    let d = prior.dimension();
    if belief.covariance.len() != d * d {
        return;
    }
    let fresh = prior.belief(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    for k in 0..prior.payload_place() {
        let parameter = prior.parameter(k);
        let Some(share) = parameter.and_then(|p| p.lifetime.daily_share()) else {
            continue;
        };
        let most = fresh.covariance[k * d + k];
        let room = (most - belief.covariance[k * d + k]).max(0.0);
        belief.covariance[k * d + k] += (share * share * days * most).min(room);
    }
}

/// What `a` and `b` learned apart from `common`, which both started from, put together.
///
/// In information form, `Λ = Λ_a + Λ_b − Λ_common`, so what both already knew counts once. Where each knows at least what they
/// started with, no variance comes out above that of either. One that does shows that something was forgotten, as of a stiffness after
/// a strand failed: then the sum throws means far beyond what either says. The result is `Λ = (Λ_a + Λ_b)/2` instead, which is never
/// surer than they are, whatever they share (covariance intersection: Julier and Uhlmann, 1997).
/// Offsets and payload belong to a recording, the encoders' zero to a tensioning, not to the
/// robot: they are opened in the result, as in `common`.
///
/// # Errors
/// [`MapError`] when lengths or covariances are no beliefs of this robot.
pub fn merge(prior: &Prior, common: &Belief, a: &Belief, b: &Belief) -> Result<Belief, MapError> {
    let d = prior.dimension();
    let mut inputs = [common.clone(), a.clone(), b.clone()];
    for belief in &mut inputs {
        belief.check_dimension(d)?;
        prior.open_offsets(belief, UNKNOWN_OFFSET_RAD);
        prior.open_zero(belief);
        prior.open_payload(belief, Payload::Unknown);
    }
    let mut parts = Vec::with_capacity(inputs.len());
    for belief in &inputs {
        parts.push(cholesky::inverse(&belief.covariance, d).map_err(MapError::Prior)?);
    }
    let added = |weights: [f64; 3]| {
        let (mut information, mut vector) = (alloc::vec![0.0; d * d], alloc::vec![0.0; d]);
        for ((belief, part), weight) in inputs.iter().zip(&parts).zip(weights) {
            for i in 0..d {
                for k in 0..d {
                    information[i * d + k] += weight * part[i * d + k];
                    vector[i] += weight * part[i * d + k] * (belief.mean[k] - inputs[0].mean[k]);
                }
            }
        }
        cholesky::inverse(&information, d).map(|covariance| (covariance, vector))
    };
    let [_, a, b] = &inputs;
    /// Of rounding.
    const ROUNDED: f64 = 1e-6;
    let only_learned = |covariance: &[f64]| {
        (0..d).map(|i| i * (d + 1)).all(|k| {
            let larger = a.covariance[k].max(b.covariance[k]);
            covariance[k] <= (1.0 + ROUNDED) * larger
        })
    };
    let (covariance, vector) = match added([-1.0, 1.0, 1.0]) {
        Ok(sum) if only_learned(&sum.0) => sum,
        _ => added([0.0, 0.5, 0.5]).map_err(MapError::Prior)?,
    };
    let mut mean = inputs[0].mean.clone();
    for i in 0..d {
        for k in 0..d {
            mean[i] += covariance[i * d + k] * vector[k];
        }
    }
    Ok(Belief {
        mean,
        covariance,
        temperature_c: common.temperature_c,
    })
}

/// The same belief with offsets and stiffness referred to another temperature.
///
/// Compliance and zero are linear in temperature, so this is the exact linear map
/// `δκ ← δκ + c_K Δ`, `delta_e ← delta_e + α_T Δ` on mean and covariance. A belief without a
/// temperature, or a temperature that isn't one, stays as it is.
pub fn refer_to(prior: &Prior, belief: &mut Belief, temperature_c: f64) {
    let d = prior.dimension();
    let warmer = temperature_c - belief.temperature_c;
    if !warmer.is_finite() || belief.check_dimension(d).is_err() {
        return;
    }
    for i in (0..prior.joints()).filter(|&i| prior.is_elastic(i)) {
        for (to, from) in Thermal::CHANGES {
            let (to, from) = (prior.place(i, to), prior.place(i, from));
            belief.mean[to] += warmer * belief.mean[from];
            for k in 0..d {
                belief.covariance[to * d + k] += warmer * belief.covariance[from * d + k];
            }
            for k in 0..d {
                belief.covariance[k * d + to] += warmer * belief.covariance[k * d + from];
            }
        }
    }
    belief.temperature_c = temperature_c;
}

/// Widens the stiffness for a temperature known to `deviation_k` only, and returns the standard deviation
/// that leaves in every joint's offset, rad: with `c_K` of the compliance and `α_T` of the zero,
///
/// ```text
/// var κ ← var κ + (c̄_K² + var c_K) σ_T²,    σ_offset = √(ᾱ_T² + var α_T) σ_T
/// ```
///
/// The zero's drift looks like an offset in every block, so no recording can take it off: it belongs into
/// the interval, not into the belief.
pub fn unknown_temperature(prior: &Prior, belief: &mut Belief, deviation_k: f64) -> Vec<f64> {
    let d = prior.dimension();
    let mut out = alloc::vec![0.0; prior.joints()];
    if belief.check_dimension(d).is_err() {
        return out;
    }
    for i in (0..prior.joints()).filter(|&i| prior.is_elastic(i)) {
        let size = |p: P| {
            let x = belief.entry(prior.place(i, p));
            libm::hypot(x.mean, x.deviation) * deviation_k
        };
        let (softer, drift) = (size(P::Thermal), size(P::Drift));
        let at = prior.place(i, P::Compliance);
        belief.covariance[at * d + at] += softer * softer;
        out[i] = drift;
    }
    out
}
