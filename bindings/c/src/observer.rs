//! The paper's observer: elastic torque and offset of every joint, sample by sample.

use crate::borrow::{array, explained, fill, give, guarded, shared, take, unique};
use crate::robot::SinewRobot;
use crate::status::Status;
use sinew_model::offset::{OffsetConfig, OffsetObserver, Sample, VelocityFilter};
use std::ffi::c_char;

/// The observer of a robot. One thread at a time.
pub struct SinewObserver(OffsetObserver);

/// Makes an observer: gain `K_I`, 1/s (20 serves most encoders), and the cut-off of the velocity filter, rad/s (40). Free it
/// with `sinew_observer_free`; the robot may be freed before.
///
/// Realtime: no, it allocates: all memory that is ever needed.
///
/// # Safety
/// `robot` is a robot; `out` may be written; `why` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_new(
    robot: *const SinewRobot,
    gain_per_s: f64,
    cutoff_rad_per_s: f64,
    out: *mut *mut SinewObserver,
    why: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    unsafe {
        explained(why, why_len, || {
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

/// Frees an observer; null is nothing.
///
/// Realtime: no.
///
/// # Safety
/// `observer` is null or was made here and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_free(observer: *mut SinewObserver) {
    // SAFETY: the caller's promise.
    unsafe { take(observer) }
}

/// Steps by `dt_s` to a sample; the first one only starts the filters and doesn't look at `dt_s`.
///
/// `q_rad`, `theta_rad`: `joints` each. `tau_ext_nm`: the known external torque, or null. A sample that is refused changes
/// nothing.
///
/// Realtime: yes. No allocation, lock, log or clock.
///
/// # Safety
/// `observer` is used by nobody else meanwhile; arrays have `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_step(
    observer: *mut SinewObserver,
    dt_s: f64,
    q_rad: *const f64,
    theta_rad: *const f64,
    tau_ext_nm: *const f64,
    joints: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
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

/// The next sample is a start: after a gap.
///
/// Realtime: yes.
///
/// # Safety
/// `observer` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_reset(observer: *mut SinewObserver) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        unique(observer)?.0.reset();
        Ok(())
    })
}

/// Offset `(theta_measured − q) − tau_el / K` of every joint, rad; NaN of a rigid one.
///
/// Realtime: yes.
///
/// # Safety
/// `observer` is an observer; `delta_e_rad` has room for `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_delta_e(
    observer: *const SinewObserver,
    delta_e_rad: *mut f64,
    joints: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe { filled(shared(observer)?.0.delta_e(), delta_e_rad, joints) })
}

/// Elastic torque of every joint, N·m.
///
/// Realtime: yes.
///
/// # Safety
/// `observer` is an observer; `tau_el_nm` has room for `joints` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_tau_el(
    observer: *const SinewObserver,
    tau_el_nm: *mut f64,
    joints: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe { filled(shared(observer)?.0.tau_el(), tau_el_nm, joints) })
}

/// Whether the start has faded to a thousandth; false of null.
///
/// Realtime: yes.
///
/// # Safety
/// `observer` is null or an observer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_observer_is_settled(observer: *const SinewObserver) -> bool {
    // SAFETY: the caller's promise.
    unsafe { shared(observer) }.is_ok_and(|observer| observer.0.is_settled())
}

/// Copies all values, if there are as many.
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
