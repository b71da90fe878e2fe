//! All tests of sinew-rope in one binary: one link, one start.

#[path = "../../sinew-model/tests/model/answers.rs"]
mod answers;
mod corrupt_text;
mod coverage;
mod golden;
mod life;
mod relaxation;
mod rope_entry;
mod rope_law;
mod rope_reference;
mod rope_routing;
mod strung;
mod survival;
mod task;
