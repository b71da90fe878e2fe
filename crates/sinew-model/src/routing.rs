//! Routing of a tendon that crosses several joints.

use crate::friction::Friction;
use crate::moment_arm::{JointSpring, MomentArm, TendonKind};
use alloc::string::String;
use alloc::vec::Vec;

/// Routing of a tendon in the coordinate of a joint: that which it is paired with, or the main one that it crosses.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Routing {
    /// Name of the tendon.
    pub tendon: String,
    /// Index of the joint in whose rad the coordinate is.
    pub joint: usize,
    /// Name of its motor.
    pub motor: String,
    /// Ratio of the position in the tendon's coordinate to the position of the motor shaft; not 0.
    pub drive_ratio: f64,
    /// `rho_ij`, `n`: change of the coordinate per rad of every joint; ±1 at the joint of the coordinate. Moment arms
    /// that
    /// vary with the position have their values at `q = 0`.
    pub moment_arms: Vec<f64>,
    /// `B_ij`, `n`: torque in the tendon's coordinate per N·m of elastic torque at every joint; empty where the group has one equation per joint.
    pub torque_shares: Vec<f64>,
    /// Pull of the tendon, where the group has one equation per joint; `None`: the group has one equation per tendon.
    pub pull: Option<Pull>,
}

/// Pull of a tendon whose group has one equation per joint, in the coordinate of its main joint.
///
/// ```text
/// f = K y (loop),   f = max(0, f0 + K y) (strand),   Σ_i rho_ij f_i = tau_el_j
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Pull {
    /// Way in which the tendon pulls.
    pub kind: TendonKind,
    /// Tension `f0` of a strand at `theta = 0`, `q = 0` and `delta = 0`, N·m; 0 of a loop.
    pub pretension_nm: f64,
    /// Torque in the coordinate per newton of tension, m; `None` where no radius is specified.
    pub metres_per_rad: Option<f64>,
    /// Elastic joints that the tendon crosses.
    pub joints: Vec<PulledJoint>,
}

/// Joint that a tendon crosses, with all tendons and springs that act on it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct PulledJoint {
    /// Index of the joint.
    pub joint: usize,
    /// Moment arm of the tendon, rad of its coordinate per rad of the joint.
    pub arm: MomentArm,
    /// Friction of the joint.
    pub friction: Friction,
    /// Passive spring of the joint, if it has one.
    pub spring: Option<JointSpring>,
}

impl Routing {
    /// Motor position reflected to its joint, without the contribution of other joints: `drive_ratio · theta_motor −
    /// Σ_j rho_ij q_j + q_i`, rad.
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
        let varying = self.pull.iter().flat_map(Pull::varying);
        moved_by_others(&self.moment_arms, varying, joint, q.iter().copied())
    }
}

impl Pull {
    /// Joints at which the moment arm varies, with the shortenings that they cause.
    pub(crate) fn varying(&self) -> impl Iterator<Item = (usize, &MomentArm)> {
        let varying = |pulled: &&PulledJoint| matches!(pulled.arm, MomentArm::Table(_));
        let joints = self.joints.iter().filter(varying);
        joints.map(|pulled| (pulled.joint, &pulled.arm))
    }
}

/// Change of the coordinate of a tendon with the joints other than its own, `l(q) − q_i`, rad.
///
/// * `varying`: joints at which the moment arm varies.
#[inline]
pub(crate) fn moved_by_others<'a>(
    moment_arms: &[f64],
    varying: impl Iterator<Item = (usize, &'a MomentArm)>,
    joint: usize,
    q: impl Iterator<Item = f64> + Clone,
) -> f64 {
    let rows = moment_arms.iter().zip(q.clone()).enumerate();
    let moved = rows.fold(0.0, |sum, (j, (arm, q))| {
        sum + if j == joint { arm - 1.0 } else { *arm } * q
    });
    varying.fold(moved, |sum, (j, arm)| {
        let q = q.clone().nth(j).unwrap_or(0.0);
        let [shortening, ..] = arm.evaluate(q);
        sum + shortening - moment_arms.get(j).copied().unwrap_or(0.0) * q
    })
}
