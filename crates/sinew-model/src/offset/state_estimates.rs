//! State estimates between recordings: aged, merged, at another temperature.

use super::effects::JointParameter as P;
use super::effects::thermal::Thermal;
use super::error::MapError;
use super::prior::Prior;
use super::state_estimate::{Payload, StateEstimate, UNKNOWN_OFFSET_RAD};
use crate::cholesky;
use alloc::vec::Vec;

/// Increases the variances for the changes from one day to the next, by the [lifetime](super::effects::Lifetime) of
/// every
/// parameter. A stiffness that fell by more is found as a change.
///
/// Variances add up and are bounded by the prior's: a chain of recordings cannot become more certain of friction than
/// friction is constant.
pub fn age(prior: &Prior, state_estimate: &mut StateEstimate) {
    age_by(prior, state_estimate, 1.0);
}

/// Widens the posterior as [`age`] for a number of days, which may be fractional: variances grow with time, independent
/// of the number of calls. A number that is not positive has no effect.
pub fn age_by(prior: &Prior, state_estimate: &mut StateEstimate, days: f64) {
    if !(days > 0.0) {
        return;
    }
    let d = prior.dimension();
    if state_estimate.covariance.len() != d * d {
        return;
    }
    let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
    for k in 0..prior.payload_place() {
        let parameter = prior.parameter(k);
        let Some(share) = parameter.and_then(|p| p.lifetime.daily_share()) else {
            continue;
        };
        let most = fresh.covariance[k * d + k];
        let room = (most - state_estimate.covariance[k * d + k]).max(0.0);
        state_estimate.covariance[k * d + k] += (share * share * days * most).min(room);
    }
    age_motor_torques(prior, state_estimate, &fresh);
}

/// Change of a motor's torque constant from one session to the next: −0.12 %/K of the remanence of NdFeB magnets (data sheets) and 8 K between a
/// cold motor and one at work. For a tendon with a separate equation the joint torque determines it within the session;
/// the common tension of antagonistic strands is determined only by the motor.
const TORQUE_CONSTANT: f64 = 0.01;

/// Widens scale and zero of the torques of motors whose tendons pull together, up to the prior.
fn age_motor_torques(prior: &Prior, state_estimate: &mut StateEstimate, fresh: &StateEstimate) {
    let d = prior.dimension();
    let Some(routes) = prior.routings().filter(|routes| routes.has_pulls()) else {
        return;
    };
    for i in (0..prior.joints()).filter(|i| routes.pull(*i).is_some()) {
        let usual_nm = prior.joints[i].map_or(0.0, |joint| joint.usual_torque_nm());
        for (parameter, size) in [(P::MotorScale, 1.0), (P::MotorBias, usual_nm)] {
            let k = prior.place(i, parameter) * (d + 1);
            let room = (fresh.covariance[k] - state_estimate.covariance[k]).max(0.0);
            let std = TORQUE_CONSTANT * size;
            state_estimate.covariance[k] += (std * std).min(room);
        }
    }
}

