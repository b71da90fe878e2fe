/* Sinew: offsets of tendons inside a control loop.
 *
 * Handles are made by `_new` and freed by `_free`. A handle belongs to one thread at a time; a robot may be
 * read from several, and a worker is a handle of its own.
 *
 * Made by bindings/c/header/write: change the Rust sources, not this. */

#ifndef SINEW_H
#define SINEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Version of this interface: raised when a program compiled against an older header may no longer be right.
#define SINEW_ABI_VERSION 2

// What a call returns.
typedef enum {
    // It was done.
    SINEW_STATUS_OK = 0,
    // A pointer that must not be null is.
    SINEW_STATUS_NULL = 1,
    // An array has another length than the robot has joints, or there is no such joint.
    SINEW_STATUS_LENGTH = 2,
    // An input is NaN or infinite. Nothing has changed.
    SINEW_STATUS_NOT_FINITE = 3,
    // The time step is none. Nothing has changed.
    SINEW_STATUS_TIME_STEP = 4,
    // A sample cannot be used; what it lacks stands beside. Nothing has changed.
    SINEW_STATUS_REFUSED = 5,
    // A text or a value was refused; the sentence says why.
    SINEW_STATUS_INVALID = 6,
    // A text is not UTF-8.
    SINEW_STATUS_ENCODING = 7,
    // The buffer is too short; the length needed stands beside.
    SINEW_STATUS_SHORT = 8,
    // An offset is provisional: the offsets cannot be saved now.
    SINEW_STATUS_PROVISIONAL = 9,
    // Sinew has a fault of its own. The handle must only be freed.
    SINEW_STATUS_PANIC = 10,
    // The worker was started or taken before. Nothing has changed.
    SINEW_STATUS_WORKER_TAKEN = 11,
    // The system has no thread to give.
    SINEW_STATUS_THREAD = 12,
} sinew_status;

// What became of a sample.
typedef enum {
    // It was taken.
    SINEW_STEPPED_TAKEN = 0,
    // It was taken as the first one: at the start, or after a pause.
    SINEW_STEPPED_RESTARTED = 1,
    // It was taken and completed a block of some 0.2 s, which the worker may take.
    SINEW_STEPPED_BLOCK = 2,
    // Refused: a joint position is missing or not finite.
    SINEW_STEPPED_NO_JOINT_POSITION = 3,
    // Refused: an elastic joint's motor position is missing or not finite.
    SINEW_STEPPED_NO_MOTOR_POSITION = 4,
    // Refused: its time is not after that of the last sample taken.
    SINEW_STEPPED_NO_TIME_STEP = 5,
    // Refused: a value is too large to be one.
    SINEW_STEPPED_OUT_OF_RANGE = 6,
} sinew_stepped;

// Why an offset is provisional: its interval is wide, or may still move by more than it states.
typedef enum {
    // It is not: the offset is settled.
    SINEW_PROVISIONAL_NONE = 0,
    // No window has been solved yet.
    SINEW_PROVISIONAL_STARTING = 1,
    // A step of this offset explains the newest blocks. The interval is the hull of both hypotheses.
    SINEW_PROVISIONAL_STEP = 2,
    // The window contains a change so late that it may be a contact that has not ended.
    SINEW_PROVISIONAL_CHANGE_MAY_END = 3,
    // Too many blocks are rejected as outliers for the remaining ones to be representative.
    SINEW_PROVISIONAL_REJECTED = 4,
    // The window could not be solved: the estimate is the one before. `sinew_offsets_error` has the sentence.
    SINEW_PROVISIONAL_REFUSED = 5,
} sinew_provisional;

// What the gripper holds.
typedef enum {
    // Something unknown: it is estimated along.
    SINEW_PAYLOAD_UNKNOWN = 0,
    // Nothing.
    SINEW_PAYLOAD_EMPTY = 1,
    // A stated mass.
    SINEW_PAYLOAD_STATED = 2,
} sinew_payload;

// An arm with the memory its pass needs. One thread at a time.
typedef struct sinew_arm sinew_arm;

