//! Tests of the monitor, in one binary.

mod alarms;
mod clocks;
mod jumps;
mod properties;
mod replay;
mod restart;
mod support;
mod tensioning;
