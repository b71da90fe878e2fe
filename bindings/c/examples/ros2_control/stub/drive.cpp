// Plays the controller manager for the broadcaster, without ROS:
//
//     drive ROBOT_TOML URDF BASELINE < samples
//
// Samples as of loop.c, some ten times as fast as they came; prints what the broadcaster publishes, every ten seconds.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <thread>

#include "sinew_broadcaster/offset_broadcaster.hpp"

using controller_interface::CallbackReturn;
using Message = control_msgs::msg::DynamicJointState;

int main(int count, char ** arguments)
{
  if (count != 4) {
    std::cerr << "usage: drive ROBOT_TOML URDF BASELINE < samples\n";
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
  if (broadcaster.on_configure(before) != CallbackReturn::SUCCESS) {
    return 1;
  }
  Message last;
  auto publisher = std::static_pointer_cast<rclcpp::Publisher<Message>>(broadcaster.get_node()->publisher);
  publisher->on_message = [&last](const Message & message) {
    last = message;
    // The broadcaster's worker keeps up.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };

  // The interfaces of the joint side and the motor side of a joint are adjacent.
  const auto wanted = broadcaster.state_interface_configuration().names;
  std::vector<double> values(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    broadcaster.state_interfaces_.emplace_back(wanted[i], &values[i]);
  }
  if (broadcaster.on_activate(before) != CallbackReturn::SUCCESS) {
    return 1;
  }
  const std::size_t joints = wanted.size() / 2;
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
    if (broadcaster.update(now, rclcpp::Duration(t_s - before_s)) != controller_interface::return_type::OK) {
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
  return 0;
}
