/* Sinew: offsets of tendons inside a control loop.
 *
 * Handles are made by `_new` and freed by `_free`. Each function states its real-time class and which threads may call it.
 *
 * Made by bindings/c/header/write: change the Rust sources, not this. */

#ifndef SINEW_H
#define SINEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Version of this interface, incremented by changes that are incompatible with programs compiled against an older header.
#define SINEW_ABI_VERSION 2

// Status of a call.
typedef enum {
    // Call completed without error.
    SINEW_STATUS_OK = 0,
    // A required pointer is null.
    SINEW_STATUS_NULL = 1,
    // The length of an array differs from the number of joints, or a joint index is out of range.
    SINEW_STATUS_LENGTH = 2,
    // An input is NaN or infinite. Nothing has changed.
    SINEW_STATUS_NOT_FINITE = 3,
    // Invalid time step. Nothing has changed.
    SINEW_STATUS_TIME_STEP = 4,
    // Unusable sample; the step result names the reason. Nothing has changed.
    SINEW_STATUS_REJECTED = 5,
    // Invalid text or value; the message states the reason.
    SINEW_STATUS_INVALID = 6,
    // A text is not UTF-8.
    SINEW_STATUS_ENCODING = 7,
    // Buffer too short; the required length is returned.
    SINEW_STATUS_SHORT = 8,
    // An offset is provisional: the offsets cannot be saved now.
    SINEW_STATUS_PROVISIONAL = 9,
    // Internal error of Sinew. The handle may only be freed.
    SINEW_STATUS_PANIC = 10,
    // The worker was started or taken before. Nothing has changed.
    SINEW_STATUS_WORKER_TAKEN = 11,
    // The system could not create a thread.
    SINEW_STATUS_THREAD = 12,
} sinew_status;

// Result of a step.
typedef enum {
    // Sample accepted by the estimator.
    SINEW_STEPPED_ACCEPTED = 0,
    // Accepted as the first sample, at the start or after a gap.
    SINEW_STEPPED_RESTARTED = 1,
    // Accepted; it completed a block of about 0.2 s for the worker.
    SINEW_STEPPED_BLOCK = 2,
    // Rejected: a joint position is missing or not finite.
    SINEW_STEPPED_NO_JOINT_POSITION = 3,
    // Rejected: the motor position of an elastic joint is missing or not finite.
    SINEW_STEPPED_NO_MOTOR_POSITION = 4,
    // Rejected: its time is not after that of the last accepted sample.
    SINEW_STEPPED_NO_TIME_STEP = 5,
    // Rejected: a value is implausibly large.
    SINEW_STEPPED_OUT_OF_RANGE = 6,
} sinew_stepped;

// Reason for a provisional offset: its interval is wide, or may still change by more than it states.
typedef enum {
    // Not provisional: the offset is settled.
    SINEW_PROVISIONAL_NONE = 0,
    // No window has been solved yet.
    SINEW_PROVISIONAL_STARTING = 1,
    // A step of this offset explains the newest blocks. The interval is the hull of both hypotheses.
    SINEW_PROVISIONAL_STEP = 2,
    // The window contains a change so late that it may be a contact that has not ended.
    SINEW_PROVISIONAL_CHANGE_NEAR_END = 3,
    // Too many blocks are rejected as outliers for the remaining ones to be representative.
    SINEW_PROVISIONAL_REJECTED = 4,
    // The window could not be solved: the estimate is the previous one. `sinew_offsets_error` returns the message.
    SINEW_PROVISIONAL_NOT_SOLVED = 5,
} sinew_provisional;

// Kind of the payload in the gripper.
typedef enum {
    // Unknown payload, estimated jointly.
    SINEW_PAYLOAD_UNKNOWN = 0,
    // Gripper without a payload.
    SINEW_PAYLOAD_EMPTY = 1,
    // Payload of specified mass.
    SINEW_PAYLOAD_STATED = 2,
} sinew_payload;

// Arm with the workspace of the momentum terms. Not thread-safe: one thread at a time.
typedef struct sinew_arm sinew_arm;

// Observer of a robot. Not thread-safe: one thread at a time.
typedef struct sinew_observer sinew_observer;

// Offsets of a robot's tendons since a baseline, for the control loop. Not thread-safe: one thread at a time.
typedef struct sinew_offsets sinew_offsets;

