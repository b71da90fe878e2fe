//! The trend in words, as a table, as figures and as a page for whoever keeps the robots running.

mod csv;
mod page;
mod terminal;
mod words;

pub use csv::write_csv;
pub use page::{figure, html};
pub use terminal::render_table;
pub use words::format_note;
