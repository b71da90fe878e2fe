//! Monitor of a running robot: a state machine without sockets, clocks or threads.
//!
//! [`Monitor`] receives frames, ticks and commands, each with the [`Instant`] of its arrival, and returns
//! [`Transaction`]s to store and a [`RobotSnapshot`] to publish. A week can be replayed in minutes, and steps of a
//! clock can be tested. The monitor is passive: nothing here commands a robot.
//!
//! Reading order: `instant`, `record`, `table`, `alarm`, `incident`, `journal`, `history`, `transaction`, `command`,
//! `snapshot` (inputs and outputs), then `monitor`, and `due` (maintenance list of all robots).

pub mod alarm;
pub mod command;
mod condition;
pub mod due;
mod history;
pub mod incident;
pub mod instant;
pub mod journal;
mod monitor;
pub mod record;
pub mod snapshot;
pub mod table;
#[cfg(test)]
mod tests;
pub mod transaction;

pub use history::History;
pub use instant::Instant;
pub use monitor::{
    AlarmOptions, ClockChoice, HORIZON_DAYS, JobResult, Monitor, MonitorConfig, MonitorError,
    QueuedJob, Stored, Times,
};
pub use record::Record;
pub use snapshot::RobotSnapshot;
pub use transaction::{MonitorState, Transaction};
