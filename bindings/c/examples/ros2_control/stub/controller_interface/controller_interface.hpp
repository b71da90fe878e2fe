// Stub of ros2_control for systems where ROS is not installed: the names and signatures that the broadcaster uses, as in
// Jazzy. Written from its documentation; not ROS.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rclcpp
{
class Time
{
public:
  explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  std::int64_t nanoseconds() const { return nanoseconds_; }

private:
  std::int64_t nanoseconds_;
};
class Duration
{
public:
  explicit Duration(double seconds) : seconds_(seconds) {}
  double seconds() const { return seconds_; }

private:
  double seconds_;
};
struct SystemDefaultsQoS
{
};
struct Logger
{
};
template <class MessageT>
class Publisher
{
public:
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const MessageT & message) { on_message(message); }
  std::function<void(const MessageT &)> on_message = [](const MessageT &) {};
};
class Parameter
{
public:
  explicit Parameter(std::string value) : value_(std::move(value)) {}
  const std::string & as_string() const { return value_; }

private:
  std::string value_;
};
}  // namespace rclcpp

#define RCLCPP_WARN RCLCPP_ERROR
#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), std::fprintf(stderr, __VA_ARGS__), std::fputc('\n', stderr))

namespace rclcpp_lifecycle
{
class State
{
};
class LifecycleNode
{
public:
  rclcpp::Logger get_logger() const { return {}; }
  const char * get_name() const { return "offset_broadcaster"; }
  rclcpp::Parameter get_parameter(const std::string & name) const { return rclcpp::Parameter(parameters.at(name)); }
  template <class MessageT>
  std::shared_ptr<rclcpp::Publisher<MessageT>> create_publisher(const std::string &, const rclcpp::SystemDefaultsQoS &)
  {
    auto made = std::make_shared<rclcpp::Publisher<MessageT>>();
    publisher = made;
    return made;
  }
  std::map<std::string, std::string> parameters;
  std::shared_ptr<void> publisher;
};
}  // namespace rclcpp_lifecycle

namespace hardware_interface
{
class LoanedStateInterface
{
public:
  LoanedStateInterface(std::string name, const double * value) : name_(std::move(name)), value_(value) {}
  const std::string & get_name() const { return name_; }
  template <typename T = double>
  std::optional<T> get_optional(unsigned int = 10) const
  {
    return *value_;
  }

private:
  std::string name_;
  const double * value_;
};
}  // namespace hardware_interface

namespace controller_interface
{
enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class interface_configuration_type : std::uint8_t { ALL, INDIVIDUAL, NONE, INDIVIDUAL_BEST_EFFORT };
struct InterfaceConfiguration
{
  interface_configuration_type type;
  std::vector<std::string> names = {};
};

class ControllerInterface
{
public:
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State & before) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State & before) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const rclcpp_lifecycle::State &) { return CallbackReturn::SUCCESS; }
  virtual return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const { return node; }
  const std::string & get_robot_description() const { return description; }
  template <typename ParameterT>
  auto auto_declare(const std::string & name, const ParameterT & default_value)
  {
    return node->parameters.try_emplace(name, default_value).first->second;
  }

  // Members that a controller manager sets.
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
  std::string description;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;
};
}  // namespace controller_interface
