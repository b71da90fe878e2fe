//! How late the motor side is stamped against the joint side.

use super::belief::Belief;
use super::effects::JointParameter;
use super::prior::Prior;
use crate::Gaussian;
use crate::cholesky::{self, dot};
use alloc::vec::Vec;

/// What friction that is neither Coulomb's nor viscous adds to a lag, s: sides that are in step read −0.6 to −1.0 ms on
/// the simulated arm of S5, whose friction also has presliding.
const OTHER_FRICTION_S: f64 = 0.5e-3;

/// How much later the motor side is stamped against the joint side than was believed before, s.
///
/// A lag `T` shows as `−K T` of viscous friction at every joint. Let the recording alone say `m`, with the covariance
/// `C`, of the changes of the joints' viscous frictions, and their own friction be known to `S = diag(s²)`:
///
/// ```text
/// C⁻¹ = C_after⁻¹ − C_before⁻¹,    m = C (C_after⁻¹ m_after − C_before⁻¹ m_before) − m_before
/// W = (S + C)⁻¹,                   a = W K / KᵀW K,       T = −aᵀm
/// σ_T² = aᵀC a + (Σ |aᵢ| sᵢ)² + (0.5 ms)²
/// ```
///
/// The second term takes the frictions as wrong all in one direction: one guess, or one grease, stands behind them. The
/// third is for what is in friction beside them.
/// `opened_s` is what [`Prior::open_lag`] opened `before` by. `None` when the recording says nothing of friction.
/// Source: generalised least squares; allocates.
pub fn lag_s(prior: &Prior, before: &Belief, after: &Belief, opened_s: f64) -> Option<Gaussian> {
    let elastic = (0..prior.joints()).filter(|&i| prior.is_elastic(i));
    let joints: Vec<usize> = elastic.collect();
    let n = joints.len();
    let place = |i: usize| prior.place(i, JointParameter::Viscous);
    let part = |belief: &Belief| {
        let d = prior.dimension();
        let rows = joints.iter().map(|&i| place(i) * d);
        let cells = rows.flat_map(|row| joints.iter().map(move |&k| row + place(k)));
        let covariance: Vec<f64> = cells.map(|at| belief.covariance[at]).collect();
        let mean: Vec<f64> = joints.iter().map(|&i| belief.mean[place(i)]).collect();
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
            let (believed, lag) = (before.entry(place(i)).deviation, opened_s * k);
            libm::sqrt((believed * believed - lag * lag).max(0.0))
        })
        .collect();
    let told = spread.clone();
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
    let scatter = dot(&shares, &times(&told, &shares));
    let deviation = libm::sqrt(scatter + together * together + OTHER_FRICTION_S * OTHER_FRICTION_S);
    Some(Gaussian::new(-dot(&shares, &change), deviation))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::turntable;
    use crate::offset::{Payload, UNKNOWN_OFFSET_RAD};

    /// One joint of 40 N·m/rad, 5 ms late, its friction told to 0.02 N·m·s/rad: by hand.
    #[test]
    fn a_lag_is_read_from_friction_as_large_as_it_is() {
        let model = turntable();
        let prior = &model.prior;
        let place = prior.place(0, JointParameter::Viscous);
        let d = prior.dimension();
        for opened_s in [0.0, 0.002] {
            let mut before = prior.belief(Payload::Empty, UNKNOWN_OFFSET_RAD);
            prior.open_lag(&mut before, opened_s);
            let believed = before.entry(place);
            let (told, deviation) = (believed.mean - 40.0 * 0.005, 0.02);
            let variance = believed.deviation * believed.deviation;
            let gain = variance / (variance + deviation * deviation);
            let mut after = before.clone();
            after.mean[place] += gain * (told - believed.mean);
            after.covariance[place * d + place] *= 1.0 - gain;
            let late = lag_s(prior, &before, &after, opened_s).unwrap();
            assert!((late.mean - 0.005).abs() < 1e-9, "{late:?}");
            // 2 mrad of 40 N·m/rad at a guess, 0.6 of it per rad/s.
            let told = libm::hypot(0.048, deviation) / 40.0;
            let expected = libm::hypot(told, OTHER_FRICTION_S);
            assert!(
                (late.deviation - expected).abs() < 1e-9,
                "{late:?}, {expected}"
            );
            assert_eq!(
                lag_s(prior, &before, &before, opened_s),
                None,
                "nothing learned"
            );
        }
    }
}
