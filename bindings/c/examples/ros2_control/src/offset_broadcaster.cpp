#include "sinew_broadcaster/offset_broadcaster.hpp"

#include <exception>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "pluginlib/class_list_macros.hpp"

namespace sinew_broadcaster
{
using controller_interface::CallbackReturn;
using controller_interface::interface_configuration_type;
using controller_interface::InterfaceConfiguration;
using controller_interface::return_type;

namespace
{
constexpr double ABSENT = std::numeric_limits<double>::quiet_NaN();

std::string text_of(const std::string & path)
{
  std::ifstream file(path);
  if (!file) {
    throw std::runtime_error(path + " cannot be read");
  }
  return {std::istreambuf_iterator<char>(file), {}};
}
}  // namespace

CallbackReturn OffsetBroadcaster::on_init()
{
  try {
    auto_declare<std::string>("robot_toml", "");
    auto_declare<std::string>("baseline", "");
    auto_declare<std::string>("joint_interface", "position");
    auto_declare<std::string>("motor_interface", "motor_position");
  } catch (const std::exception & error) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

CallbackReturn OffsetBroadcaster::on_configure(const rclcpp_lifecycle::State &)
{
  try {
    sinew::require_version();
    const auto parameter = [this](const char * name) { return get_node()->get_parameter(name).as_string(); };
    joint_interface_ = parameter("joint_interface");
    motor_interface_ = parameter("motor_interface");
    robot_.emplace(sinew::robot::of(text_of(parameter("robot_toml")), get_robot_description()));
    offsets_.emplace(*robot_, text_of(parameter("baseline")));
    // Solves concurrently with the updates, in a non-realtime thread, because the present thread is not a realtime thread.
    offsets_->start_worker();
  } catch (const std::exception & error) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::ERROR;
  }
  const std::size_t joints = robot_->joints();
  q_rad_.assign(joints, ABSENT);
  theta_rad_.assign(joints, ABSENT);
  of_joints_.resize(joints);
  message_ = Message();
  for (std::size_t i = 0; i < joints; ++i) {
    message_.joint_names.push_back(robot_->joint_name(i));
    auto & values = message_.interface_values.emplace_back();
    values.interface_names = {"offset", "offset_std", "elongation", "provisional", "age"};
    values.values.assign(values.interface_names.size(), ABSENT);
  }
  publisher_ = get_node()->create_publisher<Message>("~/offsets", rclcpp::SystemDefaultsQoS());
  realtime_publisher_ = std::make_unique<realtime_tools::RealtimePublisher<Message>>(publisher_);
  return CallbackReturn::SUCCESS;
}

InterfaceConfiguration OffsetBroadcaster::command_interface_configuration() const
{
  return {interface_configuration_type::NONE, {}};
}

InterfaceConfiguration OffsetBroadcaster::state_interface_configuration() const
{
  // A rigid joint has no motor side, so available interfaces suffice.
  InterfaceConfiguration wanted{interface_configuration_type::INDIVIDUAL_BEST_EFFORT, {}};
  for (const auto & joint : message_.joint_names) {
    wanted.names.push_back(joint + "/" + joint_interface_);
    wanted.names.push_back(joint + "/" + motor_interface_);
  }
  return wanted;
}

CallbackReturn OffsetBroadcaster::on_activate(const rclcpp_lifecycle::State &)
{
  const std::size_t none = state_interfaces_.size();
  const auto place = [this, none](const std::string & joint, const std::string & interface) {
    for (std::size_t i = 0; i < none; ++i) {
      if (state_interfaces_[i].get_name() == joint + "/" + interface) {
        return i;
      }
    }
    return none;
  };
  q_at_.clear();
  theta_at_.clear();
  for (const auto & joint : message_.joint_names) {
    q_at_.push_back(place(joint, joint_interface_));
    theta_at_.push_back(place(joint, motor_interface_));
    if (q_at_.back() == none || theta_at_.back() == none) {
      const std::string & missing = q_at_.back() == none ? joint_interface_ : motor_interface_;
      RCLCPP_ERROR(
        get_node()->get_logger(), "the hardware has no state interface %s/%s", joint.c_str(), missing.c_str());
      return CallbackReturn::ERROR;
    }
  }
  // The arm may have moved while the controller was inactive.
  offsets_->interrupt();
  return CallbackReturn::SUCCESS;
}

// Realtime: no allocation; on_configure has set the size of the message.
return_type OffsetBroadcaster::update(const rclcpp::Time & time, const rclcpp::Duration & period)
{
  const auto value = [this](std::size_t place) {
    return place < state_interfaces_.size() ? state_interfaces_[place].get_optional().value_or(ABSENT) : ABSENT;
  };
  for (std::size_t i = 0; i < q_rad_.size(); ++i) {
    q_rad_[i] = value(q_at_[i]);
    theta_rad_[i] = value(theta_at_[i]);
  }
  sinew_stepped stepped = SINEW_STEPPED_ACCEPTED;
  const sinew_status status =
    offsets_->step(period.seconds(), q_rad_.data(), theta_rad_.data(), nullptr, ABSENT, &stepped);
  // An incomplete sample is rejected and leaves the estimate unchanged.
  if (status != SINEW_STATUS_OK && status != SINEW_STATUS_REJECTED) {
    return return_type::ERROR;
  }
  if (stepped != SINEW_STEPPED_BLOCK) {
    return return_type::OK;
  }
  sinew_answer answer;
  if (offsets_->read(&answer, of_joints_.data()) != SINEW_STATUS_OK) {
    return return_type::ERROR;
  }
  // Blocks that are not yet in the answer add to its age.
  constexpr double BLOCK_S = 0.2;
  const double age_s = answer.time_s - answer.solved_s + BLOCK_S * static_cast<double>(answer.blocks_behind);
  message_.header.stamp = time;
  for (std::size_t i = 0; i < q_rad_.size(); ++i) {
    const sinew_offset & offset = of_joints_[i];
    auto & values = message_.interface_values[i].values;
    values[0] = offset.offset_rad;
    values[1] = offset.std_rad;
    values[2] = robot_->elongation_m(i, offset.offset_rad);
    values[3] = offset.provisional;
    values[4] = age_s;
  }
  realtime_publisher_->try_publish(message_);
  return return_type::OK;
}
}  // namespace sinew_broadcaster

PLUGINLIB_EXPORT_CLASS(sinew_broadcaster::OffsetBroadcaster, controller_interface::ControllerInterface)
