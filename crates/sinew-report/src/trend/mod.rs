//! The trend in words, as a table, as figures and as a page for whoever keeps the robots running.

mod csv;
mod page;
pub mod survival;
mod table;
mod terminal;
mod words;

pub use csv::trend_table;
pub use page::{figure, html, page};
pub use table::trend_series;
pub use terminal::render_table;
pub use words::format_note;
