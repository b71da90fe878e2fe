//! Absolute offsets since a baseline, sample by sample.

use crate::borrow::{
    Refusal, array, explained, give, guarded, optional, put, shared, take, text, unique,
};
use crate::robot::SinewRobot;
use crate::status::Status;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::feeder;
use sinew_estimate::live::{LiveOffsets, Stepped};
use sinew_estimate::session::{Payload, SessionError, SessionOptions, stated};
use std::ffi::c_char;

/// Offsets of a robot's tendons since a baseline. One thread at a time.
pub struct SinewOffsets(LiveOffsets);

/// What the gripper holds.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewPayload {
    /// Something unknown: it is estimated along.
    Unknown = 0,
    /// Nothing.
    Empty = 1,
    /// A stated mass.
    Stated = 2,
}

// Numbers, as C may hand over any.
const UNKNOWN: u32 = SinewPayload::Unknown as u32;
const EMPTY: u32 = SinewPayload::Empty as u32;
const STATED: u32 = SinewPayload::Stated as u32;

/// What is known of a session.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SinewOffsetsOptions {
    /// What the gripper holds: a `sinew_payload`.
    pub payload: u32,
    /// Its mass where it is stated, kg.
    pub payload_kg: f64,
    /// How well that is known, one standard deviation, kg; NaN: 2 %.
    pub payload_deviation_kg: f64,
    /// Temperature where samples don't carry it, °C; NaN: not stated.
    pub temperature_c: f64,
    /// How well that is known, one standard deviation, K; NaN: 2 K.
    pub temperature_deviation_k: f64,
    /// Whether a motor torque that samples carry is used.
    pub motor_torque: bool,
}

/// What became of a sample.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewStepped {
    /// It was taken.
    Taken = 0,
    /// It was taken as the first one: at the start, or after a pause.
    Restarted = 1,
    /// It was taken, and the offsets are new: some five times a second.
    Updated = 2,
    /// Refused: a joint position is missing or not finite.
    NoJointPosition = 3,
    /// Refused: an elastic joint's motor position is missing or not finite.
    NoMotorPosition = 4,
    /// Refused: its time is not after that of the last sample taken.
    NoTimeStep = 5,
    /// Refused: a value is too large to be one.
    OutOfRange = 6,
}

impl From<feeder::Refusal> for SinewStepped {
    fn from(why: feeder::Refusal) -> Self {
        match why {
            feeder::Refusal::JointPosition => Self::NoJointPosition,
            feeder::Refusal::MotorPosition => Self::NoMotorPosition,
            feeder::Refusal::TimeStep => Self::NoTimeStep,
            _ => Self::OutOfRange,
        }
    }
}

/// Nothing stated: an unknown payload, temperatures as samples carry them, motor torque used.
///
/// Realtime: yes.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_offsets_options_default() -> SinewOffsetsOptions {
    SinewOffsetsOptions {
        payload: SinewPayload::Unknown as u32,
        payload_kg: 0.0,
        payload_deviation_kg: f64::NAN,
        temperature_c: f64::NAN,
        temperature_deviation_k: f64::NAN,
        motor_torque: true,
    }
}

impl SinewOffsetsOptions {
    fn session(&self) -> Result<SessionOptions, Refusal> {
        let finite = |value: f64| Some(value).filter(|v| !v.is_nan());
        let deviation_k = finite(self.temperature_deviation_k);
        let temperature = finite(self.temperature_c);
        let temperature = temperature.map(|c| stated::temperature(c, deviation_k));
        Ok(SessionOptions {
            payload: match self.payload {
                UNKNOWN => Payload::Unknown,
                EMPTY => Payload::Empty,
                STATED => stated::payload(self.payload_kg, finite(self.payload_deviation_kg))?,
                _ => return Err(Refusal::Sentence("payload is no sinew_payload".to_owned())),
            },
            motor_torque: self.motor_torque,
            temperature_c: temperature.transpose()?,
            ..SessionOptions::default()
        })
    }
}

