// Plays the controller manager for the broadcaster, without ROS:
//
//     drive ROBOT_TOML URDF BASELINE [NEXT_BASELINE] < samples
//
// Samples as of loop.c, some ten times as fast as they came; prints what the broadcaster publishes, every ten seconds. Then it
// deactivates the broadcaster, which writes NEXT_BASELINE. An allocation between on_configure and on_cleanup in the thread of the
// controller manager is an error.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <new>
#include <thread>

#include "sinew_broadcaster/offset_broadcaster.hpp"

using controller_interface::CallbackReturn;
using Message = control_msgs::msg::DynamicJointState;

/// Whether this thread may not allocate now, and whether it did.
static thread_local bool is_realtime = false;
static thread_local bool has_allocated = false;

void * operator new(std::size_t size)
{
  has_allocated |= is_realtime;
  if (void * made = std::malloc(size)) {
    return made;
  }
  throw std::bad_alloc();
}
void operator delete(void * made) noexcept { std::free(made); }
void operator delete(void * made, std::size_t) noexcept { std::free(made); }

/// Calls a function of the broadcaster as the realtime thread does.
template <class Call>
static auto realtime(Call && call)
{
  is_realtime = true;
  const auto result = call();
  is_realtime = false;
  return result;
}

int main(int count, char ** arguments)
{
  if (count != 4 && count != 5) {
    std::cerr << "usage: drive ROBOT_TOML URDF BASELINE [NEXT_BASELINE] < samples\n";
    return 2;
  }
  sinew_broadcaster::OffsetBroadcaster broadcaster;
  std::ifstream urdf(arguments[2]);
  broadcaster.description.assign(std::istreambuf_iterator<char>(urdf), {});
  const rclcpp_lifecycle::State before;
  if (broadcaster.on_init() != CallbackReturn::SUCCESS) {
    return 1;
  }
  broadcaster.get_node()->parameters["robot_toml"] = arguments[1];
  broadcaster.get_node()->parameters["baseline"] = arguments[3];
  broadcaster.get_node()->parameters["next_baseline"] = count == 5 ? arguments[4] : "";
  if (broadcaster.on_configure(before) != CallbackReturn::SUCCESS) {
    return 1;
  }
  Message last;
  auto publisher = std::static_pointer_cast<rclcpp::Publisher<Message>>(broadcaster.get_node()->publisher);
  publisher->on_message = [&last](const Message & message) {
    // The publisher of ROS hands the message to its own thread.
    is_realtime = false;
    last = message;
    is_realtime = true;
    // The broadcaster's worker keeps up.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };

  // The joint side of each joint, followed by its motor side unless it is rigid.
  const auto wanted = broadcaster.state_interface_configuration().names;
  const std::string joint_side = "/position";
  std::vector<double> values(2 * wanted.size());
  std::size_t joints = 0;
  for (const auto & name : wanted) {
    const bool is_joint = name.size() > joint_side.size() && name.substr(name.size() - joint_side.size()) == joint_side;
    joints += is_joint;
    broadcaster.state_interfaces_.emplace_back(name, &values[2 * joints - (is_joint ? 2 : 1)]);
  }
  const auto activate = [&] { return broadcaster.on_activate(before); };
  if (realtime(activate) != CallbackReturn::SUCCESS) {
    return 1;
  }
  std::string word;
  double first_s = -1.0, before_s = 0.0, print_s = 10.0;
  while (std::cin >> word) {
    const double t_s = std::stod(word);
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t i = 0; i < joints && std::cin >> word; ++i) {
        values[2 * i + side] = std::stod(word);
      }
    }
    if (first_s < 0.0) {
      first_s = before_s = t_s;
    }
    const rclcpp::Time now{static_cast<std::int64_t>(t_s * 1e9)};
    const auto update = [&] { return broadcaster.update(now, rclcpp::Duration(t_s - before_s)); };
    if (realtime(update) != controller_interface::return_type::OK) {
      return 1;
    }
    before_s = t_s;
    if (t_s - first_s < print_s || last.joint_names.empty()) {
      continue;
    }
    print_s += 10.0;
    std::printf("%6.1f s", t_s - first_s);
    for (std::size_t i = 0; i < joints; ++i) {
      const auto & of_joint = last.interface_values[i].values;
      std::printf("  %s %+.2f ± %.2f", last.joint_names[i].c_str(), 1e3 * of_joint[0], 1.96e3 * of_joint[1]);
      if (of_joint[3] > 0.0) {
        std::printf(" (%s)", sinew_provisional_text(static_cast<int>(of_joint[3])));
      }
    }
    std::printf(" mrad, %.1f s old\n", last.interface_values[0].values[4]);
  }
  const auto deactivate = [&] { return broadcaster.on_deactivate(before); };
  if (realtime(deactivate) != CallbackReturn::SUCCESS || broadcaster.on_cleanup(before) != CallbackReturn::SUCCESS) {
    return 1;
  }
  if (has_allocated) {
    std::cerr << "the realtime thread has allocated\n";
    return 1;
  }
  return 0;
}
