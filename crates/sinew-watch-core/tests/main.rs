//! Tests of the monitor, in one binary.

mod alarms;
mod clocks;
mod due;
mod health;
mod limits;
mod properties;
mod replay;
mod restart;
mod step_changes;
mod support;
mod tensioning;