// Robot: joints, masses, stiffness, tendons. Immutable; may be read from several threads.
typedef struct sinew_robot sinew_robot;

// Worker that solves the windows of offsets. One thread at a time, which may differ from that of the offsets.
typedef struct sinew_worker sinew_worker;

// Options of a session.
typedef struct {
    // Payload in the gripper, a `sinew_payload`.
    uint32_t payload;
    // Mass of a specified payload, kg.
    double payload_kg;
    // Standard deviation of the payload mass, kg; NaN: 2 %.
    double payload_std_kg;
    // Temperature for samples without one, °C; NaN: not specified.
    double temperature_c;
    // Standard deviation of the temperature, K; NaN: 2 K.
    double temperature_std_k;
    // Whether the motor torque of samples is used.
    bool motor_torque;
    // Whether ropes may creep within the session; false for steel ropes.
    bool creep;
} sinew_offsets_options;

// Estimate of all quantities except the offsets. Times are in s since the first sample.
typedef struct {
    // Number of blocks that the worker has processed.
    uint64_t blocks;
    // Number of completed blocks that are neither in the answer nor dropped: one or two while the worker keeps up. An
    // increasing number means that the answer is outdated.
    uint64_t blocks_behind;
    // Number of blocks dropped because the worker was late by more than ten seconds.
    uint64_t blocks_dropped;
    // Midpoint of the last processed block, s; NaN before the first block.
    double time_s;
    // Midpoint of the last block of the solution, s; NaN before the first solution. The age of the solution is `time_s - solved_s`.
    double solved_s;
    // Probability, 0 to 1, of a contact in the last block; 0 until a window has been solved.
    double contact_probability;
    // Probability, 0 to 1, of a constant external force at the tool, such as a hose; NaN if none was detected.
    double external_force_probability;
    // Estimated external force in the base frame, N, if it acts; the offsets account for it. NaN if none was detected.
    double external_force_n[3];
    // Standard deviation of each component of the external force, N; NaN if none was detected.
    double external_force_std_n[3];
} sinew_answer;

// Offset of the tendon of one joint.
typedef struct {
    // Posterior mean since the baseline, rad; NaN until a window has been solved, and for a rigid joint.
    double offset_rad;
    // Standard deviation of the offset, rad; NaN if the offset is NaN. The 95 % interval is the offset ± 1.96 times this
    // value.
    double offset_std_rad;
    // Contribution of an unknown temperature, now or in the baseline, to the standard deviation, rad, included in it; 0
    // if both are specified, NaN for a rigid joint.
    double unknown_temperature_rad;
    // Probability, 0 to 1, that the stiffness has changed since the baseline; NaN if it is not tested.
    double stiffness_changed_probability;
    // Time of the step or change that makes the offset provisional, s since the first sample; NaN if there is none.
    double since_s;
    // Posterior probability of a step, 0 to 1; NaN if none is suspected.
    double step_probability;
    // Reason for a provisional offset.
    sinew_provisional provisional;
} sinew_offset;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the interface that the library was built with: compare with `SINEW_ABI_VERSION`.
//
// Realtime: yes.
//
// Threads: any number at once.
uint32_t sinew_abi_version(void);

// Version of Sinew, such as `0.1.0`; never null, never freed.
//
// Realtime: yes.
//
// Threads: any number at once.
const char *sinew_version(void);

// Text of a status; never null, never freed. An invalid number also has a text.
//
// Realtime: yes.
//
// Threads: any number at once.
const char *sinew_status_text(int status);

// Creates a robot from the texts of `robot.toml` and of a URDF. Free it with `sinew_robot_free`.
//
// `reason` receives the error message, truncated to `why_len` bytes; it may be null.
//
// Realtime: no, it allocates.
//
// Threads: any number at once.
//
// Preconditions: Texts end with a zero byte; `out` may be written; `reason` is null or has room for `why_len` bytes.
sinew_status sinew_robot_new(const char *robot_toml,
                             const char *urdf,
                             sinew_robot **out,
                             char *reason,
                             size_t why_len);

