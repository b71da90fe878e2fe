//! Absolute offsets since a baseline: a control loop adds samples, a worker solves windows.

use crate::borrow::{
    CallError, array, explained, give, guarded, optional, put, shared, take, text, unique, write,
};
use crate::robot::SinewRobot;
use crate::status::Status;
use sinew_estimate::baseline::Baseline;
use sinew_estimate::feeder;
use sinew_estimate::online::{
    OnlineAnswer, OnlineEstimator, OnlineJoint, OnlineWorker, Provisional, StepOutcome,
};
use sinew_estimate::session::{Payload, SessionError, SessionOptions, stated};
use std::ffi::{CStr, c_char, c_int};

/// Offsets of a robot's tendons since a baseline, for the control loop. Not thread-safe: one thread at a time.
pub struct SinewOffsets {
    online: OnlineEstimator,
    /// Whether the worker was started or taken.
    worker_taken: bool,
}

/// Worker that solves the windows of offsets. One thread at a time, which may differ from that of the offsets.
pub struct SinewWorker(Box<OnlineWorker>);

/// Kind of the payload in the gripper.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewPayload {
    /// Unknown payload, estimated jointly.
    Unknown = 0,
    /// Gripper without a payload.
    Empty = 1,
    /// Payload of specified mass.
    Stated = 2,
}

// Numbers, because C may pass any value.
const UNKNOWN: u32 = SinewPayload::Unknown as u32;
const EMPTY: u32 = SinewPayload::Empty as u32;
const STATED: u32 = SinewPayload::Stated as u32;

/// Options of a session.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SinewOffsetsOptions {
    /// Payload in the gripper, a `sinew_payload`.
    pub payload: u32,
    /// Mass of a specified payload, kg.
    pub payload_kg: f64,
    /// Standard deviation of the payload mass, kg; NaN: 2 %.
    pub payload_std_kg: f64,
    /// Temperature for samples without one, °C; NaN: not specified.
    pub temperature_c: f64,
    /// Standard deviation of the temperature, K; NaN: 2 K.
    pub temperature_std_k: f64,
    /// Whether the motor torque of samples is used.
    pub motor_torque: bool,
    /// Whether ropes may creep within the session; false for steel ropes.
    pub creep: bool,
}

/// Result of a step.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewStepped {
    /// Sample accepted by the estimator.
    Accepted = 0,
    /// Accepted as the first sample, at the start or after a gap.
    Restarted = 1,
    /// Accepted; it completed a block of about 0.2 s for the worker.
    Block = 2,
    /// Rejected: a joint position is missing or not finite.
    NoJointPosition = 3,
    /// Rejected: the motor position of an elastic joint is missing or not finite.
    NoMotorPosition = 4,
    /// Rejected: its time is not after that of the last accepted sample.
    NoTimeStep = 5,
    /// Rejected: a value is implausibly large.
    OutOfRange = 6,
}

impl From<feeder::RejectionReason> for SinewStepped {
    fn from(reason: feeder::RejectionReason) -> Self {
        match reason {
            feeder::RejectionReason::JointPosition => Self::NoJointPosition,
            feeder::RejectionReason::MotorPosition => Self::NoMotorPosition,
            feeder::RejectionReason::TimeStep => Self::NoTimeStep,
            _ => Self::OutOfRange,
        }
    }
}

/// Reason for a provisional offset: its interval is wide, or may still change by more than it states.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewProvisional {
    /// Not provisional: the offset is settled.
    None = 0,
    /// No window has been solved yet.
    Starting = 1,
    /// A step of this offset explains the newest blocks. The interval is the hull of both hypotheses.
    Step = 2,
    /// The window contains a change so late that it may be a contact that has not ended.
    ChangeNearEnd = 3,
    /// Too many blocks are rejected as outliers for the remaining ones to be representative.
    Rejected = 4,
    /// The window could not be solved: the estimate is the previous one. `sinew_offsets_error` returns the message.
    NotSolved = 5,
}

