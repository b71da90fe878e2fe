//! Messages, terminal tables and HTML reports of all results.
//!
//! A report is one HTML file with its style and figures, which loads nothing from the network. [`html`] renders an
//! [`EstimateDocument`](sinew_estimate::EstimateDocument) as a [`Page`](sinew_figure::Page). Text from files is escaped.
//! The output is deterministic: it contains neither dates nor paths other than those of the inputs.
//!
//! The sentences of a result are in its `messages` module, warnings of estimates in `warnings`. The file
//! `tests/golden/messages.txt` lists all of them with example values.

#[cfg(feature = "camera")]
pub mod camera;
pub mod creep;
mod data;
mod diagnostics;
mod each;
mod estimate;
mod estimate_table;
pub mod excitation;
mod figures;
mod format;
pub mod init;
pub mod log;
mod message;
pub mod robot;
pub mod rope;
mod session;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod text;
pub mod topics;
pub mod trend;
mod uncorrected;
mod units;
mod warnings;

pub use each::{each_summary, each_table, estimate_rows};
pub use estimate::{figure, html, page};
pub use estimate_table::estimate_series;
pub use message::Message;
pub use session::session_sentences;
pub use uncorrected::{headline, joint_error, loss_reason, nothing_estimated};
pub use warnings::{document_warnings, recording_warning, session_warning, session_warnings};