/// Makes the offsets of a robot since a baseline: the text of the file that `sinew baseline` writes. Free it with
/// `sinew_offsets_free`; the robot may be freed before.
///
/// `options` may be null: nothing is stated. `why` gets the sentence of a refusal, cut at `why_len` bytes; it may be
/// null.
///
/// Realtime: no, it allocates: all memory that is ever needed.
///
/// # Safety
/// `robot` is a robot; `baseline` ends with a zero byte; `options` is null or points to options; `out` may be written;
/// `why` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_new(
    robot: *const SinewRobot,
    baseline: *const c_char,
    options: *const SinewOffsetsOptions,
    out: *mut *mut SinewOffsets,
    why: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    unsafe {
        explained(why, why_len, || {
            give(out, || {
                let robot = shared(robot)?.robot.clone();
                let options = match options.as_ref() {
                    Some(options) => options.session()?,
                    None => SessionOptions::default(),
                };
                let known = Baseline::parse(text(baseline)?, "baseline")?;
                Ok(SinewOffsets(LiveOffsets::new(
                    robot,
                    (known, "baseline"),
                    &options,
                )?))
            })
        })
    }
}

/// Frees offsets; null is nothing.
///
/// Realtime: no.
///
/// # Safety
/// `offsets` is null or was made here and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_free(offsets: *mut SinewOffsets) {
    // SAFETY: the caller's promise.
    unsafe { take(offsets) }
}

/// Bounds the work of every step that follows: a small, fixed part of a block's, so that the same offsets come one block,
/// 0.2 s, later. Without it the sample that completes a block does all its work: milliseconds at seven joints.
///
/// `period_max_s`: the longest time between samples while all is well, s. Where samples come at longer ones, a block that finds
/// the one before undone is left out; `sinew_offsets_left_out` counts these.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_bound_work(
    offsets: *mut SinewOffsets,
    period_max_s: f64,
) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        unique(offsets)?.0.bound_work(period_max_s)?;
        Ok(())
    })
}

/// Blocks left out because work on the one before wasn't done; 0 unless samples come at longer times than
/// `sinew_offsets_bound_work` was told.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` are offsets; `blocks` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_left_out(
    offsets: *const SinewOffsets,
    blocks: *mut u64,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        put(blocks, shared(offsets)?.0.blocks_left_out());
        Ok(())
    })
}

/// Takes a sample, `dt_s` after the one before; of the first that doesn't matter.
///
/// `q_rad`, `theta_rad`: joint and motor positions, `joints` each, in the robot's order. `tau_m_nm`: motor torques, or null;
/// `temperature_c`: NaN where it isn't known. `stepped`, which may be null, says what became of it. A sample that lacks
/// something is refused and changes nothing. Its time has passed all the same: the next `dt_s` counts from it.
///
/// Realtime: yes. No allocation, lock, log or clock.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile; arrays have `joints` numbers; `stepped` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_step(
    offsets: *mut SinewOffsets,
    dt_s: f64,
    q_rad: *const f64,
    theta_rad: *const f64,
    tau_m_nm: *const f64,
    temperature_c: f64,
    joints: usize,
    stepped: *mut SinewStepped,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let live = &mut unique(offsets)?.0;
        let (q, theta) = (array(q_rad, joints)?, array(theta_rad, joints)?);
        let tau_m = optional(tau_m_nm, joints);
        let became = match live.step(dt_s, q, theta, tau_m, temperature_c)? {
            Stepped::Taken => SinewStepped::Taken,
            Stepped::Restarted => SinewStepped::Restarted,
            Stepped::Updated => SinewStepped::Updated,
            Stepped::Refused(why) => {
                put(stepped, why.into());
                return Err(Status::Refused);
            }
        };
        put(stepped, became);
        Ok(())
    })
}

/// The next sample doesn't go on where the last one was: the filters start anew, what is known stays.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_interrupt(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        unique(offsets)?.0.interrupt();
        Ok(())
    })
}

/// Offset of a joint since the baseline, rad, with one standard deviation, and whether offsets are in doubt: in the first
/// half minute, while something leans on the arm, after a slip that hasn't settled. Any of the three may be null.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` are offsets; places are null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_read(
    offsets: *const SinewOffsets,
    joint: usize,
    offset_rad: *mut f64,
    deviation_rad: *mut f64,
    in_doubt: *mut bool,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let live = &shared(offsets)?.0;
        if joint >= live.robot().arm.dof() {
            return Err(Status::Length);
        }
        let offset = live.offset(joint);
        put(offset_rad, offset.mean);
        put(deviation_rad, offset.deviation);
        put(in_doubt, live.is_provisional());
        Ok(())
    })
}

