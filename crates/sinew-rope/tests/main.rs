//! All tests of sinew-rope in one binary: one link, one start.

#[path = "../../sinew-model/tests/model/answers.rs"]
mod answers;
mod coverage;
mod known_rope;
mod life;
mod relaxation;
mod rope_entry;
mod rope_law;
mod rope_reference;
mod rope_routing;
mod spoiled_text;
mod strung;
mod survival;
mod task;
