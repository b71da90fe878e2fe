//! Plots, pages and numbers as Sinew shows them.

mod number;
mod page;
pub mod plot;

pub use number::{count, duration, given, rounded, share, with_interval};
pub use page::{Block, Headline, Level, Page, Section, Sentence, Table};
