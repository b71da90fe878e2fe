//! What is written compiles without a warning and gives what the generic code gives.

mod compiled;
mod robots;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod text;
