//! `sinew-model` in a program without the standard library: proof that it needs no standard library, and that its steps
//! cannot panic.
//!
//! The functions `sinew_*` below are the only exports. If a panic (or an allocation) can be reached from them, the
//! linked object refers to [`sinew_panicked`] (or [`sinew_allocated`]), which are undefined; `.ci/no_std` looks for
//! these names.

#![no_std]

extern crate alloc;

use core::alloc::{GlobalAlloc, Layout};
use sinew_model::arm::{Arm, ArmWorkspace};
use sinew_model::correction::{ContactDetector, ExternalTorqueObserver, JointCorrection, SetPoint};
use sinew_model::feeder::{Feeder, RobotSample};
use sinew_model::observer::MomentumObserver;
use sinew_model::offset::{FeatureObserver, OffsetObserver, Sample};
use sinew_model::tendons::{Coupling, CouplingState, Input, Output};
use sinew_model::wire::BlockSender;

unsafe extern "C" {
    /// Defined nowhere: a program in which a panic can be reached does not link.
    fn sinew_panicked() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: never defined, so never called.
    unsafe { sinew_panicked() }
}

/// Allocator without memory: a step must not allocate.
struct NoMemory;

unsafe extern "C" {
    /// Defined nowhere: a program in which an allocation can be reached does not link.
    fn sinew_allocated() -> *mut u8;
}

// SAFETY: never hands out memory; `sinew_allocated` is never defined, so never called.
unsafe impl GlobalAlloc for NoMemory {
    unsafe fn alloc(&self, _: Layout) -> *mut u8 {
        // SAFETY: as above.
        unsafe { sinew_allocated() }
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {
        // SAFETY: as above.
        unsafe { sinew_allocated() };
    }
}

#[global_allocator]
static ALLOCATOR: NoMemory = NoMemory;

/// Momentum pass and observer step on arm, workspace and observer that exist already.
///
/// Returns 0 if the step was accepted. Slices are passed as pointer and length of any size: wrong lengths and NaN must
/// be rejected without a panic too.
///
/// # Safety
/// Pointers are valid for the specified lengths, and no other reference to their memory exists.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_step(
    arm: &Arm,
    ws: &mut ArmWorkspace,
    observer: &mut MomentumObserver,
    dt_s: f64,
    q: *const f64,
    q_len: usize,
    dq: *const f64,
    dq_len: usize,
    alpha: *mut f64,
    alpha_len: usize,
) -> i32 {
    // SAFETY: the caller's promise.
    let (q, dq, alpha) = unsafe {
        (
            core::slice::from_raw_parts(q, q_len),
            core::slice::from_raw_parts(dq, dq_len),
            core::slice::from_raw_parts_mut(alpha, alpha_len),
        )
    };
    let Ok(terms) = arm.momentum(ws, q, dq) else {
        return 1;
    };
    for (alpha, (c, g)) in alpha.iter_mut().zip(terms.ct_dq.iter().zip(terms.g)) {
        *alpha = c - g;
    }
    match observer.step(dt_s, terms.p, alpha, None) {
        Ok(()) => 0,
        Err(_) => 2,
    }
}

/// Full offset step, as [`sinew_step`].
///
/// # Safety
/// As [`sinew_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offset_step(
    offset: &mut OffsetObserver,
    dt_s: f64,
    sample: &Sample<'_>,
) -> i32 {
    i32::from(offset.step(dt_s, sample).is_err())
}

/// Step of the absolute offset's features, as [`sinew_step`]. `x` holds `q`, `theta` and the motor torque, of any lengths.
///
/// # Safety
/// As [`sinew_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_features_step(
    features: &mut FeatureObserver,
    dt_s: f64,
    x: &[&[f64]; 3],
    temperature_c: f64,
) -> i32 {
    let [q, theta, torque] = x;
    i32::from((features.step(dt_s, q, theta, torque, temperature_c)).is_err())
}

/// Performs the steps of a microcontroller for one sample: both observers, and the encoding of a block, as
/// [`sinew_step`].
///
/// # Safety
/// The conditions of [`sinew_step`] apply.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_chip_step(
    offset: &mut Feeder<OffsetObserver>,
    features: &mut Feeder<FeatureObserver>,
    sender: &mut BlockSender,
    reading: &RobotSample<'_>,
    taken_by_line: usize,
) -> i32 {
    let offset_taken = offset.take(reading).output().is_some();
    sender.sent(taken_by_line.min(sender.pending().len()));
    let complete = features.take(reading).output();
    let put = complete == Some(true) && sender.put(features.observer().block()) == Ok(true);
    i32::from(offset_taken) + 2 * i32::from(put)
}

/// Set-points at rest and in motion, and a changed offset, as [`sinew_step`]. `x` holds `q_d`,
/// `dq_d` and `ddq_d`, of any lengths.
///
/// # Safety
/// As [`sinew_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_set_point(
    set_point: &mut SetPoint,
    joint: usize,
    correction: &JointCorrection,
    x: &[&[f64]; 3],
) -> i32 {
    let changed = set_point.set(joint, correction).is_ok();
    let held = set_point.hold(x[0], Some(x[1])).is_ok();
    let followed = set_point.follow(x[0], x[1], x[2], None).is_ok();
    i32::from(changed) + i32::from(held) + i32::from(followed)
}

/// External torque, its threshold and the contact it means, as [`sinew_step`]. `x` holds `q`,
/// `theta_measured` and `dq`, of any lengths.
///
/// # Safety
/// As [`sinew_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_contact_step(
    observer: &mut ExternalTorqueObserver,
    detector: &mut ContactDetector,
    dt_s: f64,
    joint: usize,
    correction: &JointCorrection,
    x: &[&[f64]; 3],
) -> i32 {
    let changed = observer.set(joint, correction).is_ok();
    if observer.step(dt_s, x[0], x[1], Some(x[2])).is_err() {
        return -1;
    }
    match detector.step(dt_s, observer.tau_ext(), observer.threshold()) {
        Ok(touching) => i32::from(changed) + 2 * i32::from(touching),
        Err(_) => -2,
    }
}

/// Tensions and torques of coupled tendons, a Jacobian and the joint stiffness, as [`sinew_step`]. `x` holds `theta`, `q` and
/// `delta`, of any lengths.
///
/// # Safety
/// As [`sinew_step`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_tendon_step(
    coupling: &Coupling,
    state: &mut CouplingState,
    x: &[&[f64]; 3],
    derivatives: &mut [&mut [f64]; 2],
) -> i32 {
    if coupling.evaluate(state, x[0], x[1], x[2]).is_err() {
        return -1;
    }
    let [jacobian, stiffness] = derivatives;
    let (output, input) = (Output::MotorTorque, Input::Elongation);
    let differentiated = coupling.jacobian(state, output, input, jacobian).is_ok();
    let stiffened = coupling.joint_stiffness(state, stiffness).is_ok();
    let outside = coupling.extrapolated(x[1]).next().is_some();
    i32::from(differentiated) + 2 * i32::from(stiffened) + 4 * i32::from(outside)
}
