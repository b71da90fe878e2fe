//! Absolute offsets since a baseline: samples in by a control loop, windows solved by a worker.

use crate::borrow::{
    Refusal, array, explained, give, guarded, optional, put, shared, take, text, unique, write,
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

/// Offsets of a robot's tendons since a baseline: the control loop's side. One thread at a time.
pub struct SinewOffsets {
    online: OnlineEstimator,
    /// Whether the worker runs elsewhere.
    worker_taken: bool,
}

/// The worker of offsets, which solves windows. One thread at a time, which may be another than that of its offsets.
pub struct SinewWorker(Box<OnlineWorker>);

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
    /// Temperature where samples do not carry it, °C; NaN: not stated.
    pub temperature_c: f64,
    /// How well that is known, one standard deviation, K; NaN: 2 K.
    pub temperature_deviation_k: f64,
    /// Whether a motor torque that samples carry is used.
    pub motor_torque: bool,
    /// Whether ropes may creep within the session: not those of steel.
    pub creep: bool,
}

/// What became of a sample.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewStepped {
    /// It was taken.
    Taken = 0,
    /// It was taken as the first one: at the start, or after a pause.
    Restarted = 1,
    /// It was taken and completed a block of some 0.2 s, which the worker may take.
    Block = 2,
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

/// Why an offset is provisional: its interval is wide, or may still move by more than it states.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SinewProvisional {
    /// It is not: the offset is settled.
    None = 0,
    /// No window has been solved yet.
    Starting = 1,
    /// A step of this offset explains the newest blocks. The interval is the hull of both hypotheses.
    Step = 2,
    /// The window contains a change so late that it may be a contact that has not ended.
    ChangeMayEnd = 3,
    /// Too many blocks are rejected as outliers for the remaining ones to be representative.
    Rejected = 4,
    /// The window could not be solved: the estimate is the one before. `sinew_offsets_error` has the sentence.
    Refused = 5,
}

/// The offset of one joint's tendon.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinewOffset {
    /// Posterior mean since the baseline, rad; NaN until a window has been solved, and of a rigid joint.
    pub offset_rad: f64,
    /// One standard deviation, rad; NaN where the offset is. The 95 % interval is the offset ± 1.96 deviations.
    pub deviation_rad: f64,
    /// What an unknown temperature, now or in the baseline, adds to the deviation, rad. The deviation contains it; 0
    /// where both are known, NaN of a rigid joint.
    pub unknown_temperature_rad: f64,
    /// Probability, 0 to 1, that the stiffness has changed since the baseline; NaN where that is not sought.
    pub stiffness_changed_probability: f64,
    /// Time of the step or of the change for which it is provisional, s since the first sample; NaN where there is none.
    pub since_s: f64,
    /// Posterior probability of a step, 0 to 1; NaN where none is suspected.
    pub step_probability: f64,
    /// Why it is provisional.
    pub provisional: SinewProvisional,
}

impl SinewOffset {
    const RIGID: Self = Self {
        offset_rad: f64::NAN,
        deviation_rad: f64::NAN,
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
            Some(Provisional::ChangeMayEnd { since_s }) => {
                (SinewProvisional::ChangeMayEnd, since_s, nan)
            }
            Some(Provisional::Rejected { .. }) => (SinewProvisional::Rejected, nan, nan),
            Some(Provisional::Refused) => (SinewProvisional::Refused, nan, nan),
        };
        Self {
            offset_rad: joint.offset_rad.mean,
            deviation_rad: joint.offset_rad.deviation,
            unknown_temperature_rad: joint.unknown_temperature_rad,
            stiffness_changed_probability: joint.stiffness_changed_probability.unwrap_or(nan),
            since_s,
            step_probability,
            provisional,
        }
    }
}

