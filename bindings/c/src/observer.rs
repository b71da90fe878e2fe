//! Observer of the paper: elastic torque and offset of every joint, per sample.

use crate::borrow::{array, explained, fill, give, guarded, shared, take, unique};
use crate::robot::SinewRobot;
use crate::status::Status;
use sinew_model::offset::{OffsetConfig, OffsetObserver, Sample, VelocityFilter};
use std::ffi::c_char;

/// Observer of a robot. Not thread-safe: one thread at a time.
pub struct SinewObserver(OffsetObserver);

/// Creates an observer with gain `K_I`, 1/s (20 suits most encoders), and cut-off of the velocity filter, rad/s (40). Free
/// it with `sinew_observer_free`; the robot may be freed before.
///
/// Realtime: no, it allocates all memory of the observer.
///
/// Threads: any number at once.
///
/// # Safety
/// `robot` is a robot; `out` may be written; `reason` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_new(
    robot: *const SinewRobot,
    gain_per_s: f64,
    cutoff_rad_per_s: f64,
    out: *mut *mut SinewObserver,
    reason: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    unsafe {
        explained(reason, why_len, || {
            give(out, || {
                let robot = &shared(robot)?.robot;
                let config = OffsetConfig {
                    gain_per_s,
                    velocity: VelocityFilter::StateVariable { cutoff_rad_per_s },
                    ..OffsetConfig::default()
                };
                let observer = OffsetObserver::new(&robot.arm, &robot.transmissions, config)?;
                Ok(SinewObserver(observer))
            })
        })
    }
}

/// Frees an observer; null has no effect.
///
/// Realtime: no.
///
/// Threads: no other call uses the handle.
///
/// # Safety
/// `observer` is null or was created by `sinew_observer_new` and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_free(observer: *mut SinewObserver) {
    // SAFETY: guaranteed by the caller.
    unsafe { take(observer) }
}

/// Advances the observer by `dt_s` to a sample; the first sample initialises the filters and ignores `dt_s`.
///
/// `q_rad`, `theta_rad`: `joints` each. `tau_ext_nm`: measured external torque, or null. A rejected sample leaves the
/// observer unchanged.
///
/// Realtime: yes. No allocation, lock, log or clock.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `observer` is not used concurrently; arrays have `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_step(
    observer: *mut SinewObserver,
    dt_s: f64,
    q_rad: *const f64,
    theta_rad: *const f64,
    tau_ext_nm: *const f64,
    joints: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let sample = Sample {
            q: array(q_rad, joints)?,
            theta_measured: array(theta_rad, joints)?,
            tau_ext: array(tau_ext_nm, joints).ok(),
            ..Sample::default()
        };
        Ok(unique(observer)?.0.step(dt_s, &sample)?)
    })
}

/// Marks a gap: the next sample re-initialises the filters.
///
/// Realtime: yes.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `observer` is not used concurrently.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_reset(observer: *mut SinewObserver) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        unique(observer)?.0.reset();
        Ok(())
    })
}

/// Offset `(theta_measured − q) − tau_el / K` of every joint, rad; NaN for a rigid joint.
///
/// Realtime: yes.
///
/// Threads: reads may be concurrent with each other, not with a step or a reset.
///
/// # Safety
/// `observer` is an observer; `delta_e_rad` has room for `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_delta_e(
    observer: *const SinewObserver,
    delta_e_rad: *mut f64,
    joints: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe { filled(shared(observer)?.0.delta_e(), delta_e_rad, joints) })
}

/// Elastic torque of every joint, N·m.
///
/// Realtime: yes.
///
/// Threads: reads may be concurrent with each other, not with a step or a reset.
///
/// # Safety
/// `observer` is an observer; `tau_el_nm` has room for `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_tau_el(
    observer: *const SinewObserver,
    tau_el_nm: *mut f64,
    joints: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe { filled(shared(observer)?.0.tau_el(), tau_el_nm, joints) })
}

/// Whether the initial transient has decayed to a thousandth; false for null.
///
/// Realtime: yes.
///
/// Threads: reads may be concurrent with each other, not with a step or a reset.
///
/// # Safety
/// `observer` is null or an observer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_is_settled(observer: *const SinewObserver) -> bool {
    // SAFETY: guaranteed by the caller.
    unsafe { shared(observer) }.is_ok_and(|observer| observer.0.is_settled())
}

/// Copies all values if the lengths are equal.
///
/// # Safety
/// As [`fill`], for `joints` numbers.
unsafe fn filled(values: &[f64], into: *mut f64, joints: usize) -> Result<(), Status> {
    if values.len() != joints {
        return Err(Status::Length);
    }
    // SAFETY: as many as the caller has room for.
    unsafe { fill(into, values) }
}
