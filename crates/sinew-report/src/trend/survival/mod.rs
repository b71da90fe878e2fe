//! Rope lifetimes: messages, terminal table, figure and HTML report.

pub(crate) mod messages;
mod page;
mod terminal;

pub use messages::{format_note, note_message};
pub use page::{figure, html};
pub use terminal::render_table;
