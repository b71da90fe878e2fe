#include "sinew_broadcaster/offset_broadcaster.hpp"

#include <chrono>
#include <cstdio>
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

/// Writes a file, which is complete or absent.
void write_all(const std::string & path, const std::string & text)
{
  const std::string unfinished = path + ".unfinished";
  std::ofstream file(unfinished, std::ios::trunc);
  file << text;
  file.close();
  if (!file || std::rename(unfinished.c_str(), path.c_str()) != 0) {
    throw std::runtime_error(path + " cannot be written");
  }
}
}  // namespace

OffsetBroadcaster::~OffsetBroadcaster()
{
  stop_saver();
}

void OffsetBroadcaster::stop_saver()
{
  saver_ends_ = true;
  if (saver_.joinable()) {
    saver_.join();
  }
  saver_ends_ = false;
}

void OffsetBroadcaster::save_on_request()
{
  const auto name = [this] { return std::string(get_node()->get_name()) + "-" + std::to_string(last_ns_); };
  // A request that precedes the end is fulfilled.
  for (bool ends = false; !ends;) {
    ends = saver_ends_;
    if (is_saving_) {
      try {
        write_all(next_baseline_, offsets_->save(name(), last_ns_));
      } catch (const std::exception & error) {
        RCLCPP_WARN(get_node()->get_logger(), "%s not written: %s", next_baseline_.c_str(), error.what());
      }
      is_saving_ = false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

CallbackReturn OffsetBroadcaster::on_init()
{
  try {
    auto_declare<std::string>("robot_toml", "");
    auto_declare<std::string>("baseline", "");
    auto_declare<std::string>("next_baseline", "");
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
    stop_saver();
    next_baseline_ = parameter("next_baseline");
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
  q_at_.assign(joints, 0);
  theta_at_.assign(joints, 0);
  q_names_.clear();
  theta_names_.clear();
  message_ = Message();
  for (std::size_t i = 0; i < joints; ++i) {
    const std::string joint = robot_->joint_name(i);
    q_names_.push_back(joint + "/" + get_node()->get_parameter("joint_interface").as_string());
    theta_names_.push_back(joint + "/" + get_node()->get_parameter("motor_interface").as_string());
    message_.joint_names.push_back(joint);
    auto & values = message_.interface_values.emplace_back();
    values.interface_names = {"offset", "offset_std", "elongation", "provisional", "age"};
    values.values.assign(values.interface_names.size(), ABSENT);
  }
  publisher_ = get_node()->create_publisher<Message>("~/offsets", rclcpp::SystemDefaultsQoS());
  realtime_publisher_ = std::make_unique<realtime_tools::RealtimePublisher<Message>>(publisher_);
  if (!next_baseline_.empty()) {
    saver_ = std::thread([this] { save_on_request(); });
  }
  return CallbackReturn::SUCCESS;
}

CallbackReturn OffsetBroadcaster::on_cleanup(const rclcpp_lifecycle::State &)
{
  stop_saver();
  offsets_.reset();
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
  for (std::size_t i = 0; i < q_names_.size(); ++i) {
    wanted.names.push_back(q_names_[i]);
    if (robot_->is_elastic(i)) {
      wanted.names.push_back(theta_names_[i]);
    }
  }
  return wanted;
}

// Realtime, unless an interface is missing.
CallbackReturn OffsetBroadcaster::on_activate(const rclcpp_lifecycle::State &)
{
  const std::size_t none = state_interfaces_.size();
  const auto place = [this, none](const std::string & name) {
    std::size_t i = 0;
    while (i < none && state_interfaces_[i].get_name() != name) {
      ++i;
    }
    return i;
  };
  for (std::size_t i = 0; i < q_names_.size(); ++i) {
    q_at_[i] = place(q_names_[i]);
    theta_at_[i] = place(theta_names_[i]);
    if (q_at_[i] == none || (theta_at_[i] == none && robot_->is_elastic(i))) {
      const std::string & missing = q_at_[i] == none ? q_names_[i] : theta_names_[i];
      RCLCPP_ERROR(get_node()->get_logger(), "the hardware has no state interface %s", missing.c_str());
      return CallbackReturn::ERROR;
    }
  }
  resumed_ = true;
  return CallbackReturn::SUCCESS;
}

// Realtime: the saver writes the file.
CallbackReturn OffsetBroadcaster::on_deactivate(const rclcpp_lifecycle::State &)
{
  is_saving_ = !next_baseline_.empty();
  return CallbackReturn::SUCCESS;
}

// Realtime: no allocation; on_configure has set the size of the message.
return_type OffsetBroadcaster::update(const rclcpp::Time & time, const rclcpp::Duration & period)
{
  if (is_saving_) {
    // Activated again before the file was written.
    resumed_ = true;
    return return_type::OK;
  }
  if (resumed_) {
    // The arm may have moved while the controller was inactive.
    offsets_->interrupt();
    resumed_ = false;
  }
  last_ns_ = time.nanoseconds();
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
    values[1] = offset.offset_std_rad;
    values[2] = robot_->elongation_m(i, offset.offset_rad);
    values[3] = offset.provisional;
    values[4] = age_s;
  }
  realtime_publisher_->try_publish(message_);
  return return_type::OK;
}
}  // namespace sinew_broadcaster

PLUGINLIB_EXPORT_CLASS(sinew_broadcaster::OffsetBroadcaster, controller_interface::ControllerInterface)
