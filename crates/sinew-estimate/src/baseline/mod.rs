//! Baselines: posteriors from the recordings of a robot since tensioning, as files, and merging of several
//! of them.

mod file;
mod merge;

pub use file::Baseline;
pub use merge::{MergeOptions, MergeSummary, merge, pool};
