// Sinew for C++17: the handles of sinew.h as objects that free themselves and refuse by exception.
//
// What constructs throws sinew::error with the sentence; what steps is noexcept and answers a status, so that a
// control loop neither unwinds nor allocates. Arrays are `double *` with the robot's joints behind it.
#ifndef SINEW_HPP
#define SINEW_HPP

#include "sinew.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace sinew {

/// A refusal, with its status.
class error : public std::runtime_error {
public:
    error(sinew_status status, const std::string &sentence)
        : std::runtime_error(sentence.empty() ? sinew_status_text(status) : sentence), status_(status) {}
    sinew_status status() const noexcept { return status_; }

private:
    sinew_status status_;
};

namespace detail {

/// Runs a constructor of sinew.h and takes its handle.
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

/// Throws unless the library at hand is of this header's version: once, at the start.
inline void require_version() {
    if (sinew_abi_version() != SINEW_ABI_VERSION)
        throw error(SINEW_STATUS_INVALID, "libsinew is of version " + std::to_string(sinew_abi_version()) +
                                              " of the interface, and the header of " +
                                              std::to_string(SINEW_ABI_VERSION));
}

/// A robot: joints, masses, stiffness, tendons. Never changes.
class robot {
public:
    /// From its folder, or from the path of its robot.toml.
    static robot open(const std::string &place) {
        return robot(detail::made<sinew_robot>([&](sinew_robot **out, char *why, std::size_t room) {
            return sinew_robot_open(place.c_str(), out, why, room);
        }));
    }
    /// From the texts of robot.toml and of a URDF.
    static robot of(const std::string &robot_toml, const std::string &urdf) {
        return robot(detail::made<sinew_robot>([&](sinew_robot **out, char *why, std::size_t room) {
            return sinew_robot_new(robot_toml.c_str(), urdf.c_str(), out, why, room);
        }));
    }
    std::size_t joints() const noexcept { return sinew_robot_joints(get()); }
    /// Of a joint below joints().
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
    /// Elongation of a joint's tendon, m, for an offset, rad; NaN where there is no tendon.
    double elongation_m(std::size_t joint, double offset_rad) const noexcept {
        return sinew_robot_elongation_m(get(), joint, offset_rad);
    }
    const sinew_robot *get() const noexcept { return handle_.get(); }

private:
    explicit robot(sinew_robot *handle) noexcept : handle_(handle) {}
    detail::owned<sinew_robot, sinew_robot_free> handle_;
};

/// Offset of a joint since the baseline.
struct offset {
    double mean_rad;
    /// One standard deviation.
    double deviation_rad;
    /// In the first half minute, while something leans on the arm, after a slip that hasn't settled.
    bool in_doubt;
};

/// A constant force from outside at the tool, along the axes of the base.
struct external_force {
    /// That one acts, 0 to 1.
    double probability;
    double mean_n[3];
    /// Standard deviations.
    double deviation_n[3];
};

/// Absolute offsets since a baseline. One thread at a time.
class offsets {
public:
    /// baseline: the text of the file that `sinew baseline` writes.
    offsets(const robot &robot, const std::string &baseline,
            const sinew_offsets_options &options = sinew_offsets_options_default())
        : handle_(detail::made<sinew_offsets>([&](sinew_offsets **out, char *why, std::size_t room) {
              return sinew_offsets_new(robot.get(), baseline.c_str(), &options, out, why, room);
          })),
          joints_(robot.joints()) {}
    /// Realtime. tau_m_nm may be null, temperature_c NaN; stepped, which may be null, says what became of it.
    [[nodiscard]] sinew_status step(double dt_s, const double *q_rad, const double *theta_rad, const double *tau_m_nm,
                      double temperature_c, sinew_stepped *stepped = nullptr) noexcept {
        return sinew_offsets_step(handle_.get(), dt_s, q_rad, theta_rad, tau_m_nm, temperature_c, joints_, stepped);
    }
    /// Bounds the work of a step; the longest time between samples. The offsets come 0.2 s later. Realtime.
    [[nodiscard]] sinew_status bound_work(double period_max_s) noexcept {
        return sinew_offsets_bound_work(handle_.get(), period_max_s);
    }
    /// Blocks left out, because samples came later than `bound_work` was told. Realtime.
    std::uint64_t left_out() const noexcept {
        std::uint64_t blocks = 0;
        sinew_offsets_left_out(handle_.get(), &blocks);
        return blocks;
    }
    /// Realtime. The next sample doesn't go on where the last one was.
    void interrupt() noexcept { sinew_offsets_interrupt(handle_.get()); }
    /// Realtime. NaN where there is no such joint.
    offset read(std::size_t joint) const noexcept {
        offset read{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(), true};
        sinew_offsets_read(handle_.get(), joint, &read.mean_rad, &read.deviation_rad, &read.in_doubt);
        return read;
    }
    /// Realtime. Probability that a joint's stiffness has changed since the baseline; NaN where there is no such joint.
    double stiffness_changed(std::size_t joint) const noexcept {
        double probability = std::numeric_limits<double>::quiet_NaN();
        sinew_offsets_stiffness_changed(handle_.get(), joint, &probability);
        return probability;
    }
    /// Realtime. What a temperature that isn't known adds to a joint's deviation, rad; 0 where it is; NaN where there is no such joint.
    double unknown_temperature_rad(std::size_t joint) const noexcept {
        double deviation_rad = std::numeric_limits<double>::quiet_NaN();
        sinew_offsets_unknown_temperature(handle_.get(), joint, &deviation_rad);
        return deviation_rad;
    }
    /// Realtime. A constant force from outside at the tool; all NaN where none is looked for.
    external_force force() const noexcept {
        external_force read{};
        sinew_offsets_external_force(handle_.get(), &read.probability, read.mean_n, read.deviation_n);
        return read;
    }
    /// How fast offsets may move, rad/s, a standard deviation; before the first sample. 0: ropes that don't creep.
    [[nodiscard]] sinew_status expect_creep(double deviation_rad_per_s) noexcept {
        return sinew_offsets_expect_creep(handle_.get(), deviation_rad_per_s);
    }
    /// The baseline of the next session, as text. Throws while the offsets are in doubt.
    std::string save(const std::string &recording, std::int64_t end_time_ns) const {
        std::size_t length = 0;
        const sinew_status asked =
            sinew_offsets_save(handle_.get(), recording.c_str(), end_time_ns, nullptr, 0, &length);
        if (asked != SINEW_STATUS_SHORT) throw error(asked, "");
        std::string text(length, '\0');
        const sinew_status status =
            sinew_offsets_save(handle_.get(), recording.c_str(), end_time_ns, text.data(), text.size(), &length);
        if (status != SINEW_STATUS_OK) throw error(status, "");
        text.resize(length - 1);
        return text;
    }
    std::size_t joints() const noexcept { return joints_; }

private:
    detail::owned<sinew_offsets, sinew_offsets_free> handle_;
    std::size_t joints_;
};

/// The paper's observer: elastic torque and offset of every joint. One thread at a time.
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
    /// Realtime. After a gap: the next sample is a start.
    void reset() noexcept { sinew_observer_reset(handle_.get()); }
    /// Realtime. Offset of every joint, rad; NaN of a rigid one.
    [[nodiscard]] sinew_status delta_e(double *delta_e_rad) const noexcept {
        return sinew_observer_delta_e(handle_.get(), delta_e_rad, joints_);
    }
    /// Realtime. Elastic torque of every joint, N m.
    [[nodiscard]] sinew_status tau_el(double *tau_el_nm) const noexcept {
        return sinew_observer_tau_el(handle_.get(), tau_el_nm, joints_);
    }
    /// Realtime. Whether the start has faded to a thousandth.
    bool is_settled() const noexcept { return sinew_observer_is_settled(handle_.get()); }

private:
    detail::owned<sinew_observer, sinew_observer_free> handle_;
    std::size_t joints_;
};

/// The momentum pass. One thread at a time.
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
