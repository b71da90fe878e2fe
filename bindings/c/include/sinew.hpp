// Sinew for C++17: the handles of sinew.h as RAII objects, with exceptions for errors of construction.
//
// Constructors throw sinew::error with the message; steps are noexcept and return a status, so that a control loop
// neither unwinds nor allocates. Arrays are `double *` with one value per joint of the robot.
#ifndef SINEW_HPP
#define SINEW_HPP

#include "sinew.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace sinew {

/// Error message with its status.
class error : public std::runtime_error {
public:
    error(sinew_status status, const std::string &sentence)
        : std::runtime_error(sentence.empty() ? sinew_status_text(status) : sentence), status_(status) {}
    sinew_status status() const noexcept { return status_; }

private:
    sinew_status status_;
};

namespace detail {

/// Calls a constructor of sinew.h and owns its handle.
template <class Handle, class Make>
Handle *made(Make &&make) {
    Handle *handle = nullptr;
    char why[1024] = "";
    const sinew_status status = make(&handle, why, sizeof why);
    if (status != SINEW_STATUS_OK) throw error(status, why);
    return handle;
}

template <auto Free>
struct freed {
    template <class Handle>
    void operator()(Handle *handle) const noexcept {
        Free(handle);
    }
};

template <class Handle, auto Free>
using owned = std::unique_ptr<Handle, freed<Free>>;

}  // namespace detail

/// Throws unless the version of the library equals that of this header. Call it once, at the start.
inline void require_version() {
    if (sinew_abi_version() != SINEW_ABI_VERSION)
        throw error(SINEW_STATUS_INVALID, "libsinew is of version " + std::to_string(sinew_abi_version()) +
                                              " of the interface, and the header of " +
                                              std::to_string(SINEW_ABI_VERSION));
}

/// Robot: joints, masses, stiffness, tendons. Immutable.
class robot {
public:
    /// Loads a robot from its folder, or from the path of its robot.toml.
    static robot open(const std::string &place) {
        return robot(detail::made<sinew_robot>([&](sinew_robot **out, char *why, std::size_t room) {
            return sinew_robot_open(place.c_str(), out, why, room);
        }));
    }
    /// Creates a robot from the texts of robot.toml and of a URDF.
    static robot of(const std::string &robot_toml, const std::string &urdf) {
        return robot(detail::made<sinew_robot>([&](sinew_robot **out, char *why, std::size_t room) {
            return sinew_robot_new(robot_toml.c_str(), urdf.c_str(), out, why, room);
        }));
    }
    std::size_t joints() const noexcept { return sinew_robot_joints(get()); }
    /// Name of a joint; the index is below joints().
    std::string joint_name(std::size_t joint) const {
        const char *name = sinew_robot_joint_name(get(), joint);
        if (name == nullptr) throw error(SINEW_STATUS_LENGTH, "");
        return name;
    }
    std::size_t joint_index(const std::string &name) const {
        std::size_t index = 0;
        const sinew_status status = sinew_robot_joint_index(get(), name.c_str(), &index);
        if (status != SINEW_STATUS_OK) throw error(status, "the robot has no joint " + name);
        return index;
    }
    /// Whether a joint has a tendon or another elastic transmission.
    bool is_elastic(std::size_t joint) const noexcept { return sinew_robot_is_elastic(get(), joint); }
    /// Elongation of a joint's tendon, m, for an offset, rad; NaN if the joint has no tendon.
    double elongation_m(std::size_t joint, double offset_rad) const noexcept {
        return sinew_robot_elongation_m(get(), joint, offset_rad);
    }
    const sinew_robot *get() const noexcept { return handle_.get(); }

private:
    explicit robot(sinew_robot *handle) noexcept : handle_(handle) {}
    detail::owned<sinew_robot, sinew_robot_free> handle_;
};

/// Worker of offsets, for a thread of the caller. One thread at a time; it may outlive its offsets.
class worker {
public:
    /// Processes blocks and solves windows: some hundredths of a second every 2 s. Call it about fifty times a
    /// second; not realtime.
    [[nodiscard]] sinew_status work() noexcept { return sinew_worker_work(handle_.get()); }

private:
    friend class offsets;
    explicit worker(sinew_worker *handle) noexcept : handle_(handle) {}
    detail::owned<sinew_worker, sinew_worker_free> handle_;
};

