//! All tests of sinew-rope in one binary: one link, one start.

mod spoiled_text;
