// Broadcaster of ros2_control: tendon offsets inside the controller manager, for Jazzy and later.
#ifndef SINEW_BROADCASTER__OFFSET_BROADCASTER_HPP_
#define SINEW_BROADCASTER__OFFSET_BROADCASTER_HPP_

#include <sinew.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "control_msgs/msg/dynamic_joint_state.hpp"
#include "controller_interface/controller_interface.hpp"
#include "realtime_tools/realtime_publisher.hpp"

namespace sinew_broadcaster
{
/// Publishes `~/offsets` with every block, five times a second: per joint the offset since the baseline, rad, its
/// standard deviation, rad, the elongation, m, `provisional`, a `sinew_provisional` (0: settled), and the age of the solution, s.
///
/// Parameters: `robot_toml` and `baseline`, paths; `joint_interface` (position) and `motor_interface`
/// (motor_position), names of the state interfaces on both sides of the tendon. The URDF is that of the controller manager.
class OffsetBroadcaster : public controller_interface::ControllerInterface
{
public:
  controller_interface::CallbackReturn on_init() override;
  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State & before) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State & before) override;
  controller_interface::return_type update(
    const rclcpp::Time & time, const rclcpp::Duration & period) override;

private:
  using Message = control_msgs::msg::DynamicJointState;

  std::optional<sinew::robot> robot_;
  std::optional<sinew::offsets> offsets_;
  std::vector<double> q_rad_, theta_rad_;
  std::vector<sinew_offset> of_joints_;
  /// Index of the loaned state interface per joint, of the joint side and of the motor side.
  std::vector<std::size_t> q_at_, theta_at_;
  Message message_;
  std::shared_ptr<rclcpp::Publisher<Message>> publisher_;
  std::unique_ptr<realtime_tools::RealtimePublisher<Message>> realtime_publisher_;
  std::string joint_interface_, motor_interface_;
};
}  // namespace sinew_broadcaster

#endif  // SINEW_BROADCASTER__OFFSET_BROADCASTER_HPP_
