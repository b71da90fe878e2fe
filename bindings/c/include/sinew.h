/* Sinew: offsets of tendons inside a control loop.
 *
 * Handles are made by `_new` and freed by `_free`. A handle belongs to one thread at a time; a robot may be
 * read from several. Made by bindings/c/header/write: change the Rust sources, not this. */

#ifndef SINEW_H
#define SINEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Version of this interface: raised when a program compiled against an older header may no longer be right.
#define SINEW_ABI_VERSION 1

// What a call says.
typedef enum {
    // It was done.
    SINEW_STATUS_OK = 0,
    // A pointer that must not be null is.
    SINEW_STATUS_NULL = 1,
    // An array has another length than the robot has joints, or there is no such joint.
    SINEW_STATUS_LENGTH = 2,
    // An input is NaN or infinite. Nothing has changed.
    SINEW_STATUS_NOT_FINITE = 3,
    // The time step can't be one. Nothing has changed.
    SINEW_STATUS_TIME_STEP = 4,
    // A sample can't be used; what lacks stands beside. Nothing has changed.
    SINEW_STATUS_REFUSED = 5,
    // A text or a value was refused; the sentence says why.
    SINEW_STATUS_INVALID = 6,
    // A text is not UTF-8.
    SINEW_STATUS_ENCODING = 7,
    // The buffer is too short; the length needed stands beside.
    SINEW_STATUS_SHORT = 8,
    // The offsets are in doubt and can't be saved.
    SINEW_STATUS_IN_DOUBT = 9,
    // Sinew has a fault of its own. The handle must only be freed.
    SINEW_STATUS_PANIC = 10,
    // It must be said before the first sample, and samples have come. Nothing has changed.
    SINEW_STATUS_LATE = 11,
} sinew_status;

// What became of a sample.
typedef enum {
    // It was taken.
    SINEW_STEPPED_TAKEN = 0,
    // It was taken as the first one: at the start, or after a pause.
    SINEW_STEPPED_RESTARTED = 1,
    // It was taken, and the offsets are new: some five times a second.
    SINEW_STEPPED_UPDATED = 2,
    // Refused: a joint position is missing or not finite.
    SINEW_STEPPED_NO_JOINT_POSITION = 3,
    // Refused: an elastic joint's motor position is missing or not finite.
    SINEW_STEPPED_NO_MOTOR_POSITION = 4,
    // Refused: its time is not after that of the last sample taken.
    SINEW_STEPPED_NO_TIME_STEP = 5,
    // Refused: a value is too large to be one.
    SINEW_STEPPED_OUT_OF_RANGE = 6,
} sinew_stepped;

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

// Offsets of a robot's tendons since a baseline. One thread at a time.
typedef struct sinew_offsets sinew_offsets;

// A robot: joints, masses, stiffness, tendons. Never changes; may be read from several threads.
typedef struct sinew_robot sinew_robot;

// What is known of a session.
typedef struct {
    // What the gripper holds: a `sinew_payload`.
    uint32_t payload;
    // Its mass where it is stated, kg.
    double payload_kg;
    // How well that is known, one standard deviation, kg; NaN: 2 %.
    double payload_deviation_kg;
    // Temperature where samples don't carry it, °C; NaN: not stated.
    double temperature_c;
    // How well that is known, one standard deviation, K; NaN: 2 K.
    double temperature_deviation_k;
    // Whether a motor torque that samples carry is used.
    bool motor_torque;
} sinew_offsets_options;

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

// Nothing stated: an unknown payload, temperatures as samples carry them, motor torque used.
//
// Realtime: yes.
sinew_offsets_options sinew_offsets_options_default(void);

// Makes the offsets of a robot since a baseline: the text of the file that `sinew baseline` writes. Free it with
// `sinew_offsets_free`; the robot may be freed before.
//
// `options` may be null: nothing is stated. `why` gets the sentence of a refusal, cut at `why_len` bytes; it may be
// null.
//
// Realtime: no, it allocates: all memory that is ever needed.
//
// The caller sees to it: `robot` is a robot; `baseline` ends with a zero byte; `options` is null or points to options; `out` may be written;
// `why` is null or has room for `why_len` bytes.
sinew_status sinew_offsets_new(const sinew_robot *robot,
                               const char *baseline,
                               const sinew_offsets_options *options,
                               sinew_offsets **out,
                               char *why,
                               size_t why_len);

