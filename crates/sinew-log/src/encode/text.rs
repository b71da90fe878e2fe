//! Message definitions as rosbag2 stores them: name, and text with its dependencies.
//!
//! Texts from ros2/common_interfaces, ros2/rcl_interfaces (Apache-2.0) and
//! ros-controls/control_msgs (BSD-3-Clause), comments shortened.

use super::Schema;

/// Begins the definition of a message with a header.
macro_rules! header {
    () => {
        "\
================================================================================
MSG: std_msgs/Header
# Standard metadata for higher-level stamped data types.
# This is generally used to communicate timestamped data
# in a particular coordinate frame.

# Two-integer timestamp that is expressed as seconds and nanoseconds.
builtin_interfaces/Time stamp

# Transform frame with which this data is associated.
string frame_id

================================================================================
MSG: builtin_interfaces/Time
# This message communicates ROS Time defined here:
# https://design.ros2.org/articles/clock_and_time.html

# The seconds component, valid over all int32 values.
int32 sec

# The nanoseconds component, valid in the range [0, 1e9), to be added to the seconds component.
uint32 nanosec
"
    };
}

/// Definition of `std_msgs/msg/String`.
pub(super) const STRING: Schema = Schema {
    name: "std_msgs/msg/String",
    text: "string data\n",
};

/// Definition of `sensor_msgs/msg/JointState`.
pub(super) const JOINT_STATE: Schema = Schema {
    name: "sensor_msgs/msg/JointState",
    text: concat!(
        "\
# This is a message that holds data to describe the state of a set of torque controlled joints.
#
# The state of each joint (revolute or prismatic) is defined by:
#  * the position of the joint (rad or m),
#  * the velocity of the joint (rad/s or m/s) and
#  * the effort that is applied in the joint (Nm or N).
#
# Each joint is uniquely identified by its name
# The header specifies the time at which the joint states were recorded. All the joint states
# in one message have to be recorded at the same time.
#
# This message consists of a multiple arrays, one for each part of the joint state.
# The goal is to make each of the fields optional. When e.g. your joints have no
# effort associated with them, you can leave the effort array empty.
#
# All arrays in this message should have the same size, or be empty.

std_msgs/Header header

string[] name
float64[] position
float64[] velocity
float64[] effort

",
        header!()
    ),
};

/// Definition of `control_msgs/msg/DynamicJointState`.
pub(super) const DYNAMIC_JOINT_STATE: Schema = Schema {
    name: "control_msgs/msg/DynamicJointState",
    text: concat!(
        "\
# Header timestamp should be update time of joint state
std_msgs/Header header

# List of joint names, e.g. [\"joint1\", \"joint2\"]
string[] joint_names

# Key-value pairs representing interfaces and their corresponding values for each joint listed
# in `joint_names`
InterfaceValue[] interface_values

",
        header!(),
        "
================================================================================
MSG: control_msgs/InterfaceValue
# List of resource interface names
string[] interface_names

# Values corresponding to the list of interface names
float64[] values
"
    ),
};

/// Definition of `diagnostic_msgs/msg/DiagnosticArray`.
pub(super) const DIAGNOSTIC_ARRAY: Schema = Schema {
    name: "diagnostic_msgs/msg/DiagnosticArray",
    text: concat!(
        "\
# This message is used to send diagnostic information about the state of the robot.
std_msgs/Header header # for timestamp
DiagnosticStatus[] status # an array of components being reported on

",
        header!(),
        "
================================================================================
MSG: diagnostic_msgs/DiagnosticStatus
# This message holds the status of an individual component of the robot.

# Possible levels of operations.
byte OK=0
byte WARN=1
byte ERROR=2
byte STALE=3

# Level of operation enumerated above.
byte level
# A description of the test/component reporting.
string name
# A description of the status.
string message
# A hardware unique string.
string hardware_id
# An array of values associated with the status.
KeyValue[] values

================================================================================
MSG: diagnostic_msgs/KeyValue
# What to label this value when viewing.
string key
# A value to track over time.
string value
"
    ),
};