/// Absolute offsets since a baseline. One thread at a time.
class offsets {
public:
    /// baseline: the text of the file that `sinew baseline` writes; without one, offsets refer to the encoder zero.
    explicit offsets(const robot &robot, const std::optional<std::string> &baseline = std::nullopt,
                     const sinew_offsets_options &options = sinew_offsets_options_default())
        : handle_(detail::made<sinew_offsets>([&](sinew_offsets **out, char *why, std::size_t room) {
              return sinew_offsets_new(robot.get(), baseline ? baseline->c_str() : nullptr, &options, out, why, room);
          })),
          joints_(robot.joints()) {}
    /// Realtime. tau_m_nm may be null, temperature_c NaN; stepped, which may be null, receives the result of the step.
    [[nodiscard]] sinew_status step(double dt_s, const double *q_rad, const double *theta_rad, const double *tau_m_nm,
                      double temperature_c, sinew_stepped *stepped = nullptr) noexcept {
        return sinew_offsets_step(handle_.get(), dt_s, q_rad, theta_rad, tau_m_nm, temperature_c, joints_, stepped);
    }
    /// Realtime. Marks a gap before the next sample.
    void interrupt() noexcept { sinew_offsets_interrupt(handle_.get()); }
    /// Realtime. The latest answer, and the offset of every joint; either may be null, and both come from the same answer.
    [[nodiscard]] sinew_status read(sinew_answer *answer, sinew_offset *of_joints) noexcept {
        return sinew_offsets_read(handle_.get(), answer, of_joints, joints_);
    }
    /// Starts a thread that works until the offsets are freed. Call it once, before the loop. Throws if the thread
    /// cannot be created.
    void start_worker() { need(sinew_offsets_start_worker(handle_.get())); }
    /// Takes the worker, for a thread of the caller. Call it once.
    worker take_worker() {
        sinew_worker *taken = nullptr;
        need(sinew_offsets_take_worker(handle_.get(), &taken));
        return worker(taken);
    }
    /// Processes blocks in the calling thread, between samples, for single-threaded programs. Not realtime.
    [[nodiscard]] sinew_status work() noexcept { return sinew_offsets_work(handle_.get()); }
    /// Reason why the last window could not be solved; empty if it was solved. The call may wait.
    std::string error() const {
        char why[1024] = "";
        sinew_offsets_error(handle_.get(), why, sizeof why);
        return why;
    }
    /// Baseline of the next session, as text. Throws while an offset is provisional. The call may wait.
    std::string save(const std::string &recording, std::int64_t end_time_ns) {
        std::size_t length = 0;
        const auto saved = [&](char *text, std::size_t room) {
            return sinew_offsets_save(handle_.get(), recording.c_str(), end_time_ns, text, room, &length);
        };
        // The worker may have solved another window in between, so the text may be longer.
        std::string text;
        sinew_status status = saved(nullptr, 0);
        while (status == SINEW_STATUS_SHORT) {
            text.resize(length);
            status = saved(text.data(), text.size());
        }
        need(status);
        text.resize(length - 1);
        return text;
    }
    std::size_t joints() const noexcept { return joints_; }

private:
    static void need(sinew_status status) {
        if (status != SINEW_STATUS_OK) throw sinew::error(status, "");
    }
    detail::owned<sinew_offsets, sinew_offsets_free> handle_;
    std::size_t joints_;
};

/// Observer of the paper: elastic torque and offset of every joint. One thread at a time.
class observer {
public:
    explicit observer(const robot &robot, double gain_per_s = 20.0, double cutoff_rad_per_s = 40.0)
        : handle_(detail::made<sinew_observer>([&](sinew_observer **out, char *why, std::size_t room) {
              return sinew_observer_new(robot.get(), gain_per_s, cutoff_rad_per_s, out, why, room);
          })),
          joints_(robot.joints()) {}
    /// Realtime. tau_ext_nm may be null.
    [[nodiscard]] sinew_status step(double dt_s, const double *q_rad, const double *theta_rad,
                      const double *tau_ext_nm = nullptr) noexcept {
        return sinew_observer_step(handle_.get(), dt_s, q_rad, theta_rad, tau_ext_nm, joints_);
    }
    /// Realtime. Marks a gap: the next sample re-initialises the filters.
    void reset() noexcept { sinew_observer_reset(handle_.get()); }
    /// Realtime. Offset of every joint, rad; NaN for a rigid joint.
    [[nodiscard]] sinew_status delta_e(double *delta_e_rad) const noexcept {
        return sinew_observer_delta_e(handle_.get(), delta_e_rad, joints_);
    }
    /// Realtime. Elastic torque of every joint, N m.
    [[nodiscard]] sinew_status tau_el(double *tau_el_nm) const noexcept {
        return sinew_observer_tau_el(handle_.get(), tau_el_nm, joints_);
    }
    /// Realtime. Whether the initial transient has decayed to a thousandth.
    bool is_settled() const noexcept { return sinew_observer_is_settled(handle_.get()); }

private:
    detail::owned<sinew_observer, sinew_observer_free> handle_;
    std::size_t joints_;
};

/// Momentum terms of an arm. One thread at a time.
class arm {
public:
    explicit arm(const robot &robot)
        : handle_(detail::made<sinew_arm>([&](sinew_arm **out, char *why, std::size_t room) {
              return sinew_arm_new(robot.get(), out, why, room);
          })),
          joints_(robot.joints()) {}
    /// Realtime. p = M(q) dq, C(q, dq)^T dq and g(q).
    [[nodiscard]] sinew_status momentum(const double *q_rad, const double *dq_rad_s, double *p, double *ct_dq,
                          double *g) noexcept {
        return sinew_arm_momentum(handle_.get(), q_rad, dq_rad_s, p, ct_dq, g, joints_);
    }

private:
    detail::owned<sinew_arm, sinew_arm_free> handle_;
    std::size_t joints_;
};

}  // namespace sinew

#endif  // SINEW_HPP
