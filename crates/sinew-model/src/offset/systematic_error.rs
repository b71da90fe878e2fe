//! The systematic part of an offset's error, which all sessions since the same baseline share.

use super::effects::JointParameter as P;
use super::error::MapError;
use super::prior::Prior;
use super::state_estimate::StateEstimate;
use crate::cholesky::{Factor, dot};
use alloc::vec::Vec;

/// Parts of an offset's error that other sessions have too, as standard deviations, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SharedError {
    /// Error of the baseline, rad: the same in every session since then.
    pub baseline_rad: f64,
    /// Error by the temperature dependence of zero and stiffness, rad: proportional to the temperature change since
    /// then.
    pub drift_rad: f64,
}

impl SharedError {
    /// Limits each part to the standard deviation of the offset, rad.
    #[must_use]
    pub fn at_most(self, std_rad: f64) -> Self {
        Self {
            baseline_rad: self.baseline_rad.min(std_rad),
            drift_rad: self.drift_rad.min(std_rad),
        }
    }
}

/// Returns the parts of each joint's offset error that originate from the baseline, rad; 0 for rigid joints.
///
/// A session starts from the mean `x₀` and the covariance `P₀` of a baseline, with the variances of offsets and payload
/// reset and all others aged by one day. With its recording it estimates `x̂` with covariance `P`. The estimate is
/// linear, so
///
/// ```text
/// x̂ − x = P P₀⁻¹ (x₀ − x) + independent noise
/// ```
///
/// The error of the baseline, `x₀ − x` with its covariance `C`, is the same in every session that starts from it. With
/// `r = P₀⁻¹ P e`, `e` the joint's offset, the shared variance is `rᵀ C r`. Parameters whose variance is reset or grows
/// in each session contribute to the independent error. The temperature coefficients of zero and stiffness, `α_T` and
/// `c_K`, are multiplied by the temperature change: they are reported separately, because sessions at other
/// temperatures share them differently.
///
/// In a chain each session starts from the posterior of the previous one. If one estimate is based on another, the
/// covariance of their errors is that of the more precise one (as in a Kalman filter): the shared part is the smaller.
///
/// * `baseline`: as it was saved. `before`, `after`: prior and posterior of the session.
/// * `continues`: whether the session continues the baseline's last recording, including offsets and payload.
///
/// # Errors
/// Returns a [`MapError`] if a posterior belongs to another robot or its covariance is not positive definite.
pub fn shared_errors(
    prior: &Prior,
    baseline: &StateEstimate,
    before: &StateEstimate,
    after: &StateEstimate,
    continues: bool,
) -> Result<Vec<SharedError>, MapError> {
    let d = prior.dimension();
    for state_estimate in [baseline, before, after] {
        state_estimate.check_dimension(d)?;
    }
    // Scaled to unit diagonal: the parameters' units span fifteen orders of magnitude.
    let mut scale = Vec::with_capacity(d);
    for i in 0..d {
        let own = before.covariance[i * d + i];
        if !(own > 0.0 && own.is_finite()) {
            return Err(MapError::Prior(i));
        }
        scale.push(1.0 / libm::sqrt(own));
    }
    let mut scaled = before.covariance.clone();
    for (row, s) in scaled.chunks_exact_mut(d.max(1)).zip(&scale) {
        for (x, other) in row.iter_mut().zip(&scale) {
            *x *= s * other;
        }
    }
    let factor = Factor::of(&scaled, d).map_err(MapError::Prior)?;
    let of = parts(prior, continues);
    let of_joint = |joint: usize| {
        let offset = prior.place(joint, P::Offset);
        let row = &after.covariance[offset * d..(offset + 1) * d];
        let mut r: Vec<f64> = row.iter().zip(&scale).map(|(p, s)| p * s).collect();
        factor.solve(&mut r);
        r.iter_mut().zip(&scale).for_each(|(r, s)| *r *= s);
        // An average over what may have changed is wider than a linear estimate: no part exceeds the whole.
        let most = row[offset].max(0.0);
        let part = |which: Of| {
            let own = r
                .iter()
                .zip(&of)
                .map(|(r, of)| if *of == which { *r } else { 0.0 });
            let own: Vec<f64> = own.collect();
            let lines = baseline.covariance.chunks_exact(d.max(1));
            let variance: f64 = (own.iter().zip(lines))
                .filter(|(r, _)| **r != 0.0)
                .map(|(x, line)| x * dot(line, &own))
                .sum();
            libm::sqrt(variance.clamp(0.0, most))
        };
        SharedError {
            baseline_rad: part(Of::Baseline),
            drift_rad: part(Of::Temperature),
        }
    };
    let joints = (0..prior.joints()).map(|i| match prior.is_elastic(i) {
        true => of_joint(i),
        false => SharedError::default(),
    });
    Ok(joints.collect())
}

/// Origin of a state entry's error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    /// Common to all sessions since the baseline.
    Baseline,
    /// Common to all sessions of a baseline, and proportional to the temperature change.
    Temperature,
    /// Independent in each session.
    Session,
}