/// Offset of the tendon of one joint.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinewOffset {
    /// Posterior mean since the baseline, rad; NaN until a window has been solved, and for a rigid joint.
    pub offset_rad: f64,
    /// Standard deviation of the offset, rad; NaN if the offset is NaN. The 95 % interval is the offset ± 1.96 times this
    /// value.
    pub offset_std_rad: f64,
    /// Contribution of an unknown temperature, now or in the baseline, to the standard deviation, rad, included in it; 0
    /// if both are specified, NaN for a rigid joint.
    pub unknown_temperature_rad: f64,
    /// Probability, 0 to 1, that the stiffness has changed since the baseline; NaN if it is not tested.
    pub stiffness_changed_probability: f64,
    /// Time of the step or change that makes the offset provisional, s since the first sample; NaN if there is none.
    pub since_s: f64,
    /// Posterior probability of a step, 0 to 1; NaN if none is suspected.
    pub step_probability: f64,
    /// Reason for a provisional offset.
    pub provisional: SinewProvisional,
}

impl SinewOffset {
    const RIGID: Self = Self {
        offset_rad: f64::NAN,
        offset_std_rad: f64::NAN,
        unknown_temperature_rad: f64::NAN,
        stiffness_changed_probability: f64::NAN,
        since_s: f64::NAN,
        step_probability: f64::NAN,
        provisional: SinewProvisional::None,
    };
}

impl From<&OnlineJoint> for SinewOffset {
    fn from(joint: &OnlineJoint) -> Self {
        let nan = f64::NAN;
        let (provisional, since_s, step_probability) = match joint.provisional {
            None => (SinewProvisional::None, nan, nan),
            Some(Provisional::Starting) => (SinewProvisional::Starting, nan, nan),
            Some(Provisional::Step {
                since_s,
                probability,
            }) => (SinewProvisional::Step, since_s, probability),
            Some(Provisional::ChangeNearEnd { since_s }) => {
                (SinewProvisional::ChangeNearEnd, since_s, nan)
            }
            Some(Provisional::Rejected { .. }) => (SinewProvisional::Rejected, nan, nan),
            Some(Provisional::NotSolved) => (SinewProvisional::NotSolved, nan, nan),
        };
        Self {
            offset_rad: joint.offset_rad.mean,
            offset_std_rad: joint.offset_rad.std,
            unknown_temperature_rad: joint.unknown_temperature_rad,
            stiffness_changed_probability: joint.stiffness_changed_probability.unwrap_or(nan),
            since_s,
            step_probability,
            provisional,
        }
    }
}

/// Estimate of all quantities except the offsets. Times are in s since the first sample.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinewAnswer {
    /// Number of blocks that the worker has processed.
    pub blocks: u64,
    /// Number of completed blocks that are neither in the answer nor dropped: one or two while the worker keeps up. An
    /// increasing number means that the answer is outdated.
    pub blocks_behind: u64,
    /// Number of blocks dropped because the worker was late by more than ten seconds.
    pub blocks_dropped: u64,
    /// Midpoint of the last processed block, s; NaN before the first block.
    pub time_s: f64,
    /// Midpoint of the last block of the solution, s; NaN before the first solution. The age of the solution is `time_s - solved_s`.
    pub solved_s: f64,
    /// Probability, 0 to 1, of a contact in the last block; 0 until a window has been solved.
    pub contact_probability: f64,
    /// Probability, 0 to 1, of a constant external force at the tool, such as a hose; NaN if none was detected.
    pub external_force_probability: f64,
    /// Estimated external force in the base frame, N, if it acts; the offsets account for it. NaN if none was detected.
    pub external_force_n: [f64; 3],
    /// Standard deviation of each component of the external force, N; NaN if none was detected.
    pub external_force_std_n: [f64; 3],
}

