//! Reading a scale by camera, against drawn pictures whose truth is known.

mod accuracy;
mod counting;
mod example;
mod rejections;
mod scale_picture;
mod series;
#[path = "../../sinew-files/tests/support/skipped.rs"]
mod skipped;
