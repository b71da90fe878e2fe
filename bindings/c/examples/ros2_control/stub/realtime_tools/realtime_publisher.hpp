// Stub of realtime_tools for systems where ROS is not installed: no thread, the message arrives immediately.
#pragma once

#include <memory>
#include <utility>

namespace realtime_tools
{
template <class MessageT>
class RealtimePublisher
{
public:
  explicit RealtimePublisher(std::shared_ptr<rclcpp::Publisher<MessageT>> publisher)
  : publisher_(std::move(publisher)) {}
  bool try_publish(const MessageT & message)
  {
    publisher_->publish(message);
    return true;
  }

private:
  std::shared_ptr<rclcpp::Publisher<MessageT>> publisher_;
};
}  // namespace realtime_tools
