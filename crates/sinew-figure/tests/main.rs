//! All tests of sinew-figure in one binary: one link, one start.

mod notebook;
mod page;
mod plot;
