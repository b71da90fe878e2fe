//! All tests of sinew-rope in one binary: one link, one start.

mod relaxation;
mod spoiled_text;
