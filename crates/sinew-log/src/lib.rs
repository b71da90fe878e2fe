//! Recordings of tendon-driven robots as frames: MCAP/ROS 2, CSV, Parquet.

mod frame;
mod health;
mod options;
mod recording;

mod join;
mod mapping;
mod mcap_read;
mod table;
mod write;

mod error;

pub use error::{LogError, Place};
pub use frame::{Channels, Frame, Quantities, Quantity};
pub use health::{Damage, EVENT_LIMIT, Event, EventKind, Health, SignalCount};
pub use mapping::Mapping;
pub use options::{JointEffort, OpenOptions};
pub use recording::{Format, Progress, ReadSeek, Recording, open};
pub use write::{Compression, CsvWriter, FrameWriter, McapOptions, McapWriter};