impl SinewAnswer {
    fn new(answer: &OnlineAnswer, [blocks_behind, blocks_dropped]: [u64; 2]) -> Self {
        let force = answer.external_force.as_ref();
        Self {
            blocks: answer.blocks,
            blocks_behind,
            blocks_dropped,
            time_s: answer.time_s,
            solved_s: answer.solved_s,
            contact_probability: answer.contact_probability,
            external_force_probability: force.map_or(f64::NAN, |f| f.probability),
            external_force_n: force.map_or([f64::NAN; 3], |f| f.force_n.map(|n| n.mean)),
            external_force_std_n: force.map_or([f64::NAN; 3], |f| f.force_n.map(|n| n.std)),
        }
    }
}

/// Default options: unknown payload, temperature from the samples, motor torque used, creep allowed.
///
/// Realtime: yes.
///
/// Threads: any number at once.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_offsets_options_default() -> SinewOffsetsOptions {
    SinewOffsetsOptions {
        payload: SinewPayload::Unknown as u32,
        payload_kg: 0.0,
        payload_std_kg: f64::NAN,
        temperature_c: f64::NAN,
        temperature_std_k: f64::NAN,
        motor_torque: true,
        creep: true,
    }
}

impl SinewOffsetsOptions {
    fn session(&self) -> Result<SessionOptions, CallError> {
        let finite = |value: f64| Some(value).filter(|v| !v.is_nan());
        let std_k = finite(self.temperature_std_k);
        let temperature = finite(self.temperature_c);
        let temperature = temperature.map(|c| stated::temperature(c, std_k));
        Ok(SessionOptions {
            payload: match self.payload {
                UNKNOWN => Payload::Unknown,
                EMPTY => Payload::Empty,
                STATED => stated::payload(self.payload_kg, finite(self.payload_std_kg))?,
                _ => {
                    return Err(CallError::Message(
                        "payload is not a valid sinew_payload".to_owned(),
                    ));
                }
            },
            motor_torque: self.motor_torque,
            temperature_c: temperature.transpose()?,
            creep: self.creep,
            ..SessionOptions::default()
        })
    }
}

/// Creates the offsets of a robot since a baseline, given as the text of a file of `sinew baseline`. Free them with
/// `sinew_offsets_free`; the robot may be freed before.
///
/// `baseline` may be null: offsets then refer to the encoder zero. `options` may be null: the defaults apply. `reason`
/// receives the error message, truncated to `why_len` bytes; it may be null.
///
/// Windows are solved by the worker only, which is run by `sinew_offsets_start_worker`, `sinew_offsets_work` or
/// `sinew_offsets_take_worker`.
///
/// Realtime: no, it allocates all memory of the loop.
///
/// Threads: any number at once.
///
/// # Safety
/// `robot` is a robot; `baseline` is null or ends with a zero byte; `options` is null or points to options; `out` may be
/// written; `reason` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_new(
    robot: *const SinewRobot,
    baseline: *const c_char,
    options: *const SinewOffsetsOptions,
    out: *mut *mut SinewOffsets,
    reason: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    unsafe {
        explained(reason, why_len, || {
            give(out, || {
                let robot = shared(robot)?.robot.clone();
                let options = match options.as_ref() {
                    Some(options) => options.session()?,
                    None => SessionOptions::default(),
                };
                let baseline = match baseline.is_null() {
                    true => None,
                    false => Some(Baseline::parse(text(baseline)?, "baseline")?),
                };
                let baseline = baseline.map(|baseline| (baseline, "baseline".to_owned()));
                Ok(SinewOffsets {
                    online: OnlineEstimator::new(robot, baseline, &options, "session")?,
                    worker_taken: false,
                })
            })
        })
    }
}

/// Frees offsets; null has no effect. A thread started by `sinew_offsets_start_worker` is stopped, after its present
/// solution.
///
/// Realtime: no.
///
/// Threads: no other call uses the handle.
///
/// # Safety
/// `offsets` is null or was created by `sinew_offsets_new` and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_free(offsets: *mut SinewOffsets) {
    // SAFETY: guaranteed by the caller.
    unsafe { take(offsets) }
}

