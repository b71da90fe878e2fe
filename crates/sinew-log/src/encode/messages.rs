//! The messages that are written, field by field in the order of their definitions.

use super::{Message, Schema, text};
use serde::{Serialize, Serializer};

/// Content of a `builtin_interfaces/msg/Time` message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Stamp {
    /// Seconds since 1970.
    pub sec: i32,
    /// Nanoseconds of that second.
    pub nanosec: u32,
}

impl Stamp {
    /// Stamp of a time, ns since 1970; `None` outside its range of 1901 to 2038.
    pub fn new(time_ns: i64) -> Option<Self> {
        Some(Self {
            sec: i32::try_from(time_ns.div_euclid(1_000_000_000)).ok()?,
            nanosec: time_ns.rem_euclid(1_000_000_000) as u32,
        })
    }
}

/// Content of a `std_msgs/msg/Header` message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Header<'a> {
    /// Time of the message.
    pub stamp: Stamp,
    /// Frame of reference.
    pub frame_id: &'a str,
}

impl<'a> Header<'a> {
    /// [`Stamp::new`] with a frame.
    pub fn at(time_ns: i64, frame_id: &'a str) -> Option<Self> {
        let stamp = Stamp::new(time_ns)?;
        Some(Self { stamp, frame_id })
    }
}

/// Content of a `std_msgs/msg/String` message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Text<'a> {
    /// Text of the message.
    pub data: &'a str,
}

impl Message for Text<'_> {
    const SCHEMA: Schema = text::STRING;
}

/// `sensor_msgs/msg/JointState`; a sequence may be empty: not published.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointState<'a> {
    /// Time and frame of reference.
    pub header: Header<'a>,
    /// Names of the joints.
    pub name: &'a [String],
    /// Positions in the order of the names, rad.
    pub position: &'a [f64],
    /// Velocities in the order of the names, rad/s.
    pub velocity: &'a [f64],
    /// Torques in the order of the names, N·m.
    pub effort: &'a [f64],
}

impl Message for JointState<'_> {
    const SCHEMA: Schema = text::JOINT_STATE;
}

/// Content of a `control_msgs/msg/InterfaceValue` message.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InterfaceValue<'a> {
    /// Names of the interfaces.
    pub interface_names: &'a [&'a str],
    /// A value for each.
    pub values: &'a [f64],
}

/// Content of a `control_msgs/msg/DynamicJointState` message.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DynamicJointState<'a> {
    /// Time and frame of reference.
    pub header: Header<'a>,
    /// Names of the joints.
    pub joint_names: &'a [String],
    /// Interfaces of each.
    pub interface_values: &'a [InterfaceValue<'a>],
}

impl Message for DynamicJointState<'_> {
    const SCHEMA: Schema = text::DYNAMIC_JOINT_STATE;
}

/// Severity of a status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// Normal operation without a required action.
    Ok = 0,
    /// Worth a look.
    Warn = 1,
    /// Error that requires action.
    Error = 2,
    /// No data received.
    Stale = 3,
}

impl Serialize for Level {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_u8(*self as u8)
    }
}

/// Content of a `diagnostic_msgs/msg/KeyValue` message.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct KeyValue {
    /// Name of the value.
    pub key: String,
    /// The value as text.
    pub value: String,
}

/// Content of a `diagnostic_msgs/msg/DiagnosticStatus` message.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DiagnosticStatus {
    /// Severity of the status.
    pub level: Level,
    /// Name of the component.
    pub name: String,
    /// Description of the status.
    pub message: String,
    /// Identifier of the hardware.
    pub hardware_id: String,
    /// Values that belong to the status.
    pub values: Vec<KeyValue>,
}

/// Content of a `diagnostic_msgs/msg/DiagnosticArray` message.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DiagnosticArray<'a> {
    /// Time and frame of reference.
    pub header: Header<'a>,
    /// Statuses of the components.
    pub status: &'a [DiagnosticStatus],
}

impl Message for DiagnosticArray<'_> {
    const SCHEMA: Schema = text::DIAGNOSTIC_ARRAY;
}
