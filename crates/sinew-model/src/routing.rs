//! Routing of a tendon that crosses several joints.

use alloc::string::String;
use alloc::vec::Vec;

/// Routing of a tendon in the coordinate of the joint it is paired with.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Routing {
    /// Name of the tendon.
    pub tendon: String,
    /// Name of its motor.
    pub motor: String,
    /// Position in the tendon's coordinate over that at the motor's shaft; not 0.
    pub drive_ratio: f64,
    /// `rho_ij`, `n`: by how much the coordinate moves per rad of every joint; ±1 at the paired joint.
    pub moment_arms: Vec<f64>,
    /// `B_ij`, `n`: torque in the tendon's coordinate per N·m of elastic torque at every joint.
    pub torque_shares: Vec<f64>,
}

impl Routing {
    /// Position of the motor as its joint sees it, without what other joints move: `drive_ratio · theta_motor − Σ_j rho_ij q_j + q_i`, rad.
    ///
    /// * `joint`: index `i` of the joint that the tendon is paired with. `q`: joint positions, `n`, rad.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn reflected(&self, joint: usize, theta_motor: f64, q: &[f64]) -> f64 {
        self.drive_ratio * theta_motor - self.by_others(joint, q)
    }

    /// Position of the motor at its shaft, rad: the inverse of [`reflected`](Self::reflected).
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn at_motor(&self, joint: usize, theta_reflected: f64, q: &[f64]) -> f64 {
        (theta_reflected + self.by_others(joint, q)) / self.drive_ratio
    }

    /// Torque in the tendon's coordinate, `Σ_j B_ij tau_j`, N·m.
    ///
    /// * `tau_el`: elastic torques of the joints, `n`, N·m.
    ///
    /// # Realtime
    /// No allocation, lock, panic or clock.
    pub fn torque(&self, tau_el: &[f64]) -> f64 {
        let shares = self.torque_shares.iter().zip(tau_el);
        shares.fold(0.0, |sum, (share, torque)| sum + share * torque)
    }

    fn by_others(&self, joint: usize, q: &[f64]) -> f64 {
        moved_by_others(&self.moment_arms, joint, q.iter().copied())
    }
}

/// By how much the coordinate of a tendon moves with the joints beyond its own, `Σ_j rho_ij q_j − q_i`, rad.
#[inline]
pub(crate) fn moved_by_others(
    moment_arms: &[f64],
    joint: usize,
    q: impl Iterator<Item = f64>,
) -> f64 {
    let rows = moment_arms.iter().zip(q).enumerate();
    rows.fold(0.0, |sum, (j, (arm, q))| {
        sum + if j == joint { arm - 1.0 } else { *arm } * q
    })
}