// The observer of a robot. One thread at a time.
typedef struct sinew_observer sinew_observer;

// Offsets of a robot's tendons since a baseline: the control loop's side. One thread at a time.
typedef struct sinew_offsets sinew_offsets;

// A robot: joints, masses, stiffness, tendons. Never changes; may be read from several threads.
typedef struct sinew_robot sinew_robot;

// The worker of offsets, which solves windows. One thread at a time, which may be another than that of its offsets.
typedef struct sinew_worker sinew_worker;

// What is known of a session.
typedef struct {
    // What the gripper holds: a `sinew_payload`.
    uint32_t payload;
    // Its mass where it is stated, kg.
    double payload_kg;
    // How well that is known, one standard deviation, kg; NaN: 2 %.
    double payload_deviation_kg;
    // Temperature where samples do not carry it, °C; NaN: not stated.
    double temperature_c;
    // How well that is known, one standard deviation, K; NaN: 2 K.
    double temperature_deviation_k;
    // Whether a motor torque that samples carry is used.
    bool motor_torque;
    // Whether ropes may creep within the session: not those of steel.
    bool creep;
} sinew_offsets_options;

// What an answer states besides offsets. Times are in s since the first sample.
typedef struct {
    // Blocks that the worker has taken.
    uint64_t blocks;
    // Blocks that the loop has completed and that are neither in the answer nor dropped: one or two while the worker
    // keeps up. Where it grows the answer is old.
    uint64_t blocks_behind;
    // Blocks that were dropped because the worker was late by more than ten seconds.
    uint64_t blocks_dropped;
    // Middle of the last block taken, s; NaN before the first one.
    double time_s;
    // Middle of the last block of the solution, s; NaN before the first one. The age is `time_s - solved_s`.
    double solved_s;
    // Probability, 0 to 1, that something touches the arm in the last block; 0 until a window has been solved.
    double contact_probability;
    // Probability, 0 to 1, of a constant external force at the tool, such as a hose; NaN where none was seen.
    double external_force_probability;
    // That force along the axes of the base, N, if it acts; the offsets account for it. NaN where none was seen.
    double external_force_n[3];
    // One standard deviation each, N; NaN where none was seen.
    double external_force_deviation_n[3];
} sinew_answer;

// The offset of one joint's tendon.
typedef struct {
    // Posterior mean since the baseline, rad; NaN until a window has been solved, and of a rigid joint.
    double offset_rad;
    // One standard deviation, rad; NaN where the offset is. The 95 % interval is the offset ± 1.96 deviations.
    double deviation_rad;
    // What an unknown temperature, now or in the baseline, adds to the deviation, rad. The deviation contains it; 0
    // where both are known, NaN of a rigid joint.
    double unknown_temperature_rad;
    // Probability, 0 to 1, that the stiffness has changed since the baseline; NaN where that is not sought.
    double stiffness_changed_probability;
    // Time of the step or of the change for which it is provisional, s since the first sample; NaN where there is none.
    double since_s;
    // Posterior probability of a step, 0 to 1; NaN where none is suspected.
    double step_probability;
    // Why it is provisional.
    sinew_provisional provisional;
} sinew_offset;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the interface that the library was built with: compare with `SINEW_ABI_VERSION`.
//
// Realtime: yes.
uint32_t sinew_abi_version(void);

// Version of Sinew, such as `0.1.0`; never null, never freed.
//
// Realtime: yes.
const char *sinew_version(void);

// A status in words; never null, never freed. Of a number that is none: that.
//
// Realtime: yes.
const char *sinew_status_text(int status);

// Makes a robot from the texts of `robot.toml` and of a URDF. Free it with `sinew_robot_free`.
//
// `why` gets the sentence of a refusal, cut at `why_len` bytes; it may be null.
//
// Realtime: no, it allocates.
//
// The caller sees to it: Texts end with a zero byte; `out` may be written; `why` is null or has room for `why_len` bytes.
sinew_status sinew_robot_new(const char *robot_toml,
                             const char *urdf,
                             sinew_robot **out,
                             char *why,
                             size_t why_len);

