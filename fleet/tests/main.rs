//! Tests of the fleet, in one binary.

mod compare;
mod creep_known;
mod due;
mod folders;
mod functions;
mod outliers;
mod pool;
mod report;
mod simulated;
mod support;
