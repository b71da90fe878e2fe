//! Encoder of messages to CDR bytes, without a file or a clock; the inverse of [`decode`](crate::decode).
//!
//! ```
//! use sinew_log::decode::{MessageKind, parse};
//! use sinew_log::encode::{DynamicJointState, Header, InterfaceValue, Message as _};
//!
//! let names = ["elbow".to_owned()];
//! let values = [InterfaceValue { interface_names: &["offset"], values: &[0.0127] }];
//! let message = DynamicJointState {
//!     header: Header::at(1_700_000_000_000_000_000, "").expect("before 2038"),
//!     joint_names: &names,
//!     interface_values: &values,
//! };
//! let mut bytes = Vec::new();
//! message.encode(&mut bytes)?;
//! let parsed = parse(MessageKind::DynamicJointState, &bytes).expect("as written");
//! assert_eq!(parsed.names, [b"elbow"]);
//! # Ok::<(), sinew_log::encode::EncodeError>(())
//! ```

mod messages;
mod text;

pub use messages::{
    DiagnosticArray, DiagnosticStatus, DynamicJointState, Header, InterfaceValue, JointState,
    KeyValue, Level, Stamp, Text,
};

use byteorder::LittleEndian;
use serde::Serialize;

/// Plain little-endian CDR.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Error of encoding a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("CDR: {0}")]
pub struct EncodeError(String);

/// A type of ROS 2, as containers name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schema {
    /// Name of the type, such as `sensor_msgs/msg/JointState`.
    pub name: &'static str,
    /// Definition of the type with its dependencies (`ros2msg`).
    pub text: &'static str,
}

/// A message of ROS 2.
pub trait Message: Serialize + Sized {
    /// Type of the message.
    const SCHEMA: Schema;

    /// Replaces `bytes` by the message as little-endian CDR with its encapsulation header.
    ///
    /// # Errors
    /// [`EncodeError`]: a string or sequence too long for CDR.
    fn encode(&self, bytes: &mut Vec<u8>) -> Result<(), EncodeError> {
        bytes.clear();
        bytes.extend_from_slice(&ENCAPSULATION);
        cdr_encoding::to_writer::<_, LittleEndian, _>(bytes, self)
            .map_err(|error| EncodeError(error.to_string()))
    }
}