// Makes a robot from its folder, or from the path of its `robot.toml`. Free it with `sinew_robot_free`.
//
// Realtime: no, it reads files.
//
// The caller sees to it: As `sinew_robot_new`.
sinew_status sinew_robot_open(const char *place, sinew_robot **out, char *why, size_t why_len);

// Frees a robot; null is nothing. What was made from it goes on.
//
// Realtime: no.
//
// The caller sees to it: `robot` is null or was made here and not freed before.
void sinew_robot_free(sinew_robot *robot);

// How many joints a robot has; 0 of null.
//
// Realtime: yes.
//
// The caller sees to it: `robot` is null or a robot.
size_t sinew_robot_joints(const sinew_robot *robot);

// Name of a joint, as long as the robot is there; null where there is none.
//
// Realtime: yes.
//
// The caller sees to it: `robot` is null or a robot.
const char *sinew_robot_joint_name(const sinew_robot *robot, size_t joint);

// Name of the tendon that a joint is paired with, as long as the robot is there: the joint's own, unless `robot.toml` has
// `[[tendons]]`; null where there is no such joint.
//
// Realtime: yes.
//
// The caller sees to it: `robot` is null or a robot.
const char *sinew_robot_tendon_name(const sinew_robot *robot,
                                    size_t joint);

// Name of the motor of that tendon. Positions and torques of a motor with a name of its own are those at its shaft.
//
// Realtime: yes.
//
// The caller sees to it: `robot` is null or a robot.
const char *sinew_robot_motor_name(const sinew_robot *robot,
                                   size_t joint);

// Index of a joint by its name.
//
// Realtime: yes.
//
// The caller sees to it: `robot` is null or a robot; `name` ends with a zero byte; `out` is null or may be written.
sinew_status sinew_robot_joint_index(const sinew_robot *robot, const char *name, size_t *out);

// Elongation of a joint's tendon, m, for an offset, rad; NaN where there is no tendon.
//
// Realtime: yes.
//
// The caller sees to it: `robot` is null or a robot.
double sinew_robot_elongation_m(const sinew_robot *robot, size_t joint, double offset_rad);

// Nothing stated: an unknown payload, temperatures as samples carry them, motor torque used, ropes that may creep.
//
// Realtime: yes.
sinew_offsets_options sinew_offsets_options_default(void);

// Makes the offsets of a robot since a baseline: the text of the file that `sinew baseline` writes. Free them with
// `sinew_offsets_free`; the robot may be freed before.
//
// `baseline` may be null: offsets are then against the zero of the encoders. `options` may be null: nothing is stated.
// `why` gets the sentence of a refusal, cut at `why_len` bytes; it may be null.
//
// Nothing is solved until a worker works. It is driven by `sinew_offsets_start_worker`, `sinew_offsets_work` or
// `sinew_offsets_take_worker`.
//
// Realtime: no, it allocates: all memory that the loop ever needs.
//
// The caller sees to it: `robot` is a robot; `baseline` is null or ends with a zero byte; `options` is null or points to options; `out` may be
// written; `why` is null or has room for `why_len` bytes.
sinew_status sinew_offsets_new(const sinew_robot *robot,
                               const char *baseline,
                               const sinew_offsets_options *options,
                               sinew_offsets **out,
                               char *why,
                               size_t why_len);

// Frees offsets; null is nothing. Where `sinew_offsets_start_worker` started a thread, it ends the thread and waits for
// the solution under way.
//
// Realtime: no.
//
// The caller sees to it: `offsets` is null or was made here and not freed before.
void sinew_offsets_free(sinew_offsets *offsets);