/// Merges the posteriors `a` and `b`, which both started from the prior `common`.
///
/// In information form, `Λ = Λ_a + Λ_b − Λ_common`, so that common information counts once. If the variances of each
/// are at most those of `common`, no variance of the result exceeds that of either. A larger one shows that information
/// was discarded, e.g. on a stiffness after a strand failure: then the sum would produce means far outside both
/// intervals. The result is `Λ = (Λ_a + Λ_b)/2` instead, which is never more certain than its inputs, for any
/// correlation (covariance intersection: Julier and Uhlmann, 1997). Offsets and payload belong to a recording, the
/// encoder zero offsets to a tensioning, not to the robot: their variances are reset in the result, as in `common`.
///
/// # Errors
/// Returns a [`MapError`] if lengths or covariances are invalid for this robot.
pub fn merge(
    prior: &Prior,
    common: &StateEstimate,
    a: &StateEstimate,
    b: &StateEstimate,
) -> Result<StateEstimate, MapError> {
    let d = prior.dimension();
    let mut inputs = [common.clone(), a.clone(), b.clone()];
    for state_estimate in &mut inputs {
        state_estimate.check_dimension(d)?;
        prior.reset_offsets(state_estimate, UNKNOWN_OFFSET_RAD);
        prior.reset_zero(state_estimate);
        prior.reset_payload(state_estimate, Payload::Unknown);
    }
    let mut parts = Vec::with_capacity(inputs.len());
    for state_estimate in &inputs {
        parts.push(cholesky::inverse(&state_estimate.covariance, d).map_err(MapError::Prior)?);
    }
    let added = |weights: [f64; 3]| {
        let (mut information, mut vector) = (alloc::vec![0.0; d * d], alloc::vec![0.0; d]);
        for ((state_estimate, part), weight) in inputs.iter().zip(&parts).zip(weights) {
            for i in 0..d {
                for k in 0..d {
                    information[i * d + k] += weight * part[i * d + k];
                    vector[i] +=
                        weight * part[i * d + k] * (state_estimate.mean[k] - inputs[0].mean[k]);
                }
            }
        }
        cholesky::inverse(&information, d).map(|covariance| (covariance, vector))
    };
    let [_, a, b] = &inputs;
    /// Relative rounding error of variances.
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
    Ok(StateEstimate {
        mean,
        covariance,
        temperature_c: common.temperature_c,
    })
}

/// Refers offsets and stiffness of a posterior to another temperature.
///
/// Compliance and zero are linear in temperature, so this is the exact linear map `δκ ← δκ + c_K Δ`,
/// `delta_e ← delta_e + α_T Δ` on mean and covariance. A posterior without a temperature is unchanged, as is any posterior if the
/// temperature is not finite.
pub fn refer_to(prior: &Prior, state_estimate: &mut StateEstimate, temperature_c: f64) {
    let d = prior.dimension();
    let warmer = temperature_c - state_estimate.temperature_c;
    if !warmer.is_finite() || state_estimate.check_dimension(d).is_err() {
        return;
    }
    for i in (0..prior.joints()).filter(|&i| prior.is_elastic(i)) {
        for (to, from) in Thermal::CHANGES {
            let (to, from) = (prior.place(i, to), prior.place(i, from));
            state_estimate.mean[to] += warmer * state_estimate.mean[from];
            for k in 0..d {
                state_estimate.covariance[to * d + k] +=
                    warmer * state_estimate.covariance[from * d + k];
            }
            for k in 0..d {
                state_estimate.covariance[k * d + to] +=
                    warmer * state_estimate.covariance[k * d + from];
            }
        }
    }
    state_estimate.temperature_c = temperature_c;
}

/// Widens the stiffness for a temperature with the standard deviation `std_k`, and returns the resulting standard
/// deviation of every joint's offset, rad: with `c_K` of the compliance and `α_T` of the zero,
///
/// ```text
/// var κ ← var κ + (c̄_K² + var c_K) σ_T²,    σ_offset = √(ᾱ_T² + var α_T) σ_T
/// ```
///
/// The drift of the zero is equivalent to an offset in every block and thus not identifiable within a recording: it is
/// added to the interval, not to the posterior.
pub fn unknown_temperature(
    prior: &Prior,
    state_estimate: &mut StateEstimate,
    std_k: f64,
) -> Vec<f64> {
    let d = prior.dimension();
    let mut out = alloc::vec![0.0; prior.joints()];
    if state_estimate.check_dimension(d).is_err() {
        return out;
    }
    for i in (0..prior.joints()).filter(|&i| prior.is_elastic(i)) {
        let size = |p: P| {
            let x = state_estimate.entry(prior.place(i, p));
            libm::hypot(x.mean, x.std) * std_k
        };
        let (softer, drift) = (size(P::Thermal), size(P::Drift));
        let at = prior.place(i, P::Compliance);
        state_estimate.covariance[at * d + at] += softer * softer;
        out[i] = drift;
    }
    out
}
