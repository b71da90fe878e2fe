//! Tests of the monitor, in one binary.

mod alarms;
mod clocks;
mod due;
mod health;
mod jumps;
mod limits;
mod properties;
mod replay;
mod restart;
mod support;
mod tensioning;
