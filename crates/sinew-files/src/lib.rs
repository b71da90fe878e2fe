//! Text in, files out.
//!
//! * [`atomic`]: output files that are whole or not there.

pub mod atomic;

pub use atomic::{AtomicFile, OutputError, write_file};
