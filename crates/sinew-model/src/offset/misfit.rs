//! What fits nothing: a model error, which no number of samples averages away.

use super::belief::Belief;
use alloc::vec::Vec;

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

/// A belief as far as its recording was understood: with `s`, the share of the worst joint's
/// residual variance that encoders and friction leave, the covariance is `s C_after + (1 − s) C_before`.
///
/// A recording that fits nothing teaches nothing, so what follows in a chain is no surer than before.
pub fn tempered(before: &Belief, mut after: Belief, noise_rad: &[f64]) -> Belief {
    let worst = noise_rad.iter().fold(UNDERSTOOD_RAD, |a, b| a.max(*b));
    let understood = (UNDERSTOOD_RAD / worst) * (UNDERSTOOD_RAD / worst);
    if understood < 1.0 && before.covariance.len() == after.covariance.len() {
        let pairs = after.covariance.iter().zip(&before.covariance);
        let mixed = pairs.map(|(after, before)| understood * after + (1.0 - understood) * before);
        after.covariance = mixed.collect::<Vec<f64>>();
    }
    after
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensors_alone_are_no_misfit_and_a_large_residual_is_almost_all_misfit() {
        assert_eq!(misfit_rad(1.9e-3), 0.0);
        assert_eq!(misfit_rad(f64::NAN), 0.0);
        assert!((misfit_rad(5e-3) - 4.582_576e-3).abs() < 1e-9);
    }

    #[test]
    fn what_fits_nothing_teaches_nothing() {
        let belief = |variance: f64| Belief {
            mean: alloc::vec![0.0],
            covariance: alloc::vec![variance],
            temperature_c: f64::NAN,
        };
        let of = |noise: f64| tempered(&belief(1.0), belief(0.01), &[noise]).covariance[0];
        assert_eq!(of(1.5e-3), 0.01);
        assert!((of(4e-3) - (0.25 * 0.01 + 0.75)).abs() < 1e-15);
        assert!(of(20e-3) > 0.98);
    }
}