/// Probability, 0 to 1, that a joint's stiffness has changed since the baseline: a strand may have failed.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` are offsets; `probability` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_stiffness_changed(
    offsets: *const SinewOffsets,
    joint: usize,
    probability: *mut f64,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let live = &shared(offsets)?.0;
        if joint >= live.robot().arm.dof() {
            return Err(Status::Length);
        }
        put(probability, live.stiffness_changed(joint));
        Ok(())
    })
}

/// What a temperature that isn't known, now or in the baseline, adds to the deviation of a joint's offset, rad; 0 where both are known.
/// The deviation that is read holds it: it is the tolerance of robot.toml, so warmth far beyond that reads as stretch.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` are offsets; `deviation_rad` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_unknown_temperature(
    offsets: *const SinewOffsets,
    joint: usize,
    deviation_rad: *mut f64,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let live = &shared(offsets)?.0;
        if joint >= live.robot().arm.dof() {
            return Err(Status::Length);
        }
        put(deviation_rad, live.unknown_temperature_rad(joint));
        Ok(())
    })
}

/// A constant force from outside at the tool, as far as it is known: a hose, a cable that drags.
///
/// `probability`, 0 to 1: that one acts. `force_n`, `deviation_n`: three each, along the axes of the base, N, if one does. Each may be
/// null. Where none is looked for (`external_force_n = 0` in robot.toml) all are NaN.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` are offsets; `probability` is null or may be written; `force_n` and `deviation_n` are null or have room for three.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_external_force(
    offsets: *const SinewOffsets,
    probability: *mut f64,
    force_n: *mut f64,
    deviation_n: *mut f64,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let force = shared(offsets)?.0.external_force();
        put(probability, force.map_or(f64::NAN, |f| f.probability));
        for axis in 0..3 {
            let along = force.and_then(|f| f.force_n.get(axis).copied());
            let (mean, deviation) = along.map_or((f64::NAN, f64::NAN), |f| (f.mean, f.deviation));
            for (to, value) in [(force_n, mean), (deviation_n, deviation)] {
                if !to.is_null() {
                    put(to.add(axis), value);
                }
            }
        }
        Ok(())
    })
}

/// How fast offsets may move, rad/s, a standard deviation: 0 of ropes that don't creep, such as steel. It is 1 mrad a minute unless
/// this says otherwise, before the first sample.
///
/// Realtime: no.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_expect_creep(
    offsets: *mut SinewOffsets,
    deviation_rad_per_s: f64,
) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        unique(offsets)?.0.expect_creep(deviation_rad_per_s)?;
        Ok(())
    })
}

/// Writes what is known now as a baseline's text, the baseline of the next session, into `text`, with a zero at its end.
///
/// `recording` names this session, which ended at `end_time_ns` of its clock. `length` gets the bytes needed, zero included; it
/// may be null. With `text` null or `capacity` too small nothing is written and the answer is `SINEW_STATUS_SHORT`. While the offsets
/// are in doubt the answer is `SINEW_STATUS_IN_DOUBT`.
///
/// Realtime: no, it allocates.
///
/// # Safety
/// `offsets` are offsets; `recording` ends with a zero byte; `text` is null or has room for `capacity` bytes; `length` is null
/// or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_save(
    offsets: *const SinewOffsets,
    recording: *const c_char,
    end_time_ns: i64,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let recording = crate::borrow::text(recording)?;
        let saved = shared(offsets)?.0.save(recording, end_time_ns);
        let saved = saved.map_err(|error| match error {
            SessionError::Provisional { .. } => Status::InDoubt,
            _ => Status::Invalid,
        })?;
        let saved = saved.to_text();
        let needed = saved.len() + 1;
        put(length, needed);
        if text.is_null() || capacity < needed {
            return Err(Status::Short);
        }
        std::ptr::copy_nonoverlapping(saved.as_ptr().cast(), text, saved.len());
        text.add(saved.len()).write(0);
        Ok(())
    })
}