// Creates a robot from its folder, or from the path of its `robot.toml`. Free it with `sinew_robot_free`.
//
// Realtime: no, the function reads files.
//
// Threads: any number at once.
//
// Preconditions: As `sinew_robot_new`.
sinew_status sinew_robot_open(const char *place, sinew_robot **out, char *reason, size_t why_len);

// Frees a robot; null has no effect. Objects created from it remain valid.
//
// Realtime: no.
//
// Threads: no other call uses the handle.
//
// Preconditions: `robot` is null or was created here and not freed before.
void sinew_robot_free(sinew_robot *robot);

// Number of joints of a robot plus its additional tendons, such as a second strand at a joint; 0 for null.
//
// Arrays of samples and offsets have this number of entries. The joint position of an additional tendon is 0.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot.
size_t sinew_robot_joints(const sinew_robot *robot);

// Name of a joint, valid as long as the robot; null if there is no such joint.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot.
const char *sinew_robot_joint_name(const sinew_robot *robot, size_t joint);

// Name of the tendon of a joint, valid as long as the robot: the name of the joint, unless `robot.toml` has
// `[[tendons]]`; null if there is no such joint.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot.
const char *sinew_robot_tendon_name(const sinew_robot *robot, size_t joint);

// Name of the motor of a joint's tendon. Positions and torques of a separately named motor refer to its shaft.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot.
const char *sinew_robot_motor_name(const sinew_robot *robot,
                                   size_t joint);

// Finds the index of a joint by its name.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot; `name` ends with a zero byte; `out` is null or may be written.
sinew_status sinew_robot_joint_index(const sinew_robot *robot, const char *name, size_t *out);

// Whether a joint has a tendon or another elastic transmission; false for a rigid joint and for an invalid index.
//
// A rigid joint has no offset, and its motor position is ignored.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot.
bool sinew_robot_is_elastic(const sinew_robot *robot,
                            size_t joint);

// Elongation of a joint's tendon, m, for an offset, rad; NaN if the joint has no tendon.
//
// Realtime: yes.
//
// Threads: any number at once, as long as the robot exists.
//
// Preconditions: `robot` is null or a robot.
double sinew_robot_elongation_m(const sinew_robot *robot, size_t joint, double offset_rad);

// Default options: unknown payload, temperature from the samples, motor torque used, creep allowed.
//
// Realtime: yes.
//
// Threads: any number at once.
sinew_offsets_options sinew_offsets_options_default(void);

// Creates the offsets of a robot since a baseline, given as the text of a file of `sinew baseline`. Free them with
// `sinew_offsets_free`; the robot may be freed before.
//
// `baseline` may be null: offsets then refer to the encoder zero. `options` may be null: the defaults apply. `reason`
// receives the error message, truncated to `why_len` bytes; it may be null.
//
// Windows are solved by the worker only, which is run by `sinew_offsets_start_worker`, `sinew_offsets_work` or
// `sinew_offsets_take_worker`.
//
// Realtime: no, it allocates all memory of the loop.
//
// Threads: any number at once.
//
// Preconditions: `robot` is a robot; `baseline` is null or ends with a zero byte; `options` is null or points to options; `out` may be
// written; `reason` is null or has room for `why_len` bytes.
sinew_status sinew_offsets_new(const sinew_robot *robot,
                               const char *baseline,
                               const sinew_offsets_options *options,
                               sinew_offsets **out,
                               char *reason,
                               size_t why_len);

// Frees offsets; null has no effect. A thread started by `sinew_offsets_start_worker` is stopped, after its present
// solution.
//
// Realtime: no.
//
// Threads: no other call uses the handle.
//
// Preconditions: `offsets` is null or was created by `sinew_offsets_new` and not freed before.
void sinew_offsets_free(sinew_offsets *offsets);

// Adds a sample, `dt_s` after the previous one; ignored for the first sample.
//
// `q_rad`, `theta_rad`: joint and motor positions, rad, `joints` each, in the robot's order. `tau_m_nm`: motor torques,
// N·m, or null; `temperature_c`: °C, NaN if not measured. `stepped`, which may be null, receives the result of the
// step. An incomplete sample is rejected with `SINEW_STATUS_REJECTED` and leaves the estimate unchanged. The clock still
// advances: the next `dt_s` counts from this sample.
//
// Realtime: yes. No allocation, lock, wait, log or clock.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently; arrays have `joints` numbers; `stepped` is null or may be written.
sinew_status sinew_offsets_step(sinew_offsets *offsets,
                                double dt_s,
                                const double *q_rad,
                                const double *theta_rad,
                                const double *tau_m_nm,
                                double temperature_c,
                                size_t joints,
                                sinew_stepped *stepped);

