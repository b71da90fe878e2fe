//! Maximum loads of an arm on its joints.

use sinew_model::arm::urdf::JointLimits;
use sinew_model::arm::{Arm, ArmWorkspace, JointKind};
use std::f64::consts::PI;

/// Number of evaluated poses, sufficient to approach the maximum torque of every joint.
const POSES: usize = 256;

/// Maximum load of an arm on a joint over its poses; in N and kg for a prismatic joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Load {
    /// Maximum gravity torque, N·m.
    pub(crate) gravity_nm: f64,
    /// Maximum inertia about the joint axis, `M_ii`, kg·m².
    pub(crate) inertia_kg_m2: f64,
}

/// Computes the loads of all joints over poses within their limits, distributed evenly by the golden-ratio sequence
/// (Roberts' R_d).
pub(crate) fn loads(arm: &Arm, limits: &[JointLimits]) -> Vec<Load> {
    let n = arm.dof();
    let mut out = vec![Load::default(); n];
    let mut ws = ArmWorkspace::new(arm);
    let steps = steps(n);
    let (mut q, still) = (vec![0.0; n], vec![0.0; n]);
    for pose in 0..POSES {
        for (i, q) in q.iter_mut().enumerate() {
            let (low, high) = range(arm, limits, i);
            let at = (0.5 + steps[i] * pose as f64).fract();
            *q = low + at * (high - low);
        }
        if let Ok(g) = arm.bias_torque(&mut ws, &q, &still) {
            for (load, g) in out.iter_mut().zip(g) {
                load.gravity_nm = load.gravity_nm.max(g.abs());
            }
        }
        if let Ok(m) = arm.mass_matrix(&mut ws, &q) {
            for (i, load) in out.iter_mut().enumerate() {
                load.inertia_kg_m2 = load.inertia_kg_m2.max(m[i * n + i]);
            }
        }
    }
    out
}

/// Returns the evaluated range: that of the joint, or one revolution if it is unlimited.
fn range(arm: &Arm, limits: &[JointLimits], i: usize) -> (f64, f64) {
    let JointLimits { lower, upper, .. } = limits[i];
    let is_specified = lower.is_finite() && upper.is_finite() && upper > lower;
    match (is_specified, arm.joint_kind(i)) {
        (true, _) => (lower, upper),
        (false, Some(JointKind::Prismatic)) => (0.0, 0.0),
        (false, _) => (-PI, PI),
    }
}

/// Returns the powers of `1/φ_d`, where `φ_d^(d+1) = φ_d + 1`.
fn steps(n: usize) -> Vec<f64> {
    let mut phi = 2.0_f64;
    for _ in 0..32 {
        phi = libm::pow(1.0 + phi, 1.0 / (n as f64 + 1.0));
    }
    (1..=n).map(|i| libm::pow(1.0 / phi, i as f64)).collect()
}
