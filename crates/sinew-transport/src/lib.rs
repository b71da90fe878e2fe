//! Transports of the monitor: ROS 2 over DDS or Zenoh, a growing MCAP file, a replayed recording.
//!
//! A *transport* is a thread that receives raw messages. It puts them, with their time of reception, into a bounded
//! queue per robot: `inbox`. No message is decoded here, and no thread waits: a full queue drops the newest message
//! and counts it. [`FrameAssembler`] assembles frames from the messages of a queue with [`sinew_log::live`].
//!
//! Transports receive. A [`Publisher`] can send two kinds of messages, which can be switched off. Sinew never
//! commands a robot.
//!
//! Reading order: `received`, `inbox`, `intake`, `error`, `route`, `publish`; then a transport: `replay`, `tail`,
//! `dds`, `zenoh`; then `found`, the results of discovery.
//!
//! ```
//! use sinew_transport::{Inbox, FrameAssembler, QueueLimits, Received, BatchContent, TransportFault};
//! use sinew_log::live::LiveOptions;
//! use std::time::Duration;
//!
//! let inbox = Inbox::new();
//! let (robot, sender) = inbox.robot(QueueLimits::default());
//! // Side of the transport.
//! let topic = sender.topic("/joint_states", "sensor_msgs/msg/JointState");
//! let now = sinew_transport::Clock::start().now();
//! sender.message(topic, now, now.utc_ns, &[0, 1, 0, 0]);
//!
//! // Side of the monitor: the whole content of the queue at once.
//! let mut intake = FrameAssembler::new(&LiveOptions::of_joints(&["elbow".to_owned()])).expect("one joint");
//! let mut batch = Default::default();
//! assert_eq!(inbox.wait(Duration::from_secs(1)), Some(robot));
//! inbox.take(robot, &mut batch);
//! intake.feed(&batch, |taken| match taken {
//!     BatchContent::Frame { .. } => unreachable!("four bytes are no joint state"),
//!     BatchContent::Fault { fault, .. } => println!("{fault}"),
//!     BatchContent::Dropped { .. } => unreachable!("one message is not too many"),
//! });
//! assert_eq!(intake.live().health().undecodable, 1);
//! ```

mod error;
mod found;
mod handle;
mod inbox;
mod intake;
#[cfg(any(feature = "dds", feature = "zenoh"))]
mod look;
#[cfg(any(feature = "dds", feature = "zenoh"))]
mod network;
#[cfg(any(feature = "dds", feature = "zenoh"))]
mod outbox;
mod publish;
mod received;
mod records;
#[cfg(any(feature = "dds", feature = "zenoh"))]
mod ros_names;
mod route;

#[cfg(feature = "dds")]
pub mod dds;
pub mod replay;
pub mod tail;
#[cfg(feature = "zenoh")]
pub mod zenoh;

pub use error::{Durability, Policy, PublisherLoss, Reliability, TransportFault};
pub use found::{DomainFound, PublisherFound, TopicFound};
pub use handle::{Transport, TransportError, TransportStatus};
pub use inbox::{Batch, Inbox, Item, QueueLimits, RobotId, Sender, TopicKey};
pub use intake::{BatchContent, FrameAssembler};
pub use publish::{Outgoing, PublishError, Publisher, Publishing};
pub use received::{Clock, Received};
pub use route::{Route, Routes};