// Takes a sample, `dt_s` after the one before; of the first that does not matter.
//
// `q_rad`, `theta_rad`: joint and motor positions, rad, `joints` each, in the robot's order. `tau_m_nm`: motor torques,
// N·m, or null; `temperature_c`: °C, NaN where it is not known. `stepped`, which may be null, gets what became of it. A
// sample that lacks something is refused with `SINEW_STATUS_REFUSED` and changes nothing. Its time has passed all the
// same: the next `dt_s` counts from it.
//
// Realtime: yes. No allocation, lock, wait, log or clock.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile; arrays have `joints` numbers; `stepped` is null or may be written.
sinew_status sinew_offsets_step(sinew_offsets *offsets,
                                double dt_s,
                                const double *q_rad,
                                const double *theta_rad,
                                const double *tau_m_nm,
                                double temperature_c,
                                size_t joints,
                                sinew_stepped *stepped);

// The next sample does not go on where the last one was: the filters start anew, what is known stays.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile.
sinew_status sinew_offsets_interrupt(sinew_offsets *offsets);

// Reads the latest answer of the worker: `answer`, and the offset of every joint in `of_joints`, in the robot's order.
//
// Either may be null. Both come from the same answer, while two calls may come from two. `joints` is the number of the
// robot's joints, else the status is `SINEW_STATUS_LENGTH`. A rigid joint's numbers are NaN.
//
// Realtime: yes. No allocation, lock, wait, log or clock. It is for the thread that steps, as it takes the answer out of
// a triple buffer.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile; `answer` is null or may be written; `of_joints` is null or has room for
// `joints` offsets.
sinew_status sinew_offsets_read(sinew_offsets *offsets,
                                sinew_answer *answer,
                                sinew_offset *of_joints,
                                size_t joints);

// Why an offset is provisional, in a word or two, such as `step`; never null, never freed. Of a number that is no
// `sinew_provisional`: `unknown`.
//
// Realtime: yes.
const char *sinew_provisional_text(int provisional);

// Starts a thread that works until the offsets are freed: it takes blocks and solves windows. Once, before the loop.
//
// The thread inherits the scheduling policy and priority of the one that calls: call it before the loop's thread becomes
// a realtime one. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before. `SINEW_STATUS_THREAD`: the system
// has no thread to give, and the worker is as before.
//
// Realtime: no.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile.
sinew_status sinew_offsets_start_worker(sinew_offsets *offsets);

// Takes all blocks that are ready and solves the window where that is due, in the thread that calls: some hundredths of
// a second every 2 s of samples.
//
// For a program of a single thread, between samples. Beside a loop in another thread use `sinew_offsets_start_worker` or
// `sinew_offsets_take_worker`. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
//
// Realtime: no.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile.
sinew_status sinew_offsets_work(sinew_offsets *offsets);

// Takes the worker out, for a thread of the caller's own: `sinew_worker_work` in it, while the loop's thread uses the
// offsets. Free it with `sinew_worker_free`, before or after the offsets.
//
// `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
//
// Realtime: no.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile; `out` is null or may be written.
sinew_status sinew_offsets_take_worker(sinew_offsets *offsets,
                                       sinew_worker **out);

// Takes all blocks that are ready and solves the window where that is due: some hundredths of a second every 2 s of
// samples. Call it some fifty times a second, such as with a pause of 20 ms between calls.
//
// After its offsets were freed it does nothing more.
//
// Realtime: no.
//
// The caller sees to it: `worker` is used by nobody else meanwhile; its offsets may be.
sinew_status sinew_worker_work(sinew_worker *worker);

// Frees a worker; null is nothing. Its offsets then keep their last answer, and blocks are dropped and counted.
//
// Realtime: no.
//
// The caller sees to it: `worker` is null or was taken from offsets and not freed before.
void sinew_worker_free(sinew_worker *worker);

// Why the window could not be solved last time: the sentence goes to `why`, cut at `why_len` bytes. It is empty where
// the window was solved, or has never been tried.
//
// Realtime: no, it may wait for the worker.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile; `why` is null or has room for `why_len` bytes.
sinew_status sinew_offsets_error(const sinew_offsets *offsets,
                                 char *why,
                                 size_t why_len);

