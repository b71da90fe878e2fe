//! Tests of the fleet, in one binary.

mod compare;
mod due;
mod folders;
mod functions;
mod outliers;
mod pool;
mod reference_creep;
mod report;
mod simulated;
mod support;
