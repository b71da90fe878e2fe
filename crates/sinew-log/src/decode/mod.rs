//! Decoder of bytes to messages, without a file or a clock: names and offsets of the values.
//!
//! ```
//! use sinew_log::decode::{DecodeError, MessageKind, parse};
//!
//! let kind = MessageKind::of_schema("sensor_msgs/msg/JointState").expect("a type that is read");
//! // Cut off within the header.
//! let error = parse(kind, &[0, 1, 0, 0]).unwrap_err();
//! assert!(matches!(error, DecodeError::Short { .. }));
//! ```

mod cdr;
mod message;
mod ros1;

pub(crate) use cdr::Cdr;
pub use cdr::{DecodeError, set_stamp_ns, stamp_ns};
pub use message::{Entry, Field, Layout, MessageKind, Parsed, parse, rewrite};
pub(crate) use ros1::{ROS1, Ros1Kind};
