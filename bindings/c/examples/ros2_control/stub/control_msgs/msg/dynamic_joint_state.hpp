// Stub of control_msgs for systems where ROS is not installed.
#pragma once

#include <string>
#include <vector>

#include "controller_interface/controller_interface.hpp"

namespace control_msgs::msg
{
struct InterfaceValue
{
  std::vector<std::string> interface_names;
  std::vector<double> values;
};
struct DynamicJointState
{
  struct Header
  {
    rclcpp::Time stamp{0};
  } header;
  std::vector<std::string> joint_names;
  std::vector<InterfaceValue> interface_values;
};
}  // namespace control_msgs::msg
