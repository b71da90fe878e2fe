//! Tests of the monitor, in one binary.
