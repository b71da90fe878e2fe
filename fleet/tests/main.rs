//! Tests of the fleet, in one binary.

mod compare;
mod due;
mod folders;
mod outliers;
mod simulated;
mod support;
