//! Tests that generated code compiles without warnings and matches the generic code.

mod compiled;
mod robots;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod text;