/// What an answer states besides offsets. Times are in s since the first sample.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SinewAnswer {
    /// Blocks that the worker has taken.
    pub blocks: u64,
    /// Blocks that the loop has completed and that are neither in the answer nor dropped: one or two while the worker
    /// keeps up. Where it grows the answer is old.
    pub blocks_behind: u64,
    /// Blocks that were dropped because the worker was late by more than ten seconds.
    pub blocks_dropped: u64,
    /// Middle of the last block taken, s; NaN before the first one.
    pub time_s: f64,
    /// Middle of the last block of the solution, s; NaN before the first one. The age is `time_s - solved_s`.
    pub solved_s: f64,
    /// Probability, 0 to 1, that something touches the arm in the last block; 0 until a window has been solved.
    pub contact_probability: f64,
    /// Probability, 0 to 1, of a constant external force at the tool, such as a hose; NaN where none was seen.
    pub external_force_probability: f64,
    /// That force along the axes of the base, N, if it acts; the offsets account for it. NaN where none was seen.
    pub external_force_n: [f64; 3],
    /// One standard deviation each, N; NaN where none was seen.
    pub external_force_deviation_n: [f64; 3],
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
            external_force_deviation_n: force
                .map_or([f64::NAN; 3], |f| f.force_n.map(|n| n.deviation)),
        }
    }
}

/// Nothing stated: an unknown payload, temperatures as samples carry them, motor torque used, ropes that may creep.
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
        creep: true,
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
            creep: self.creep,
            ..SessionOptions::default()
        })
    }
}

/// Makes the offsets of a robot since a baseline: the text of the file that `sinew baseline` writes. Free them with
/// `sinew_offsets_free`; the robot may be freed before.
///
/// `baseline` may be null: offsets are then against the zero of the encoders. `options` may be null: nothing is stated.
/// `why` gets the sentence of a refusal, cut at `why_len` bytes; it may be null.
///
/// Nothing is solved until a worker works. It is driven by `sinew_offsets_start_worker`, `sinew_offsets_work` or
/// `sinew_offsets_take_worker`.
///
/// Realtime: no, it allocates: all memory that the loop ever needs.
///
/// # Safety
/// `robot` is a robot; `baseline` is null or ends with a zero byte; `options` is null or points to options; `out` may be
/// written; `why` is null or has room for `why_len` bytes.
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
                let baseline = match baseline.is_null() {
                    true => None,
                    false => Some(Baseline::parse(text(baseline)?, "baseline")?),
                };
                let baseline = baseline.map(|known| (known, "baseline".to_owned()));
                Ok(SinewOffsets {
                    online: OnlineEstimator::new(robot, baseline, &options, "session")?,
                    worker_taken: false,
                })
            })
        })
    }
}

/// Frees offsets; null is nothing. Where `sinew_offsets_start_worker` started a thread, it ends the thread and waits for
/// the solution under way.
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

/// Takes a sample, `dt_s` after the one before; of the first that does not matter.
///
/// `q_rad`, `theta_rad`: joint and motor positions, rad, `joints` each, in the robot's order. `tau_m_nm`: motor torques,
/// N·m, or null; `temperature_c`: °C, NaN where it is not known. `stepped`, which may be null, gets what became of it. A
/// sample that lacks something is refused with `SINEW_STATUS_REFUSED` and changes nothing. Its time has passed all the
/// same: the next `dt_s` counts from it.
///
/// Realtime: yes. No allocation, lock, wait, log or clock.
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
        let online = &mut unique(offsets)?.online;
        let (q, theta) = (array(q_rad, joints)?, array(theta_rad, joints)?);
        let tau_m = optional(tau_m_nm, joints);
        let became = match online.step(dt_s, q, theta, tau_m, temperature_c)? {
            StepOutcome::Taken => SinewStepped::Taken,
            StepOutcome::Restarted => SinewStepped::Restarted,
            StepOutcome::Block => SinewStepped::Block,
            StepOutcome::Refused(why) => {
                put(stepped, why.into());
                return Err(Status::Refused);
            }
        };
        put(stepped, became);
        Ok(())
    })
}

/// The next sample does not go on where the last one was: the filters start anew, what is known stays.
///
/// Realtime: yes.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_interrupt(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        unique(offsets)?.online.interrupt();
        Ok(())
    })
}

