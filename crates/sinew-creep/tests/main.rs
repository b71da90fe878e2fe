//! All tests of sinew-creep in one binary: one link, one start.

mod creep_forecast;
mod fits;
mod plan;
mod rope;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod support;
