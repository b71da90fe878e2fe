// Stub of pluginlib for systems where ROS is not installed: the class must only be one of its base.
#pragma once

#include <type_traits>

#define PLUGINLIB_EXPORT_CLASS(derived, base) \
  static_assert(std::is_base_of_v<base, derived> && !std::is_abstract_v<derived>);
