//! The trend in words, as a table, as figures and as a page for whoever keeps the robots running.

mod figure;
mod page;
mod series;
pub mod survival;
mod terminal;
mod words;

pub use figure::figure;
pub use page::{html, page};
pub use series::{trend_series, trend_table};
pub use terminal::render_table;
pub use words::format_note;
