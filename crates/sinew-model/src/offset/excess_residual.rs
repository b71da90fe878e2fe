//! Excess residual: a model error, which no number of samples averages out.

use super::effects::JointParameter;
use super::prior::Prior;
use super::state_estimate::StateEstimate;

/// Maximum residual explained by encoders and friction, rad. A joint's friction may have either sign, which is
/// `F_c/K`, some 2 mrad at a rope-driven joint, in addition to the residual of the encoders.
pub const UNDERSTOOD_RAD: f64 = 2e-3;

/// Returns the model error at a joint whose residuals have the robust standard deviation `noise_rad`, as a standard
/// deviation of its offset, rad: `√(noise² − UNDERSTOOD_RAD²)`, 0 below the residual of encoders and friction.
///
/// Noise averages out over blocks; an unmodelled effect does not, because it is the same in every block of a pose.
///
/// # Realtime
/// No allocation, lock, panic or clock.
pub fn excess_residual_rad(noise_rad: f64) -> f64 {
    let excess = noise_rad * noise_rad - UNDERSTOOD_RAD * UNDERSTOOD_RAD;
    libm::sqrt(excess.max(0.0))
}

/// Returns a posterior that accounts for the excess residual of its recording. `noise_rad`: of every joint, `n` for
/// each part of the recording.
///
/// ```text
/// C = S½ C_after S½ + (1 − S)½ F C_before F (1 − S)½
/// ```
///
/// with `s` the share of the residual variance that encoders and friction explain: for the parameters of a joint that
/// of the joint, for the masses, which all joints share, that of the worst joint. A recording with unexplained
/// residuals provides no information, so that the next posterior of a chain is no narrower than the prior. A joint
/// without excess residual keeps its information, independent of the other joints. The error of an offset is at most
/// the excess residual: `F` is 1 except for offset and encoder zero, whose variance in `F C_before F` is at most that
/// after, plus the square of the excess residual.
pub fn tempered(
    prior: &Prior,
    before: &StateEstimate,
    mut after: StateEstimate,
    noise_rad: &[f64],
) -> StateEstimate {
    let (n, layout) = (prior.joints(), prior.layout());
    let d = layout.dimension();
    let is_complete = before.covariance.len() == d * d && after.covariance.len() == d * d;
    if n == 0 || !is_complete || noise_rad.iter().all(|noise| !(*noise > UNDERSTOOD_RAD)) {
        return after;
    }
    let of_joint = |joint: usize| {
        let parts = noise_rad.iter().skip(joint).step_by(n);
        parts.fold(UNDERSTOOD_RAD, |a, b| a.max(*b))
    };
    let understood = |noise: f64| (UNDERSTOOD_RAD / noise) * (UNDERSTOOD_RAD / noise);
    let worst = (0..n).map(of_joint).fold(UNDERSTOOD_RAD, f64::max);
    // By what C_after and C_before are multiplied on either side.
    let mut kept = alloc::vec![libm::sqrt(understood(worst)); d];
    let mut back = alloc::vec![libm::sqrt(1.0 - understood(worst)); d];
    for joint in 0..n {
        let noise = of_joint(joint);
        let share = understood(noise);
        for k in layout.own(joint) {
            kept[k] = libm::sqrt(share);
            back[k] = libm::sqrt(1.0 - share);
        }
        for parameter in [JointParameter::Offset, JointParameter::Zero] {
            let k = layout.place(joint, parameter);
            let [was, is] =
                [before, &after].map(|state_estimate| state_estimate.covariance[k * (d + 1)]);
            let most = is + excess_residual_rad(noise) * excess_residual_rad(noise);
            if was > most {
                back[k] *= libm::sqrt(most / was);
            }
        }
    }
    for (i, row) in after.covariance.chunks_exact_mut(d).enumerate() {
        for (j, to) in row.iter_mut().enumerate() {
            *to = kept[i] * kept[j] * *to + back[i] * back[j] * before.covariance[i * d + j];
        }
    }
    after
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::fixtures::{random, turntables};
    use alloc::vec::Vec;

    /// Every one of `d` parameters has the same variance.
    fn even(d: usize, variance: f64) -> StateEstimate {
        StateEstimate {
            mean: alloc::vec![0.0; d],
            covariance: (0..d * d)
                .map(|k| if k % (d + 1) == 0 { variance } else { 0.0 })
                .collect(),
            temperature_c: f64::NAN,
        }
    }

    #[test]
    fn excess_residual_zero_at_sensor_noise() {
        assert_eq!(excess_residual_rad(1.9e-3), 0.0);
        assert_eq!(excess_residual_rad(f64::NAN), 0.0);
        assert!((excess_residual_rad(5e-3) - 4.582_576e-3).abs() < 1e-9);
    }

    /// Two joints, of which the second has an excess residual.
    #[test]
    fn excess_residual_affects_only_its_joint() {
        let prior = turntables(2, 0.1).prior;
        let layout = prior.layout();
        let d = layout.dimension();
        let state_estimate = |variance| even(d, variance);
        let of = |noise_rad: &[f64], k: usize| {
            tempered(
                &prior,
                &state_estimate(1.0),
                state_estimate(0.01),
                noise_rad,
            )
            .covariance[k * (d + 1)]
        };
        let [first, second] = [0, 1].map(|joint| layout.place(joint, JointParameter::Compliance));
        let mass = layout.body_start();
        for k in [first, second, mass] {
            assert_eq!(of(&[1.5e-3, 1.9e-3], k), 0.01);
        }
        // The second part of the recording counts as much as the first.
        for noise_rad in [&[1e-3, 4e-3, 1e-3, 1e-3], &[1e-3, 1e-3, 1e-3, 4e-3]] {
            assert!((of(noise_rad, second) - (0.25 * 0.01 + 0.75)).abs() < 1e-15);
            assert!((of(noise_rad, mass) - (0.25 * 0.01 + 0.75)).abs() < 1e-15);
            assert_eq!(of(noise_rad, first), 0.01);
        }
        assert!(of(&[1e-3, 20e-3], second) > 0.98);
    }

    #[test]
    fn zero_error_bounded_by_excess_residual() {
        let prior = turntables(1, 0.1).prior;
        let layout = prior.layout();
        let d = layout.dimension();
        let state_estimate = |rad: f64| even(d, rad * rad);
        let zero = layout.place(0, JointParameter::Zero) * (d + 1);
        // The prior is wide: the variance is limited to the squared excess residual.
        let open = tempered(
            &prior,
            &state_estimate(30e-3),
            state_estimate(0.1e-3),
            &[4e-3],
        )
        .covariance[zero];
        let misfit = excess_residual_rad(4e-3);
        assert!(
            (open - (1e-8 + 0.75 * misfit * misfit)).abs() < 1e-12,
            "{open}"
        );
        // The prior is narrow: the result is not narrower.
        let held = tempered(
            &prior,
            &state_estimate(1e-5),
            state_estimate(0.9e-5),
            &[40e-3],
        )
        .covariance[zero];
        assert!((held - 1e-10).abs() < 1e-12, "{held}");
    }

    /// The variance of every sum of parameters is at least that of the posterior, and never negative.
    #[test]
    fn tempered_covariance_is_positive_definite() {
        let prior = turntables(2, 0.1).prior;
        let d = prior.dimension();
        let mut seed = 5;
        let spread: Vec<f64> = (0..d * d).map(|_| random(&mut seed)).collect();
        let square = |scale: f64| StateEstimate {
            mean: alloc::vec![0.0; d],
            covariance: (0..d * d)
                .map(|k| {
                    let (i, j) = (k / d, k % d);
                    let pairs = (0..d).map(|m| spread[i * d + m] * spread[j * d + m]);
                    scale * pairs.sum::<f64>()
                })
                .collect(),
            temperature_c: f64::NAN,
        };
        let mixed = tempered(&prior, &square(1.0), square(0.1), &[1e-3, 5e-3]);
        for _ in 0..20 {
            let sum: Vec<f64> = (0..d).map(|_| random(&mut seed)).collect();
            let rows = mixed.covariance.chunks_exact(d);
            let of_rows = rows.zip(&sum).map(|(row, x)| {
                let along: f64 = row.iter().zip(&sum).map(|(c, y)| c * y).sum();
                x * along
            });
            assert!(of_rows.sum::<f64>() > 0.0);
        }
    }
}
