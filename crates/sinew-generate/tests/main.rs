//! What is written compiles without a warning and gives what the generic code gives.

mod compiled;
mod robots;
mod text;
