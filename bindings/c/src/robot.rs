//! Robot description, created from its texts.

use crate::borrow::{explained, give, guarded, put, shared, take, text};
use crate::status::Status;
use sinew_estimate::robot_dir;
use sinew_model::robot::{Robot, RobotFile};
use std::ffi::{CString, c_char};
use std::path::Path;

/// Robot: joints, masses, stiffness, tendons. Immutable; may be read from several threads.
pub struct SinewRobot {
    pub(crate) robot: Robot,
    /// Zero-terminated names of the joints.
    names: Vec<CString>,
    /// Names of the tendons and motors of every joint.
    tendons: Vec<CString>,
    motors: Vec<CString>,
}

impl SinewRobot {
    fn of(robot: Robot) -> Self {
        // A zero byte is not allowed in XML.
        let all = |names: &[String]| -> Vec<CString> {
            let names = names.iter().map(String::as_str);
            names
                .map(|name| CString::new(name).unwrap_or_default())
                .collect()
        };
        let axes = (0..robot.axes()).map(|axis| robot.axis_name(axis).to_owned());
        let axes: Vec<String> = axes.collect();
        Self {
            names: all(&axes),
            tendons: all(&robot.tendon_names()),
            motors: all(&robot.motor_names()),
            robot,
        }
    }
}

/// Creates a robot from the texts of `robot.toml` and of a URDF. Free it with `sinew_robot_free`.
///
/// `reason` receives the error message, truncated to `why_len` bytes; it may be null.
///
/// Realtime: no, it allocates.
///
/// Threads: any number at once.
///
/// # Safety
/// Texts end with a zero byte; `out` may be written; `reason` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_new(
    robot_toml: *const c_char,
    urdf: *const c_char,
    out: *mut *mut SinewRobot,
    reason: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    unsafe {
        explained(reason, why_len, || {
            give(out, || {
                let file = RobotFile::parse(text(robot_toml)?, "robot.toml")?;
                Ok(SinewRobot::of(file.build(text(urdf)?)?))
            })
        })
    }
}

/// Creates a robot from its folder, or from the path of its `robot.toml`. Free it with `sinew_robot_free`.
///
/// Realtime: no, the function reads files.
///
/// Threads: any number at once.
///
/// # Safety
/// As `sinew_robot_new`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_open(
    place: *const c_char,
    out: *mut *mut SinewRobot,
    reason: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    unsafe {
        explained(reason, why_len, || {
            give(out, || {
                let loaded = robot_dir::load(Path::new(text(place)?), None)?;
                Ok(SinewRobot::of(loaded.robot))
            })
        })
    }
}

/// Frees a robot; null has no effect. Objects created from it remain valid.
///
/// Realtime: no.
///
/// Threads: no other call uses the handle.
///
/// # Safety
/// `robot` is null or was created here and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_free(robot: *mut SinewRobot) {
    // SAFETY: guaranteed by the caller.
    unsafe { take(robot) }
}

/// Number of joints of a robot plus its additional tendons, such as a second strand at a joint; 0 for null.
///
/// Arrays of samples and offsets have this number of entries. The joint position of an additional tendon is 0.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_joints(robot: *const SinewRobot) -> usize {
    // SAFETY: guaranteed by the caller.
    unsafe { shared(robot) }.map_or(0, |robot| robot.names.len())
}

/// Name of a joint, valid as long as the robot; null if there is no such joint.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_joint_name(
    robot: *const SinewRobot,
    joint: usize,
) -> *const c_char {
    // SAFETY: guaranteed by the caller.
    let robot = unsafe { shared(robot) };
    let name = robot.ok().and_then(|robot| robot.names.get(joint));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Name of the tendon of a joint, valid as long as the robot: the name of the joint, unless `robot.toml` has
/// `[[tendons]]`; null if there is no such joint.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_tendon_name(
    robot: *const SinewRobot,
    joint: usize,
) -> *const c_char {
    // SAFETY: guaranteed by the caller.
    let robot = unsafe { shared(robot) };
    let name = robot.ok().and_then(|robot| robot.tendons.get(joint));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Name of the motor of a joint's tendon. Positions and torques of a separately named motor refer to its shaft.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_motor_name(
    robot: *const SinewRobot,
    joint: usize,
) -> *const c_char {
    // SAFETY: guaranteed by the caller.
    let robot = unsafe { shared(robot) };
    let name = robot.ok().and_then(|robot| robot.motors.get(joint));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}

/// Finds the index of a joint by its name.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot; `name` ends with a zero byte; `out` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_joint_index(
    robot: *const SinewRobot,
    name: *const c_char,
    out: *mut usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let name = text(name)?;
        let index = shared(robot)?.robot.arm.joint_index(name);
        put(out, index.ok_or(Status::Length)?);
        Ok(())
    })
}

/// Whether a joint has a tendon or another elastic transmission; false for a rigid joint and for an invalid index.
///
/// A rigid joint has no offset, and its motor position is ignored.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_is_elastic(robot: *const SinewRobot, joint: usize) -> bool {
    // SAFETY: guaranteed by the caller.
    let robot = unsafe { shared(robot) };
    robot.is_ok_and(|r| {
        r.robot
            .transmissions
            .get(joint)
            .is_some_and(Option::is_some)
    })
}

/// Elongation of a joint's tendon, m, for an offset, rad; NaN if the joint has no tendon.
///
/// Realtime: yes.
///
/// Threads: any number at once, as long as the robot exists.
///
/// # Safety
/// `robot` is null or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_robot_elongation_m(
    robot: *const SinewRobot,
    joint: usize,
    offset_rad: f64,
) -> f64 {
    // SAFETY: guaranteed by the caller.
    let robot = unsafe { shared(robot) };
    let transmission = robot
        .ok()
        .and_then(|r| r.robot.transmissions.get(joint)?.as_ref());
    let tendon = transmission.and_then(|t| t.tendon.as_ref());
    tendon.map_or(f64::NAN, |t| t.elongation_m(offset_rad))
}
