//! All tests of sinew-creep in one binary: one link, one start.

#[path = "../../sinew-model/tests/model/answers.rs"]
mod answers;
mod creep_forecast;
mod fits;
mod golden;
mod plan;
mod rope;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
mod support;
mod test_files;
mod test_files_of_others;
