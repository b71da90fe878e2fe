//! A robot from its texts.

use crate::borrow::{explained, give, guarded, put, shared, take, text};
use crate::status::Status;
use sinew_estimate::robot_dir;
use sinew_model::robot::{Robot, RobotFile};
use std::ffi::{CString, c_char};
use std::path::Path;

/// A robot: joints, masses, stiffness, tendons. Never changes; may be read from several threads.
pub struct SinewRobot {
    pub(crate) robot: Robot,
    /// Names of the joints as C reads them.
    names: Vec<CString>,
    /// Names of the tendons and motors of every joint.
    tendons: Vec<CString>,
    motors: Vec<CString>,
}

impl SinewRobot {
    fn of(robot: Robot) -> Self {
        // A name with a zero byte is no name in XML.
        let all = |names: &[String]| -> Vec<CString> {
            let names = names.iter().map(String::as_str);
            names
                .map(|name| CString::new(name).unwrap_or_default())
                .collect()
        };
        Self {
            names: all(robot.joint_names()),
            tendons: all(&robot.tendon_names()),
            motors: all(&robot.motor_names()),
            robot,
        }
    }
}

/// Makes a robot from the texts of `robot.toml` and of a URDF. Free it with `sinew_robot_free`.
///
/// `why` gets the sentence of a refusal, cut at `why_len` bytes; it may be null.
///
/// Realtime: no, it allocates.
///
/// # Safety
/// Texts end with a zero byte; `out` may be written; `why` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_new(
    robot_toml: *const c_char,
    urdf: *const c_char,
    out: *mut *mut SinewRobot,
    why: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    unsafe {
        explained(why, why_len, || {
            give(out, || {
                let file = RobotFile::parse(text(robot_toml)?, "robot.toml")?;
                Ok(SinewRobot::of(file.build(text(urdf)?)?))
            })
        })
    }
}

/// Makes a robot from its folder, or from the path of its `robot.toml`. Free it with `sinew_robot_free`.
///
/// Realtime: no, it reads files.
///
/// # Safety
/// As `sinew_robot_new`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_open(
    place: *const c_char,
    out: *mut *mut SinewRobot,
    why: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    unsafe {
        explained(why, why_len, || {
            give(out, || {
                let loaded = robot_dir::load(Path::new(text(place)?), None)?;
                Ok(SinewRobot::of(loaded.robot))
            })
        })
    }
}

/// Frees a robot; null is nothing. What was made from it goes on.
///
/// Realtime: no.
///
/// # Safety
/// `robot` is null or was made here and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_free(robot: *mut SinewRobot) {
    // SAFETY: the caller's promise.
    unsafe { take(robot) }
}

/// How many joints a robot has; 0 of null.
///
/// Realtime: yes.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_joints(robot: *const SinewRobot) -> usize {
    // SAFETY: the caller's promise.
    unsafe { shared(robot) }.map_or(0, |robot| robot.names.len())
}

/// Name of a joint, as long as the robot is there; null where there is none.
///
/// Realtime: yes.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_joint_name(
    robot: *const SinewRobot,
    joint: usize,
) -> *const c_char {
    // SAFETY: the caller's promise.
    let robot = unsafe { shared(robot) };
    let name = robot.ok().and_then(|robot| robot.names.get(joint));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Name of the tendon that a joint is paired with, as long as the robot is there: the joint's own, unless `robot.toml` has
/// `[[tendons]]`; null where there is no such joint.
///
/// Realtime: yes.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_tendon_name(
    robot: *const SinewRobot,
    joint: usize,
) -> *const c_char {
    // SAFETY: the caller's promise.
    let robot = unsafe { shared(robot) };
    let name = robot.ok().and_then(|robot| robot.tendons.get(joint));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Name of the motor of that tendon. Positions and torques of a motor with a name of its own are those at its shaft.
///
/// Realtime: yes.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_motor_name(
    robot: *const SinewRobot,
    joint: usize,
) -> *const c_char {
    // SAFETY: the caller's promise.
    let robot = unsafe { shared(robot) };
    let name = robot.ok().and_then(|robot| robot.motors.get(joint));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Index of a joint by its name.
///
/// Realtime: yes.
///
/// # Safety
/// `robot` is null or a robot; `name` ends with a zero byte; `out` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_joint_index(
    robot: *const SinewRobot,
    name: *const c_char,
    out: *mut usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let name = text(name)?;
        let index = shared(robot)?.robot.arm.joint_index(name);
        put(out, index.ok_or(Status::Length)?);
        Ok(())
    })
}

/// Elongation of a joint's tendon, m, for an offset, rad; NaN where there is no tendon.
///
/// Realtime: yes.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_elongation_m(
    robot: *const SinewRobot,
    joint: usize,
    offset_rad: f64,
) -> f64 {
    // SAFETY: the caller's promise.
    let robot = unsafe { shared(robot) };
    let transmission = robot
        .ok()
        .and_then(|r| r.robot.transmissions.get(joint)?.as_ref());
    let tendon = transmission.and_then(|t| t.tendon.as_ref());
    tendon.map_or(f64::NAN, |t| t.elongation_m(offset_rad))
}
