//! How long ropes last, in words, as a table, as a figure and as a page.

mod page;
mod terminal;
mod words;

pub use page::{figure, html};
pub use terminal::render_table;
pub use words::format_note;
