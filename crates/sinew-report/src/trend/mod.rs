//! Trend of tendons: messages, terminal table, figures and HTML report for maintenance.

mod figure;
pub(crate) mod messages;
mod page;
mod series;
pub mod survival;
mod terminal;

pub use figure::figure;
pub use messages::{format_note, note_message};
pub use page::{html, page};
pub use series::{trend_series, trend_table};
pub use terminal::render_table;