// Writes the last solution as a baseline's text, the baseline of the next session, into `text`, with a zero at its end.
//
// `recording` names this session, which ended at `end_time_ns` of its clock. `length` gets the bytes needed, zero
// included; it may be null. With `text` null or `capacity` too small nothing is written and the status is
// `SINEW_STATUS_SHORT`. While an offset is provisional the status is `SINEW_STATUS_PROVISIONAL`.
//
// Realtime: no, it allocates and may wait for the worker.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile; `recording` ends with a zero byte; `text` is null or has room for
// `capacity` bytes; `length` is null or may be written.
sinew_status sinew_offsets_save(sinew_offsets *offsets,
                                const char *recording,
                                int64_t end_time_ns,
                                char *text,
                                size_t capacity,
                                size_t *length);

// Makes an observer: gain `K_I`, 1/s (20 serves most encoders), and the cut-off of the velocity filter, rad/s (40). Free it
// with `sinew_observer_free`; the robot may be freed before.
//
// Realtime: no, it allocates: all memory that is ever needed.
//
// The caller sees to it: `robot` is a robot; `out` may be written; `why` is null or has room for `why_len` bytes.
sinew_status sinew_observer_new(const sinew_robot *robot,
                                double gain_per_s,
                                double cutoff_rad_per_s,
                                sinew_observer **out,
                                char *why,
                                size_t why_len);

// Frees an observer; null is nothing.
//
// Realtime: no.
//
// The caller sees to it: `observer` is null or was made here and not freed before.
void sinew_observer_free(sinew_observer *observer);

// Steps by `dt_s` to a sample; the first one only starts the filters and doesn't look at `dt_s`.
//
// `q_rad`, `theta_rad`: `joints` each. `tau_ext_nm`: the known external torque, or null. A sample that is refused changes
// nothing.
//
// Realtime: yes. No allocation, lock, log or clock.
//
// The caller sees to it: `observer` is used by nobody else meanwhile; arrays have `joints` numbers.
sinew_status sinew_observer_step(sinew_observer *observer,
                                 double dt_s,
                                 const double *q_rad,
                                 const double *theta_rad,
                                 const double *tau_ext_nm,
                                 size_t joints);

// The next sample is a start: after a gap.
//
// Realtime: yes.
//
// The caller sees to it: `observer` is used by nobody else meanwhile.
sinew_status sinew_observer_reset(sinew_observer *observer);

// Offset `(theta_measured − q) − tau_el / K` of every joint, rad; NaN of a rigid one.
//
// Realtime: yes.
//
// The caller sees to it: `observer` is an observer; `delta_e_rad` has room for `joints` numbers.
sinew_status sinew_observer_delta_e(const sinew_observer *observer, double *delta_e_rad, size_t joints);

// Elastic torque of every joint, N·m.
//
// Realtime: yes.
//
// The caller sees to it: `observer` is an observer; `tau_el_nm` has room for `joints` numbers.
sinew_status sinew_observer_tau_el(const sinew_observer *observer, double *tau_el_nm, size_t joints);

// Whether the start has faded to a thousandth; false of null.
//
// Realtime: yes.
//
// The caller sees to it: `observer` is null or an observer.
bool sinew_observer_is_settled(const sinew_observer *observer);

// Makes an arm with its workspace. Free it with `sinew_arm_free`; the robot may be freed before.
//
// Realtime: no, it allocates.
//
// The caller sees to it: `robot` is a robot; `out` may be written; `why` is null or has room for `why_len` bytes.
sinew_status sinew_arm_new(const sinew_robot *robot, sinew_arm **out, char *why, size_t why_len);

// Frees an arm; null is nothing.
//
// Realtime: no.
//
// The caller sees to it: `arm` is null or was made here and not freed before.
void sinew_arm_free(sinew_arm *arm);

// Momentum terms: `p = M(q) dq`, `C(q, dq)ᵀ dq` and `g(q)`, `joints` each.
//
// Realtime: yes. One pass over the joints.
//
// The caller sees to it: `arm` is used by nobody else meanwhile; arrays have `joints` numbers.
sinew_status sinew_arm_momentum(sinew_arm *arm,
                                const double *q_rad,
                                const double *dq_rad_s,
                                double *p,
                                double *ct_dq,
                                double *g,
                                size_t joints);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SINEW_H */
