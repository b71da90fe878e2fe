//! Where a live monitor's messages come from: ROS 2 over DDS or Zenoh, an MCAP that grows, a recording played.
//!
//! A *door* is a thread that receives raw messages. It puts them, with the instant of their receipt, into a bounded
//! queue for each robot: `inbox`. Nothing here decodes a message, and nothing waits: a full queue drops the
//! newest message, counts it and says so. [`Intake`] makes frames of a queue's messages, by
//! [`sinew_log::live`].
//!
//! A door listens. What it can publish is a [`Publisher`]'s two messages, and those can be switched off. Sinew
//! never commands a robot.
//!
//! Reading order: `received`, `inbox`, `intake`, `trouble`, `route`, `publish`; then a door: `replay`, `tail`, `dds`, `zenoh`;
//! then `found`, what there is to watch.
//!
//! ```
//! use sinew_door::{Inbox, Intake, QueueLimits, Received, Taken, Trouble};
//! use sinew_log::live::LiveOptions;
//! use std::time::Duration;
//!
//! let inbox = Inbox::new();
//! let (robot, sender) = inbox.robot(QueueLimits::default());
//! // A door's side.
//! let topic = sender.topic("/joint_states", "sensor_msgs/msg/JointState");
//! let now = sinew_door::Clock::start().now();
//! sender.message(topic, now, now.utc_ns, &[0, 1, 0, 0]);
//!
//! // The monitor's side: what is ready, taken as a whole.
//! let mut intake = Intake::new(&LiveOptions::of_joints(&["elbow".to_owned()])).expect("one joint");
//! let mut batch = Default::default();
//! assert_eq!(inbox.wait(Duration::from_secs(1)), Some(robot));
//! inbox.take(robot, &mut batch);
//! intake.feed(&batch, |taken| match taken {
//!     Taken::Frame { .. } => unreachable!("four bytes are no joint state"),
//!     Taken::Trouble { trouble, .. } => println!("{trouble}"),
//!     Taken::Dropped { .. } => unreachable!("one message is not too many"),
//! });
//! assert_eq!(intake.live().health().undecodable, 1);
//! ```

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
mod trouble;

#[cfg(feature = "dds")]
pub mod dds;
pub mod replay;
pub mod tail;
#[cfg(feature = "zenoh")]
pub mod zenoh;

pub use found::{DomainFound, PublisherFound, TopicFound};
pub use handle::{Door, DoorError, DoorStatus};
pub use inbox::{Batch, Inbox, Item, QueueLimits, RobotId, Sender, TopicKey};
pub use intake::{Intake, Taken};
pub use publish::{Outgoing, PublishError, Publisher, Publishing};
pub use received::{Clock, Received};
pub use route::{Route, Routes};
pub use trouble::{Durability, Lost, Policy, Reliability, Trouble};