// Marks a gap before the next sample: the filters are re-initialised, the estimates are kept.
//
// Realtime: yes.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently.
sinew_status sinew_offsets_interrupt(sinew_offsets *offsets);

// Reads the latest answer of the worker: `answer`, and the offset of every joint in `of_joints`, in the robot's order.
//
// Either may be null. Both come from the same answer, while two calls may come from two. `joints` is the number of the
// robot's joints, else the status is `SINEW_STATUS_LENGTH`. The values of a rigid joint are NaN.
//
// Realtime: yes. No allocation, lock, wait, log or clock. Call it in the thread that steps, because it takes the
// answer from a triple buffer.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently; `answer` is null or may be written; `of_joints` is null or has room for
// `joints` offsets.
sinew_status sinew_offsets_read(sinew_offsets *offsets,
                                sinew_answer *answer,
                                sinew_offset *of_joints,
                                size_t joints);

// Short name of the reason for a provisional offset, such as `step`; never null, never freed. For an invalid number:
// `unknown`.
//
// Realtime: yes.
//
// Threads: any number at once.
const char *sinew_provisional_text(int provisional);

// Starts a thread that processes blocks and solves windows until the offsets are freed. Call it once, before the loop.
//
// The thread inherits the scheduling policy and priority of the calling thread: call it before that thread becomes
// a realtime thread. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before. `SINEW_STATUS_THREAD`: the system
// could not create a thread, and the worker is unchanged.
//
// Realtime: no.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently.
sinew_status sinew_offsets_start_worker(sinew_offsets *offsets);

// Processes all completed blocks and solves the window if due, in the calling thread. A solution takes some hundredths
// of a second, every 2 s of samples.
//
// For single-threaded programs, between samples. For a loop in another thread use `sinew_offsets_start_worker` or
// `sinew_offsets_take_worker`. `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
//
// Realtime: no.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently.
sinew_status sinew_offsets_work(sinew_offsets *offsets);

// Takes the worker, for a thread of the caller that calls `sinew_worker_work` while the thread of the loop uses the
// offsets. Free it with `sinew_worker_free`, before or after the offsets.
//
// `SINEW_STATUS_WORKER_TAKEN`: the worker was started or taken before.
//
// Realtime: no.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently; `out` is null or may be written.
sinew_status sinew_offsets_take_worker(sinew_offsets *offsets,
                                       sinew_worker **out);

// Processes all completed blocks and solves the window if due, which takes some hundredths of a second, every 2 s of
// samples. Call it about fifty times a second, for example with a pause of 20 ms between calls.
//
// After its offsets were freed it has no effect.
//
// Realtime: no.
//
// Threads: one call per worker at a time; calls of its offsets may be concurrent.
//
// Preconditions: `worker` is not used concurrently; its offsets may be.
sinew_status sinew_worker_work(sinew_worker *worker);

// Frees a worker; null has no effect. Its offsets then keep their last answer, and blocks are dropped and counted.
//
// Realtime: no.
//
// Threads: no other call uses the handle.
//
// Preconditions: `worker` is null or was taken from offsets and not freed before.
void sinew_worker_free(sinew_worker *worker);

// Reason why the last window could not be solved: the message is written to `reason`, truncated to `why_len` bytes. It is
// empty if the last window was solved or none has been tried.
//
// Realtime: no, it may wait for the worker.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently; `reason` is null or has room for `why_len` bytes.
sinew_status sinew_offsets_error(const sinew_offsets *offsets,
                                 char *reason,
                                 size_t why_len);