/// Returns the origin of every state entry's error.
fn parts(prior: &Prior, continues: bool) -> Vec<Of> {
    let recording_part = if continues { Of::Baseline } else { Of::Session };
    let mut out = alloc::vec![Of::Baseline; prior.dimension()];
    for i in 0..prior.joints() {
        for p in [P::Drift, P::Thermal] {
            out[prior.place(i, p)] = Of::Temperature;
        }
        for p in [P::Offset, P::Slack, P::InitialFriction] {
            out[prior.place(i, p)] = recording_part;
        }
    }
    out[prior.payload_place()..].fill(recording_part);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky;
    use crate::offset::fixtures::{random, turntable};
    use crate::offset::state_estimate::{Payload, UNKNOWN_OFFSET_RAD};
    use crate::offset::state_estimates;

    /// Returns the posterior after measurements `y = a x + noise` of a difference, and the matrix `I − K A`, in
    /// information form.
    fn measured(
        state_estimate: &StateEstimate,
        rows: &[Vec<f64>],
        noise: &[f64],
    ) -> (StateEstimate, Vec<f64>) {
        let d = state_estimate.mean.len();
        let before = cholesky::inverse(&state_estimate.covariance, d).unwrap();
        let mut information = before.clone();
        for (row, s) in rows.iter().zip(noise) {
            for i in 0..d {
                for k in 0..d {
                    information[i * d + k] += row[i] * row[k] / (s * s);
                }
            }
        }
        let covariance = cholesky::inverse(&information, d).unwrap();
        // I − K A with K = P Aᵀ R⁻¹.
        let mut left = alloc::vec![0.0; d * d];
        for i in 0..d {
            left[i * d + i] = 1.0;
            for (row, s) in rows.iter().zip(noise) {
                let gain = dot(&covariance[i * d..(i + 1) * d], row) / (s * s);
                for k in 0..d {
                    left[i * d + k] -= gain * row[k];
                }
            }
        }
        let after = StateEstimate {
            covariance,
            ..state_estimate.clone()
        };
        (after, left)
    }

    #[test]
    fn systematic_error_equals_gain_formula() {
        let prior = turntable().prior;
        let d = prior.dimension();
        let mut seed = 5;
        let mut readings = |state_estimate: &StateEstimate, n: usize| {
            let mut rows = Vec::new();
            for _ in 0..n {
                // In units of the prior standard deviation, so that every entry contributes.
                let row = (0..d).map(|k| random(&mut seed) / state_estimate.entry(k).std);
                rows.push(row.collect::<Vec<f64>>());
            }
            let noise: Vec<f64> = (0..n).map(|_| 0.6 + 0.3 * random(&mut seed)).collect();
            measured(state_estimate, &rows, &noise)
        };
        let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        let (baseline, _) = readings(&fresh, 40);
        let mut before = baseline.clone();
        state_estimates::age(&prior, &mut before);
        prior.reset_offsets(&mut before, UNKNOWN_OFFSET_RAD);
        prior.reset_payload(&mut before, Payload::Unknown);
        for n in [1, 12, 200] {
            let (after, left) = readings(&before, n);
            let found = shared_errors(&prior, &baseline, &before, &after, false).unwrap()[0];
            let offset = prior.place(0, P::Offset);
            let own = &left[offset * d..(offset + 1) * d];
            let recording_part =
                [P::Offset, P::Slack, P::InitialFriction].map(|p| prior.place(0, p));
            let warm = [P::Drift, P::Thermal].map(|p| prior.place(0, p));
            let is_reset = |k: usize| recording_part.contains(&k) || k >= prior.payload_place();
            let std = |which: &dyn Fn(usize) -> bool| {
                let mut variance = 0.0;
                for i in (0..d).filter(|&i| which(i)) {
                    for k in (0..d).filter(|&k| which(k)) {
                        variance += own[i] * baseline.covariance[i * d + k] * own[k];
                    }
                }
                libm::sqrt(variance)
            };
            // Rounding of inverses of matrices whose entries have relative errors of 1e-4.
            let close = |found: f64, expected: f64| {
                assert!(
                    (found / expected - 1.0).abs() < 1e-6,
                    "{n}: {found} {expected}"
                );
            };
            let baseline_rad = std(&|k| !is_reset(k) && !warm.contains(&k));
            close(found.baseline_rad, baseline_rad);
            close(found.drift_rad, std(&|k| warm.contains(&k)));
            assert!(found.baseline_rad < after.entry(offset).std);
        }
    }

    #[test]
    fn uninformative_session_has_no_systematic_error() {
        let prior = turntable().prior;
        let fresh = prior.state_estimate(Payload::Unknown, UNKNOWN_OFFSET_RAD);
        let apart = shared_errors(&prior, &fresh, &fresh, &fresh, false).unwrap()[0];
        assert_eq!(apart.baseline_rad, 0.0);
        let goes_on = shared_errors(&prior, &fresh, &fresh, &fresh, true).unwrap()[0];
        assert!((goes_on.baseline_rad / UNKNOWN_OFFSET_RAD - 1.0).abs() < 1e-12);
    }
}