// Frees offsets; null is nothing.
//
// Realtime: no.
//
// The caller sees to it: `offsets` is null or was made here and not freed before.
void sinew_offsets_free(sinew_offsets *offsets);

// Bounds the work of every step that follows: a small, fixed part of a block's, so that the same offsets come one block,
// 0.2 s, later. Without it the sample that completes a block does all its work: milliseconds at seven joints.
//
// `period_max_s`: the longest time between samples while all is well, s. Where samples come at longer ones, a block that finds
// the one before undone is left out; `sinew_offsets_left_out` counts these.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile.
sinew_status sinew_offsets_bound_work(sinew_offsets *offsets,
                                      double period_max_s);

// Blocks left out because work on the one before wasn't done; 0 unless samples come at longer times than
// `sinew_offsets_bound_work` was told.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` are offsets; `blocks` is null or may be written.
sinew_status sinew_offsets_left_out(const sinew_offsets *offsets, uint64_t *blocks);

// Takes a sample, `dt_s` after the one before; of the first that doesn't matter.
//
// `q_rad`, `theta_rad`: joint and motor positions, `joints` each, in the robot's order. `tau_m_nm`: motor torques, or null;
// `temperature_c`: NaN where it isn't known. `stepped`, which may be null, says what became of it. A sample that lacks
// something is refused and changes nothing. Its time has passed all the same: the next `dt_s` counts from it.
//
// Realtime: yes. No allocation, lock, log or clock.
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

// The next sample doesn't go on where the last one was: the filters start anew, what is known stays.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile.
sinew_status sinew_offsets_interrupt(sinew_offsets *offsets);

// Offset of a joint since the baseline, rad, with one standard deviation, and whether offsets are in doubt: in the first
// half minute, while something leans on the arm, after a slip that hasn't settled. Any of the three may be null.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` are offsets; places are null or may be written.
sinew_status sinew_offsets_read(const sinew_offsets *offsets,
                                size_t joint,
                                double *offset_rad,
                                double *deviation_rad,
                                bool *in_doubt);

// Probability, 0 to 1, that a joint's stiffness has changed since the baseline: a strand may have failed.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` are offsets; `probability` is null or may be written.
sinew_status sinew_offsets_stiffness_changed(const sinew_offsets *offsets, size_t joint, double *probability);

// What a temperature that isn't known, now or in the baseline, adds to the deviation of a joint's offset, rad; 0 where both are known.
// The deviation that is read holds it: it is the tolerance of robot.toml, so warmth far beyond that reads as stretch.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` are offsets; `deviation_rad` is null or may be written.
sinew_status sinew_offsets_unknown_temperature(const sinew_offsets *offsets,
                                               size_t joint,
                                               double *deviation_rad);

// A constant force from outside at the tool, as far as it is known: a hose, a cable that drags.
//
// `probability`, 0 to 1: that one acts. `force_n`, `deviation_n`: three each, along the axes of the base, N, if one does. Each may be
// null. Where none is looked for (`external_force_n = 0` in robot.toml) all are NaN.
//
// Realtime: yes.
//
// The caller sees to it: `offsets` are offsets; `probability` is null or may be written; `force_n` and `deviation_n` are null or have room for three.
sinew_status sinew_offsets_external_force(const sinew_offsets *offsets,
                                          double *probability,
                                          double *force_n,
                                          double *deviation_n);

// How fast offsets may move, rad/s, a standard deviation: 0 of ropes that don't creep, such as steel. It is 1 mrad a minute unless
// this says otherwise, before the first sample.
//
// Realtime: no.
//
// The caller sees to it: `offsets` is used by nobody else meanwhile.
sinew_status sinew_offsets_expect_creep(sinew_offsets *offsets,
                                        double deviation_rad_per_s);

// Writes what is known now as a baseline's text, the baseline of the next session, into `text`, with a zero at its end.
//
// `recording` names this session, which ended at `end_time_ns` of its clock. `length` gets the bytes needed, zero included; it
// may be null. With `text` null or `capacity` too small nothing is written and the answer is `SINEW_STATUS_SHORT`. While the offsets
// are in doubt the answer is `SINEW_STATUS_IN_DOUBT`.
//
// Realtime: no, it allocates.
//
// The caller sees to it: `offsets` are offsets; `recording` ends with a zero byte; `text` is null or has room for `capacity` bytes; `length` is null
// or may be written.
sinew_status sinew_offsets_save(const sinew_offsets *offsets,
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