// Writes the last solution to `text` as a zero-terminated baseline, which serves as the baseline of the next session.
//
// `recording` names this session, which ended at `end_time_ns` of its clock. `length` receives the required bytes,
// including the zero; it may be null. With `text` null or `capacity` too small nothing is written and the status is
// `SINEW_STATUS_SHORT`. While an offset is provisional the status is `SINEW_STATUS_PROVISIONAL`.
//
// Realtime: no, it allocates and may wait for the worker.
//
// Threads: one call per handle at a time.
//
// Preconditions: `offsets` is not used concurrently; `recording` ends with a zero byte; `text` is null or has room for
// `capacity` bytes; `length` is null or may be written.
sinew_status sinew_offsets_save(sinew_offsets *offsets,
                                const char *recording,
                                int64_t end_time_ns,
                                char *text,
                                size_t capacity,
                                size_t *length);

// Creates an observer with gain `K_I`, 1/s (20 suits most encoders), and cut-off of the velocity filter, rad/s (40). Free
// it with `sinew_observer_free`; the robot may be freed before.
//
// Realtime: no, it allocates all memory of the observer.
//
// Threads: any number at once.
//
// Preconditions: `robot` is a robot; `out` may be written; `reason` is null or has room for `why_len` bytes.
sinew_status sinew_observer_new(const sinew_robot *robot,
                                double gain_per_s,
                                double cutoff_rad_per_s,
                                sinew_observer **out,
                                char *reason,
                                size_t why_len);

// Frees an observer; null has no effect.
//
// Realtime: no.
//
// Threads: no other call uses the handle.
//
// Preconditions: `observer` is null or was created by `sinew_observer_new` and not freed before.
void sinew_observer_free(sinew_observer *observer);

// Advances the observer by `dt_s` to a sample; the first sample initialises the filters and ignores `dt_s`.
//
// `q_rad`, `theta_rad`: `joints` each. `tau_ext_nm`: measured external torque, or null. A rejected sample leaves the
// observer unchanged.
//
// Realtime: yes. No allocation, lock, log or clock.
//
// Threads: one call per handle at a time.
//
// Preconditions: `observer` is not used concurrently; arrays have `joints` numbers.
sinew_status sinew_observer_step(sinew_observer *observer,
                                 double dt_s,
                                 const double *q_rad,
                                 const double *theta_rad,
                                 const double *tau_ext_nm,
                                 size_t joints);

// Marks a gap: the next sample re-initialises the filters.
//
// Realtime: yes.
//
// Threads: one call per handle at a time.
//
// Preconditions: `observer` is not used concurrently.
sinew_status sinew_observer_reset(sinew_observer *observer);

// Offset `(theta_measured − q) − tau_el / K` of every joint, rad; NaN for a rigid joint.
//
// Realtime: yes.
//
// Threads: reads may be concurrent with each other, not with a step or a reset.
//
// Preconditions: `observer` is an observer; `delta_e_rad` has room for `joints` numbers.
sinew_status sinew_observer_delta_e(const sinew_observer *observer, double *delta_e_rad, size_t joints);

// Elastic torque of every joint, N·m.
//
// Realtime: yes.
//
// Threads: reads may be concurrent with each other, not with a step or a reset.
//
// Preconditions: `observer` is an observer; `tau_el_nm` has room for `joints` numbers.
sinew_status sinew_observer_tau_el(const sinew_observer *observer, double *tau_el_nm, size_t joints);

// Whether the initial transient has decayed to a thousandth; false for null.
//
// Realtime: yes.
//
// Threads: reads may be concurrent with each other, not with a step or a reset.
//
// Preconditions: `observer` is null or an observer.
bool sinew_observer_is_settled(const sinew_observer *observer);

// Creates an arm with its workspace. Free it with `sinew_arm_free`; the robot may be freed before.
//
// Realtime: no, it allocates.
//
// Threads: any number at once.
//
// Preconditions: `robot` is a robot; `out` may be written; `reason` is null or has room for `why_len` bytes.
sinew_status sinew_arm_new(const sinew_robot *robot, sinew_arm **out, char *reason, size_t why_len);

// Frees an arm; null has no effect.
//
// Realtime: no.
//
// Threads: no other call uses the handle.
//
// Preconditions: `arm` is null or was created by `sinew_arm_new` and not freed before.
void sinew_arm_free(sinew_arm *arm);

// Computes the momentum terms `p = M(q) dq`, `C(q, dq)ᵀ dq` and `g(q)`, `joints` each.
//
// Realtime: yes. One pass over the joints.
//
// Threads: one call per handle at a time.
//
// Preconditions: `arm` is not used concurrently; arrays have `joints` numbers.
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
