//! Tests of the fleet, in one binary.

mod due;
mod folders;
mod simulated;
mod support;
