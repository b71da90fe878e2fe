//! Reports: one HTML file each, that opens offline, prints, and can be read on a telephone.
//!
//! [`html`] tells an [`EstimateDocument`](sinew_estimate::EstimateDocument); [`Page`](sinew_figure::Page) is what it and the paper's
//! figures are built with. A page holds its style and its figures; it loads nothing and runs no
//! script. Every word that comes from a file is escaped. The same data gives the same bytes: no
//! date, no path that wasn't given.

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
mod findings;
pub mod init;
pub mod log;
mod reading;
pub mod robot;
pub mod rope;
mod session;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod text;
pub mod topics;
pub mod trend;
mod units;
mod warnings;
mod words;

pub use each::{each_summary, each_table, estimate_rows};
pub use estimate::{html, page};
pub use estimate_table::estimate_series;
pub use reading::headline;
pub use session::session_sentences;
pub use warnings::{document_warnings, recording_warning, session_warning, session_warnings};
pub use words::{joint_refusal, loss_reason, nothing_estimated};
