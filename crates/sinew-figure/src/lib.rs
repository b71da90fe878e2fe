//! Plots, HTML pages and number formats of Sinew.

mod glance;
mod page;
pub mod plot;
mod table;

pub use glance::glance;
pub use page::{Block, Headline, Level, Page, Section, Sentence};
pub use sinew_files::number::{
    count, duration, given, interval_cells, probability, rounded, share, with_interval,
};
pub use table::{Columns, Table};
