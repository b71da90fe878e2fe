//! Components of the detection threshold of contacts.

use super::error::CorrectionError;
use alloc::vec::Vec;

/// Uncertainty of the external torque without contact: the basis of the detection threshold.
///
/// ```text
/// σ²        = (∂tau_el/∂x · σ_delta_e)² + (σ_K/K · tau_el)² + (σ_m · tau_model)² + σ_noise²
/// threshold = z σ + f F_c
/// ```
///
/// `σ_delta_e` and `σ_K` come with each joint's [`JointCorrection`](super::JointCorrection), `tau_model` is the torque
/// required by the observed motion, `F_c` the joint's Coulomb friction: while a joint is at rest, friction is anywhere
/// between `−F_c` and `F_c`, which is not a normal distribution. The four parts are assumed independent; σ_m as one
/// factor on all masses.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactTolerances {
    /// `z`: standard deviations from a false alarm.
    pub sigmas: f64,
    /// `σ_noise`, N·m, one per joint: standard deviation of the estimate without contact.
    pub noise_nm: Vec<f64>,
    /// `σ_m`: relative standard deviation of the masses.
    pub mass_std: f64,
    /// `f`: share of the Coulomb friction that counts as unknown.
    pub friction_share: f64,
}

impl ContactTolerances {
    /// Creates tolerances with 4 standard deviations, all of the Coulomb friction, exact masses, and this noise, N·m.
    pub fn new(noise_nm: Vec<f64>) -> Self {
        Self {
            sigmas: 4.0,
            noise_nm,
            mass_std: 0.0,
            friction_share: 1.0,
        }
    }

    pub(super) fn check(&self, n: usize) -> Result<(), CorrectionError> {
        if self.noise_nm.len() != n {
            return Err(CorrectionError::Length {
                expected: n,
                found: self.noise_nm.len(),
            });
        }
        let all = [
            ("number of standard deviations", self.sigmas),
            ("relative standard deviation of the masses", self.mass_std),
            ("unknown share of the friction", self.friction_share),
        ];
        let shared = all.iter().map(|&(what, value)| (what, 0, value));
        let noise = self.noise_nm.iter().enumerate();
        for (what, joint, value) in shared.chain(noise.map(|(i, v)| ("noise (N·m)", i, *v))) {
            if !(0.0..=1e6).contains(&value) {
                return Err(CorrectionError::Tolerance {
                    what,
                    joint,
                    value,
                    must: "between 0 and 1e6",
                });
            }
        }
        Ok(())
    }
}
