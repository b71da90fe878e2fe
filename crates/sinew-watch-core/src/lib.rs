//! What a monitor knows of a running robot: a state machine without sockets, clocks or threads.
//!
//! [`Monitor`] takes frames, ticks and commands, each with the [`Instant`] it came, and gives
//! [`Transaction`]s to store and a [`RobotSnapshot`] to show. A week replays in minutes, and a step of a
//! clock is a test. It listens only: nothing here commands a robot.
//!
//! Reading order: `instant`, `record`, `table`, `alarm`, `journal`, `transaction`, `command`, `snapshot` (what goes
//! in and out), then `monitor`, and `due` (what all robots come to).

pub mod alarm;
pub mod command;
mod condition;
pub mod due;
pub mod instant;
pub mod journal;
mod monitor;
pub mod record;
pub mod snapshot;
pub mod table;
pub mod transaction;

pub use instant::Instant;
pub use monitor::{
    AlarmOptions, ClockChoice, Done, HORIZON_DAYS, History, Job, Monitor, MonitorConfig,
    MonitorError, Stored, Times,
};
pub use record::Record;
pub use snapshot::RobotSnapshot;
pub use transaction::{Belief, Transaction};
