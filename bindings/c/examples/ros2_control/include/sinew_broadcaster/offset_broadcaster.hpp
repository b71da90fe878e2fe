// Broadcaster of ros2_control: tendon offsets inside the controller manager, for Jazzy and later.
#ifndef SINEW_BROADCASTER__OFFSET_BROADCASTER_HPP_
#define SINEW_BROADCASTER__OFFSET_BROADCASTER_HPP_

#include <sinew.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "control_msgs/msg/dynamic_joint_state.hpp"
#include "controller_interface/controller_interface.hpp"
#include "realtime_tools/realtime_publisher.hpp"

namespace sinew_broadcaster
{
/// Publishes `~/offsets` with every block, five times a second: per joint the offset since the baseline, rad, its
/// standard deviation, rad, the elongation, m, `provisional`, a `sinew_provisional` (0: settled), and the age of the solution, s.
///
/// Parameters: `robot_toml` and `baseline`, paths; `next_baseline`, the path of the baseline of the next session, written after
/// deactivation unless an offset is provisional; `joint_interface` (position) and `motor_interface` (motor_position), names of
/// the state interfaces on both sides of the tendon. A rigid joint needs no motor side; its values are NaN. The URDF is that
/// of the controller manager.
///
/// `on_configure` allocates all memory. `on_activate`, `update` and `on_deactivate`, which a controller manager calls in its
/// realtime thread, neither allocate nor wait; a thread of its own writes the file.
class OffsetBroadcaster : public controller_interface::ControllerInterface
{
public:
  ~OffsetBroadcaster() override;
  controller_interface::CallbackReturn on_init() override;
  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State & before) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State & before) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State & before) override;
  controller_interface::CallbackReturn on_cleanup(const rclcpp_lifecycle::State & before) override;
  controller_interface::return_type update(
    const rclcpp::Time & time, const rclcpp::Duration & period) override;

private:
  using Message = control_msgs::msg::DynamicJointState;

  std::optional<sinew::robot> robot_;
  std::optional<sinew::offsets> offsets_;
  std::vector<double> q_rad_, theta_rad_;
  std::vector<sinew_offset> of_joints_;
  /// Names of the state interfaces per joint, of the joint side and of the motor side, and their indices among the loaned ones.
  std::vector<std::string> q_names_, theta_names_;
  std::vector<std::size_t> q_at_, theta_at_;
  Message message_;
  std::shared_ptr<rclcpp::Publisher<Message>> publisher_;
  std::unique_ptr<realtime_tools::RealtimePublisher<Message>> realtime_publisher_;

  /// Writes the baseline of the next session whenever the controller is deactivated; ends when `saver_ends_` is set.
  void save_on_request();
  void stop_saver();
  std::string next_baseline_;
  std::int64_t last_ns_ = 0;
  bool resumed_ = false;
  /// The offsets belong to the saver while this is set: no sample is added.
  std::atomic<bool> is_saving_{false};
  std::atomic<bool> saver_ends_{false};
  std::thread saver_;
};
}  // namespace sinew_broadcaster

#endif  // SINEW_BROADCASTER__OFFSET_BROADCASTER_HPP_
