//! Camera measurement of a scale, tested with drawn pictures of known truth.

mod accuracy;
mod counting;
mod example;
mod rejections;
mod scale_picture;
mod series;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
