//! What C may rely on: the same numbers, a status for whatever it hands over, no allocation in a step.

// A caller's side of an interface for C, and an allocator that counts.
#![allow(unsafe_code)]

mod memory;
mod refusals;
mod same;
mod support;
