//! The command `sinew`, inside the wheel.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command line and returns its exit code; once per process.
#[pyfunction]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| sinew::run(arguments))
}
