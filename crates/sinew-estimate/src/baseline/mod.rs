//! Baselines: what recordings since tensioning have taught about a robot, as a file, and what several
//! of them teach together.

mod file;
mod merge;

pub use file::Baseline;
pub use merge::{MergeOptions, MergeSummary, merge, pool};
