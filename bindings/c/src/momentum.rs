//! Momentum terms of an arm.

use crate::borrow::{CallError, array, explained, fill, give, guarded, shared, take, unique};
use crate::robot::SinewRobot;
use crate::status::Status;
use sinew_model::arm::{Arm, ArmWorkspace};
use std::ffi::c_char;

/// Arm with the workspace of the momentum terms. Not thread-safe: one thread at a time.
pub struct SinewArm {
    arm: Arm,
    workspace: ArmWorkspace,
}

/// Creates an arm with its workspace. Free it with `sinew_arm_free`; the robot may be freed before.
///
/// Realtime: no, it allocates.
///
/// Threads: any number at once.
///
/// # Safety
/// `robot` is a robot; `out` may be written; `reason` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_arm_new(
    robot: *const SinewRobot,
    out: *mut *mut SinewArm,
    reason: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    unsafe {
        explained(reason, why_len, || {
            give(out, || {
                let arm = shared(robot)?.robot.arm.clone();
                let workspace = ArmWorkspace::new(&arm);
                Ok::<_, CallError>(SinewArm { arm, workspace })
            })
        })
    }
}

/// Frees an arm; null has no effect.
///
/// Realtime: no.
///
/// Threads: no other call uses the handle.
///
/// # Safety
/// `arm` is null or was created by `sinew_arm_new` and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_arm_free(arm: *mut SinewArm) {
    // SAFETY: guaranteed by the caller.
    unsafe { take(arm) }
}

/// Computes the momentum terms `p = M(q) dq`, `C(q, dq)ᵀ dq` and `g(q)`, `joints` each.
///
/// Realtime: yes. One pass over the joints.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `arm` is not used concurrently; arrays have `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_arm_momentum(
    arm: *mut SinewArm,
    q_rad: *const f64,
    dq_rad_s: *const f64,
    p: *mut f64,
    ct_dq: *mut f64,
    g: *mut f64,
    joints: usize,
) -> Status {
    // SAFETY: guaranteed by the caller; as many results as joints.
    guarded(|| unsafe {
        let SinewArm { arm, workspace } = unique(arm)?;
        let (q, dq) = (array(q_rad, joints)?, array(dq_rad_s, joints)?);
        let terms = arm.momentum(workspace, q, dq)?;
        fill(p, terms.p)?;
        fill(ct_dq, terms.ct_dq)?;
        fill(g, terms.g)
    })
}
