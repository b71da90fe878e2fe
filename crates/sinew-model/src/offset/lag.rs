//! How late the motor side is stamped against the joint side.

use super::effects::JointParameter;
use super::prior::Prior;
use super::state_estimate::StateEstimate;
use crate::Gaussian;
use crate::cholesky::{self, dot};
use alloc::vec::Vec;

/// Standard deviation of the delay by friction that is neither Coulomb nor viscous, s: synchronous sides are estimated
/// at −0.6 to −1.0 ms on the simulated arm of S5, whose friction also has presliding.
const OTHER_FRICTION_S: f64 = 0.5e-3;

/// Returns the delay of the motor encoder's time stamps relative to the joint encoder's, as the change from the prior,
/// s.
///
/// A delay `T` appears as a viscous friction of `−K T` at every joint. Let `m` with the covariance `C` be the changes
/// of the joints' viscous frictions from the recording alone, and `S = diag(s²)` the prior covariance of their
/// friction:
///
/// ```text
/// C⁻¹ = C_after⁻¹ − C_before⁻¹,    m = C (C_after⁻¹ m_after − C_before⁻¹ m_before) − m_before
/// W = (S + C)⁻¹,                   a = W K / KᵀW K,       T = −aᵀm
/// σ_T² = aᵀC a + (Σ |aᵢ| sᵢ)² + (0.5 ms)²
/// ```
///
/// The second term assumes that all friction errors have the same sign, because one default value, or one grease,
/// causes them. The third covers other components of friction. `opened_s` is the standard deviation with which
/// [`Prior::open_lag`] freed the delay in `before`. `None` if the recording provides no information on friction.
/// Source: generalised least squares; allocates.
pub fn lag_s(
    prior: &Prior,
    before: &StateEstimate,
    after: &StateEstimate,
    opened_s: f64,
) -> Option<Gaussian> {
    let elastic = (0..prior.joints()).filter(|&i| prior.is_elastic(i));
    let joints: Vec<usize> = elastic.collect();
    let n = joints.len();
    let place = |i: usize| prior.place(i, JointParameter::Viscous);
    let part = |state_estimate: &StateEstimate| {
        let d = prior.dimension();
        let rows = joints.iter().map(|&i| place(i) * d);
        let cells = rows.flat_map(|row| joints.iter().map(move |&k| row + place(k)));
        let covariance: Vec<f64> = cells.map(|at| state_estimate.covariance[at]).collect();
        let mean: Vec<f64> = joints
            .iter()
            .map(|&i| state_estimate.mean[place(i)])
            .collect();
        Some((cholesky::inverse(&covariance, n).ok()?, mean))
    };
    let ((old, old_mean), (new, new_mean)) = (part(before)?, part(after)?);
    let gained: Vec<f64> = new.iter().zip(&old).map(|(new, old)| new - old).collect();
    let mut spread = cholesky::inverse(&gained, n).ok()?;
    let pulled: Vec<f64> = (0..n)
        .map(|i| dot(&new[i * n..][..n], &new_mean) - dot(&old[i * n..][..n], &old_mean))
        .collect();
    let change: Vec<f64> = (0..n)
        .map(|i| dot(&spread[i * n..][..n], &pulled) - old_mean[i])
        .collect();
    let stiffness: Vec<f64> = (joints.iter())
        .map(|&i| prior.joints[i].map_or(0.0, |j| j.stiffness_nm_per_rad))
        .collect();
    let own: Vec<f64> = (joints.iter().zip(&stiffness))
        .map(|(&i, k)| {
            let (believed, lag) = (before.entry(place(i)).std, opened_s * k);
            libm::sqrt((believed * believed - lag * lag).max(0.0))
        })
        .collect();
    let friction_std = spread.clone();
    for (at, s) in own.iter().enumerate() {
        spread[at * n + at] += s * s;
    }
    let weights = cholesky::inverse(&spread, n).ok()?;
    let times = |matrix: &[f64], x: &[f64]| -> Vec<f64> {
        (0..n).map(|i| dot(&matrix[i * n..][..n], x)).collect()
    };
    let mut shares = times(&weights, &stiffness);
    let information = dot(&shares, &stiffness);
    if information <= 0.0 {
        return None;
    }
    shares.iter_mut().for_each(|a| *a /= information);
    let together: f64 = shares.iter().zip(&own).map(|(a, s)| a.abs() * s).sum();
    let scatter = dot(&shares, &times(&friction_std, &shares));
    let std = libm::sqrt(scatter + together * together + OTHER_FRICTION_S * OTHER_FRICTION_S);
    Some(Gaussian::new(-dot(&shares, &change), std))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::turntable;
    use crate::offset::{Payload, UNKNOWN_OFFSET_RAD};

    /// One joint of 40 N·m/rad with a delay of 5 ms and a friction standard deviation of 0.02 N·m·s/rad: the analytic
    /// value.
    #[test]
    fn delay_estimated_from_viscous_friction() {
        let model = turntable();
        let prior = &model.prior;
        let place = prior.place(0, JointParameter::Viscous);
        let d = prior.dimension();
        for opened_s in [0.0, 0.002] {
            let mut before = prior.state_estimate(Payload::Empty, UNKNOWN_OFFSET_RAD);
            prior.open_lag(&mut before, opened_s);
            let believed = before.entry(place);
            let (measured, std) = (believed.mean - 40.0 * 0.005, 0.02);
            let variance = believed.std * believed.std;
            let gain = variance / (variance + std * std);
            let mut after = before.clone();
            after.mean[place] += gain * (measured - believed.mean);
            after.covariance[place * d + place] *= 1.0 - gain;
            let late = lag_s(prior, &before, &after, opened_s).unwrap();
            assert!((late.mean - 0.005).abs() < 1e-9, "{late:?}");
            // The default friction is 2 mrad of 40 N·m/rad, and 0.6 of it per rad/s.
            let friction_std = libm::hypot(0.048, std) / 40.0;
            let expected = libm::hypot(friction_std, OTHER_FRICTION_S);
            assert!((late.std - expected).abs() < 1e-9, "{late:?}, {expected}");
            assert_eq!(
                lag_s(prior, &before, &before, opened_s),
                None,
                "nothing learned"
            );
        }
    }
}
