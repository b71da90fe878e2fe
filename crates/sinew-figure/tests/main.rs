//! All tests of sinew-figure in one binary: one link, one start.

mod glance;
mod page;
mod plot;
