//! Tests of the C interface: results equal to the library, a status for any input, no allocation in a step.

// Calls of C functions, and an allocator that counts.
#![allow(unsafe_code)]

mod invalid_input;
mod memory;
mod same;
mod support;
