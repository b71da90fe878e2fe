//! What fits nothing: a model error, which no number of samples averages away.

use super::belief::Belief;
use super::effects::JointParameter;
use super::prior::Prior;

/// More than this left unexplained is a wrong model, rad: a joint's friction may stand either way, which is
/// `F_c/K`, some 2 mrad at a rope-driven joint, beside what encoders leave.
pub const UNDERSTOOD_RAD: f64 = 2e-3;

/// What the model gets wrong at a joint whose residuals have the robust deviation `noise_rad`, as a standard
/// deviation of its offset, rad: `√(noise² − understood²)`, 0 for what encoders and friction leave.
///
/// Noise averages out over blocks; an unknown that the model lacks does not, for it is the same in every
/// block of a pose.
///
/// # Realtime
/// No allocation, lock, panic or clock.
pub fn misfit_rad(noise_rad: f64) -> f64 {
    let excess = noise_rad * noise_rad - UNDERSTOOD_RAD * UNDERSTOOD_RAD;
    libm::sqrt(excess.max(0.0))
}

/// A belief as far as its recording was understood. `noise_rad`: of every joint, `n` for each part of the recording.
///
/// ```text
/// C = S½ C_after S½ + (1 − S)½ F C_before F (1 − S)½
/// ```
///
/// with `s` the share of residual variance that encoders and friction leave: for what is a joint's own the joint's,
/// for the masses, which all joints share, the worst joint's. A recording that fits nothing teaches nothing, so what
/// follows in a chain is no surer than before. But a joint that is understood keeps what it taught, whatever another's
/// residuals say. And a reading is off by no more than what fits nothing: `F` is 1 but for offset and zero, whose
/// variance in `F C_before F` is at most that after, and the misfit's.
pub fn tempered(prior: &Prior, before: &Belief, mut after: Belief, noise_rad: &[f64]) -> Belief {
    let (n, layout) = (prior.joints(), prior.layout());
    let d = layout.dimension();
    let alike = before.covariance.len() == d * d && after.covariance.len() == d * d;
    if n == 0 || !alike || noise_rad.iter().all(|noise| !(*noise > UNDERSTOOD_RAD)) {
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
            let [was, is] = [before, &after].map(|belief| belief.covariance[k * (d + 1)]);
            let most = is + misfit_rad(noise) * misfit_rad(noise);
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

    /// Every one of `d` parameters is known to the same variance.
    fn even(d: usize, variance: f64) -> Belief {
        Belief {
            mean: alloc::vec![0.0; d],
            covariance: (0..d * d)
                .map(|k| if k % (d + 1) == 0 { variance } else { 0.0 })
                .collect(),
            temperature_c: f64::NAN,
        }
    }

    #[test]
    fn sensors_alone_are_no_misfit_and_a_large_residual_is_almost_all_misfit() {
        assert_eq!(misfit_rad(1.9e-3), 0.0);
        assert_eq!(misfit_rad(f64::NAN), 0.0);
        assert!((misfit_rad(5e-3) - 4.582_576e-3).abs() < 1e-9);
    }

    /// Two joints, of which the second isn't understood.
    #[test]
    fn what_fits_nothing_teaches_nothing_and_takes_nothing_from_who_is_understood() {
        let prior = turntables(2, 0.1).prior;
        let layout = prior.layout();
        let d = layout.dimension();
        let belief = |variance| even(d, variance);
        let of = |noise_rad: &[f64], k: usize| {
            tempered(&prior, &belief(1.0), belief(0.01), noise_rad).covariance[k * (d + 1)]
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
    fn a_reading_is_off_by_no_more_than_what_fits_nothing() {
        let prior = turntables(1, 0.1).prior;
        let layout = prior.layout();
        let d = layout.dimension();
        let belief = |rad: f64| even(d, rad * rad);
        let zero = layout.place(0, JointParameter::Zero) * (d + 1);
        // Anywhere before: known to the misfit after.
        let open = tempered(&prior, &belief(30e-3), belief(0.1e-3), &[4e-3]).covariance[zero];
        let misfit = misfit_rad(4e-3);
        assert!(
            (open - (1e-8 + 0.75 * misfit * misfit)).abs() < 1e-12,
            "{open}"
        );
        // Known before: no surer than then.
        let held = tempered(&prior, &belief(1e-5), belief(0.9e-5), &[40e-3]).covariance[zero];
        assert!((held - 1e-10).abs() < 1e-12, "{held}");
    }

    /// The mean square of what is thought of any sum of parameters isn't below what it was after, and never negative.
    #[test]
    fn it_stays_a_covariance() {
        let prior = turntables(2, 0.1).prior;
        let d = prior.dimension();
        let mut seed = 5;
        let spread: Vec<f64> = (0..d * d).map(|_| random(&mut seed)).collect();
        let square = |scale: f64| Belief {
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