/// Reads the latest answer of the worker: `answer`, and the offset of every joint in `of_joints`, in the robot's order.
///
/// Either may be null. Both come from the same answer, while two calls may come from two. `joints` is the number of the
/// robot's joints, else the status is `SINEW_STATUS_LENGTH`. A rigid joint's numbers are NaN.
///
/// Realtime: yes. No allocation, lock, wait, log or clock. It is for the thread that steps, as it takes the answer out of
/// a triple buffer.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile; `answer` is null or may be written; `of_joints` is null or has room for
/// `joints` offsets.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_read(
    offsets: *mut SinewOffsets,
    answer: *mut SinewAnswer,
    of_joints: *mut SinewOffset,
    joints: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let online = &mut unique(offsets)?.online;
        if joints != online.robot().arm.dof() {
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

/// Why an offset is provisional, in a word or two, such as `step`; never null, never freed. Of a number that is no
/// `sinew_provisional`: `unknown`.
///
/// Realtime: yes.
#[unsafe(no_mangle)]
pub extern "C" fn sinew_provisional_text(provisional: c_int) -> *const c_char {
    const TEXTS: [&CStr; 6] = [
        c"settled",
        c"starting",
        c"step",
        c"change may end",
        c"rejected",
        c"refused",
    ];
    let at = usize::try_from(provisional).ok();
    let text = at.and_then(|at| TEXTS.get(at).copied());
    text.unwrap_or(c"unknown").as_ptr()
}

/// Starts a thread that works until the offsets are freed: it takes blocks and solves windows. Once, before the loop.
///
/// The thread inherits the scheduling policy and priority of the one that calls: call it before the loop's thread becomes
/// a realtime one. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before. `SINEW_STATUS_THREAD`: the system
/// has no thread to give, and the worker is as before.
///
/// Realtime: no.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_start_worker(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: the caller's promise.
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

/// Takes all blocks that are ready and solves the window where that is due, in the thread that calls: some hundredths of
/// a second every 2 s of samples.
///
/// For a program of a single thread, between samples. Beside a loop in another thread use `sinew_offsets_start_worker` or
/// `sinew_offsets_take_worker`. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
///
/// Realtime: no.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_work(offsets: *mut SinewOffsets) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        let offsets = unique(offsets)?;
        if offsets.worker_taken {
            return Err(Status::WorkerTaken);
        }
        offsets.online.work();
        Ok(())
    })
}

/// Takes the worker out, for a thread of the caller's own: `sinew_worker_work` in it, while the loop's thread uses the
/// offsets. Free it with `sinew_worker_free`, before or after the offsets.
///
/// `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
///
/// Realtime: no.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile; `out` is null or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_take_worker(
    offsets: *mut SinewOffsets,
    out: *mut *mut SinewWorker,
) -> Status {
    // SAFETY: the caller's promises, handed on. No sentence is asked for.
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

/// Takes all blocks that are ready and solves the window where that is due: some hundredths of a second every 2 s of
/// samples. Call it some fifty times a second, such as with a pause of 20 ms between calls.
///
/// After its offsets were freed it does nothing more.
///
/// Realtime: no.
///
/// # Safety
/// `worker` is used by nobody else meanwhile; its offsets may be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_worker_work(worker: *mut SinewWorker) -> Status {
    // SAFETY: the caller's promise.
    guarded(|| unsafe {
        unique(worker)?.0.work();
        Ok(())
    })
}

/// Frees a worker; null is nothing. Its offsets then keep their last answer, and blocks are dropped and counted.
///
/// Realtime: no.
///
/// # Safety
/// `worker` is null or was taken from offsets and not freed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_worker_free(worker: *mut SinewWorker) {
    // SAFETY: the caller's promise.
    unsafe { take(worker) }
}

/// Why the window could not be solved last time: the sentence goes to `why`, cut at `why_len` bytes. It is empty where
/// the window was solved, or has never been tried.
///
/// Realtime: no, it may wait for the worker.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile; `why` is null or has room for `why_len` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_offsets_error(
    offsets: *const SinewOffsets,
    why: *mut c_char,
    why_len: usize,
) -> Status {
    // SAFETY: the caller's promises, handed on.
    guarded(|| unsafe {
        let error = shared(offsets)?.online.error();
        let sentence = error.map_or_else(String::new, |error| error.to_string());
        write(why, why_len, &sentence);
        Ok(())
    })
}

/// Writes the last solution as a baseline's text, the baseline of the next session, into `text`, with a zero at its end.
///
/// `recording` names this session, which ended at `end_time_ns` of its clock. `length` gets the bytes needed, zero
/// included; it may be null. With `text` null or `capacity` too small nothing is written and the status is
/// `SINEW_STATUS_SHORT`. While an offset is provisional the status is `SINEW_STATUS_PROVISIONAL`.
///
/// Realtime: no, it allocates and may wait for the worker.
///
/// # Safety
/// `offsets` is used by nobody else meanwhile; `recording` ends with a zero byte; `text` is null or has room for
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
    // SAFETY: the caller's promises, handed on.
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
