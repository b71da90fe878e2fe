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