/// Adds a sample, `dt_s` after the previous one; ignored for the first sample.
///
/// `q_rad`, `theta_rad`: joint and motor positions, rad, `joints` each, in the robot's order. `tau_m_nm`: motor torques,
/// N·m, or null; `temperature_c`: °C, NaN if not measured. `stepped`, which may be null, receives the result of the
/// step. An incomplete sample is rejected with `SINEW_STATUS_REJECTED` and leaves the estimate unchanged. The clock still
/// advances: the next `dt_s` counts from this sample.
///
/// Realtime: yes. No allocation, lock, wait, log or clock.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently; arrays have `joints` numbers; `stepped` is null or may be written.
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
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let online = &mut unique(offsets)?.online;
        let (q, theta) = (array(q_rad, joints)?, array(theta_rad, joints)?);
        let tau_m = optional(tau_m_nm, joints);
        let became = match online.step(dt_s, q, theta, tau_m, temperature_c)? {
            StepOutcome::Accepted => SinewStepped::Accepted,
            StepOutcome::Restarted => SinewStepped::Restarted,
            StepOutcome::Block => SinewStepped::Block,
            StepOutcome::Rejected(reason) => {
                put(stepped, reason.into());
                return Err(Status::Rejected);
            }
        };
        put(stepped, became);
        Ok(())
    })
}

/// Marks a gap before the next sample: the filters are re-initialised, the estimates are kept.
///
/// Realtime: yes.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_interrupt(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        unique(offsets)?.online.interrupt();
        Ok(())
    })
}

/// Reads the latest answer of the worker: `answer`, and the offset of every joint in `of_joints`, in the robot's order.
///
/// Either may be null. Both come from the same answer, while two calls may come from two. `joints` is the number of the
/// robot's joints, else the status is `SINEW_STATUS_LENGTH`. The values of a rigid joint are NaN.
///
/// Realtime: yes. No allocation, lock, wait, log or clock. Call it in the thread that steps, because it takes the
/// answer from a triple buffer.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently; `answer` is null or may be written; `of_joints` is null or has room for
/// `joints` offsets.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_read(
    offsets: *mut SinewOffsets,
    answer: *mut SinewAnswer,
    of_joints: *mut SinewOffset,
    joints: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let online = &mut unique(offsets)?.online;
        if joints != online.robot().axes() {
            return Err(Status::Length);
        }
        // Before the answer: a newer one may come in between, and the count is then high rather than low.
        let behind = online.blocks_behind();
        let dropped = online.blocks_dropped();
        let latest = online.answer();
        put(answer, SinewAnswer::new(latest, [behind, dropped]));
        if !of_joints.is_null() {
            for joint in 0..joints {
                let of = latest.joint(joint);
                put(
                    of_joints.add(joint),
                    of.map_or(SinewOffset::RIGID, Into::into),
                );
            }
        }
        Ok(())
    })
}

/// Short name of the reason for a provisional offset, such as `step`; never null, never freed. For an invalid number:
/// `unknown`.
///
/// Realtime: yes.
///
/// Threads: any number at once.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_provisional_text(provisional: c_int) -> *const c_char {
    const TEXTS: [&CStr; 6] = [
        c"settled",
        c"starting",
        c"step",
        c"change may end",
        c"rejected",
        c"not solved",
    ];
    let at = usize::try_from(provisional).ok();
    let text = at.and_then(|at| TEXTS.get(at).copied());
    text.unwrap_or(c"unknown").as_ptr()
}

/// Starts a thread that processes blocks and solves windows until the offsets are freed. Call it once, before the loop.
///
/// The thread inherits the scheduling policy and priority of the calling thread: call it before that thread becomes
/// a realtime thread. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before. `SINEW_STATUS_THREAD`: the system
/// could not create a thread, and the worker is unchanged.
///
/// Realtime: no.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_start_worker(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let offsets = unique(offsets)?;
        if offsets.worker_taken {
            return Err(Status::WorkerTaken);
        }
        (offsets.online.start_worker()).map_err(|_| Status::Thread)?;
        offsets.worker_taken = true;
        Ok(())
    })
}

