//! All tests of sinew-rope in one binary: one link, one start.

mod coverage;
mod life;
mod relaxation;
mod spoiled_text;
mod task;
