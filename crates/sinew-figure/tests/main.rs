//! All tests of sinew-figure in one binary: one link, one start.

mod page;
mod plot;