/// Processes all completed blocks and solves the window if due, in the calling thread. A solution takes some hundredths
/// of a second, every 2 s of samples.
///
/// For single-threaded programs, between samples. For a loop in another thread use `sinew_offsets_start_worker` or
/// `sinew_offsets_take_worker`. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
///
/// Realtime: no.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_work(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let offsets = unique(offsets)?;
        if offsets.worker_taken {
            return Err(Status::WorkerTaken);
        }
        offsets.online.work();
        Ok(())
    })
}

/// Takes the worker, for a thread of the caller that calls `sinew_worker_work` while the thread of the loop uses the
/// offsets. Free it with `sinew_worker_free`, before or after the offsets.
///
/// `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
///
/// Realtime: no.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently; `out` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_take_worker(
    offsets: *mut SinewOffsets,
    out: *mut *mut SinewWorker,
) -> Status {
    // SAFETY: guaranteed by the caller. No message is required.
    unsafe {
        explained(std::ptr::null_mut(), 0, || {
            give(out, || {
                let offsets = unique(offsets)?;
                let worker = offsets.online.take_worker();
                offsets.worker_taken = true;
                Ok(SinewWorker(worker.ok_or(Status::WorkerTaken)?))
            })
        })
    }
}

/// Processes all completed blocks and solves the window if due, which takes some hundredths of a second, every 2 s of
/// samples. Call it about fifty times a second, for example with a pause of 20 ms between calls.
///
/// After its offsets were freed it has no effect.
///
/// Realtime: no.
///
/// Threads: one call per worker at a time; calls of its offsets may be concurrent.
///
/// # Safety
/// `worker` is not used concurrently; its offsets may be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_worker_work(worker: *mut SinewWorker) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        unique(worker)?.0.work();
        Ok(())
    })
}

/// Frees a worker; null has no effect. Its offsets then keep their last answer, and blocks are dropped and counted.
///
/// Realtime: no.
///
/// Threads: no other call uses the handle.
///
/// # Safety
/// `worker` is null or was taken from offsets and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_worker_free(worker: *mut SinewWorker) {
    // SAFETY: guaranteed by the caller.
    unsafe { take(worker) }
}

/// Reason why the last window could not be solved: the message is written to `reason`, truncated to `why_len` bytes. It is
/// empty if the last window was solved or none has been tried.
///
/// Realtime: no, it may wait for the worker.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently; `reason` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_error(
    offsets: *const SinewOffsets,
    reason: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let error = shared(offsets)?.online.error();
        let sentence = error.map_or_else(String::new, |error| error.to_string());
        write(reason, why_len, &sentence);
        Ok(())
    })
}

/// Writes the last solution to `text` as a zero-terminated baseline, which serves as the baseline of the next session.
///
/// `recording` names this session, which ended at `end_time_ns` of its clock. `length` receives the required bytes,
/// including the zero; it may be null. With `text` null or `capacity` too small nothing is written and the status is
/// `SINEW_STATUS_SHORT`. While an offset is provisional the status is `SINEW_STATUS_PROVISIONAL`.
///
/// Realtime: no, it allocates and may wait for the worker.
///
/// Threads: one call per handle at a time.
///
/// # Safety
/// `offsets` is not used concurrently; `recording` ends with a zero byte; `text` is null or has room for
/// `capacity` bytes; `length` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_save(
    offsets: *mut SinewOffsets,
    recording: *const c_char,
    end_time_ns: i64,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Status {
    // SAFETY: guaranteed by the caller.
    guarded(|| unsafe {
        let recording = crate::borrow::text(recording)?;
        let saved = unique(offsets)?.online.save(recording, end_time_ns);
        let saved = saved.map_err(|error| match error {
            SessionError::Provisional { .. } => Status::Provisional,
            _ => Status::Invalid,
        })?;
        let saved = saved.to_text();
        let needed = saved.len() + 1;
        put(length, needed);
        if text.is_null() || capacity < needed {
            return Err(Status::Short);
        }
        write(text, capacity, &saved);
        Ok(())
    })
}
