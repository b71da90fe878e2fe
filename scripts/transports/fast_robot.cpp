// A robot on Fast DDS, as ROS 2 names things: fast_robot RATE_HZ SECONDS JOINTS [DOMAIN].
#include "RobotTypesPubSubTypes.h"
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <thread>

using namespace eprosima::fastdds::dds;
using sensor_msgs::msg::dds_::JointState_;
using control_msgs::msg::dds_::DynamicJointState_;

static DataWriter* writer(DomainParticipant* participant, Publisher* publisher, TypeSupport type, const char* name) {
  type.register_type(participant);
  Topic* topic = participant->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT);
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 10;
  return publisher->create_datawriter(topic, qos);
}

int main(int argc, char** argv) {
  const double rate = argc > 1 ? atof(argv[1]) : 200.0, seconds = argc > 2 ? atof(argv[2]) : 10.0;
  const int joints = argc > 3 ? atoi(argv[3]) : 4, domain = argc > 4 ? atoi(argv[4]) : 0;
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  qos.name("fast_robot");
  auto* participant = DomainParticipantFactory::get_instance()->create_participant(domain, qos);
  if (!participant) return 1;
  auto* publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  auto* states = writer(participant, publisher, TypeSupport(new sensor_msgs::msg::dds_::JointState_PubSubType()), "rt/joint_states");
  auto* motors = writer(participant, publisher, TypeSupport(new control_msgs::msg::dds_::DynamicJointState_PubSubType()), "rt/dynamic_joint_states");
  if (!states || !motors) return 1;
  JointState_ state;
  DynamicJointState_ motor;
  state.position().resize(joints);
  for (int j = 0; j < joints; ++j) {
    state.name().push_back("joint_" + std::to_string(j));
    motor.joint_names().push_back("joint_" + std::to_string(j));
    control_msgs::msg::dds_::InterfaceValue_ value;
    value.interface_names().push_back("motor_position");
    value.values().push_back(0.0);
    motor.interface_values().push_back(value);
  }
  std::printf("robot up\n");
  std::fflush(stdout);
  const auto begun = std::chrono::steady_clock::now();
  const long steps = long(rate * seconds);
  for (long step = 0; step < steps; ++step) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    state.header().stamp().sec(int32_t(ns / 1000000000));
    state.header().stamp().nanosec(uint32_t(ns % 1000000000));
    motor.header(state.header());
    for (int j = 0; j < joints; ++j) {
      const double q = std::sin(0.5 * step / rate + j);
      state.position()[j] = q;
      motor.interface_values()[j].values()[0] = q + 0.01;
    }
    states->write(&state);
    motors->write(&motor);
    std::this_thread::sleep_until(begun + std::chrono::duration<double>((step + 1) / rate));
  }
  std::printf("robot sent %ld\n", steps);
  std::fflush(stdout);
  // Data of reliable writers has been received by now; threads of the library end with the process.
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::_Exit(0);
}
