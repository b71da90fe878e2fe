// Offsets and elongations in a control loop, in C++:
//
//     loop_cpp ROBOT_DIR BASELINE < samples
//
// Standard input has the format of loop.c. A failed construction throws an exception with the error message.
#include <sinew.hpp>

#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace {

/// Interval of the output, s.
constexpr double PRINT_S = 10.0;

std::string text_of(const char *path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(std::string(path) + " cannot be read");
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Throws an exception unless the status is OK.
void need(sinew_status status, const char *what) {
    if (status != SINEW_STATUS_OK) throw sinew::error(status, std::string(what) + ": " + sinew_status_text(status));
}

/// Whether a sample was rejected because a value is missing.
bool is_incomplete(sinew_status status) noexcept {
    return status == SINEW_STATUS_REJECTED || status == SINEW_STATUS_NOT_FINITE;
}

bool read(std::istream &robot, std::vector<double> &values) {
    std::string word;
    for (double &value : values) {
        if (!(robot >> word)) return false;
        value = std::stod(word);
    }
    return true;
}

void run(const char *folder, const char *baseline) {
    sinew::require_version();
    const auto robot = sinew::robot::open(folder);
    sinew::offsets offsets(robot, text_of(baseline));
    sinew::observer observer(robot);
    const std::size_t n = robot.joints();
    std::vector<double> t_s(1), q_rad(n), theta_rad(n), delta_e_rad(n);
    std::vector<sinew_offset> of_joints(n);
    constexpr double absent = std::numeric_limits<double>::quiet_NaN();
    double first_s = absent, before_s = absent, print_s = PRINT_S;
    while (read(std::cin, t_s) && read(std::cin, q_rad) && read(std::cin, theta_rad)) {
        if (!(first_s <= t_s[0])) first_s = before_s = t_s[0];
        const double dt_s = t_s[0] - before_s;
        before_s = t_s[0];

        // Realtime from here …
        sinew_stepped became = SINEW_STEPPED_ACCEPTED;
        const sinew_status stepped = offsets.step(dt_s, q_rad.data(), theta_rad.data(), nullptr, absent, &became);
        const sinew_status observed = observer.step(dt_s, q_rad.data(), theta_rad.data());
        const sinew_status observer_read = observer.delta_e(delta_e_rad.data());
        const sinew_status read_out = offsets.read(nullptr, of_joints.data());
        // … to here.

        // An incomplete sample is rejected and leaves the estimate unchanged.
        if (!is_incomplete(stepped)) need(stepped, "offsets");
        if (!is_incomplete(observed)) need(observed, "observer");
        need(observer_read, "delta_e");
        need(read_out, "read");

        // A recording is faster than a robot: here the loop waits. On a robot, call start_worker() before the loop.
        if (stepped == SINEW_STATUS_OK && became == SINEW_STEPPED_BLOCK) need(offsets.work(), "work");

        if (t_s[0] - first_s < print_s) continue;
        print_s += PRINT_S;
        std::printf("%6.1f s", t_s[0] - first_s);
        for (std::size_t i = 0; i < n; ++i) {
            const sinew_offset &offset = of_joints[i];
            const double mean_mm = 1e3 * robot.elongation_m(i, offset.offset_rad);
            const double std_mm = 1e3 * robot.elongation_m(i, offset.offset_std_rad);
            std::printf("  %s %+.3f ± %.3f mm", robot.joint_name(i).c_str(), mean_mm, 1.96 * std_mm);
            if (offset.provisional != SINEW_PROVISIONAL_NONE) std::printf(" (%s)", sinew_provisional_text(offset.provisional));
        }
        std::printf("\n");
    }
}

}  // namespace

int main(int count, char **arguments) {
    if (count != 3) {
        std::cerr << "usage: loop_cpp ROBOT_DIR BASELINE < samples\n";
        return 2;
    }
    try {
        run(arguments[1], arguments[2]);
    } catch (const std::exception &error) {
        std::cerr << "error: " << error.what() << '\n';
        return 1;
    }
}
