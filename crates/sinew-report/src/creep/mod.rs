//! Creep tests as terminal tables, machine-readable tables and HTML reports, one file per result.

mod analyze;
mod compare;
mod fit;
mod groups;
mod hold_out;
mod isochronous;
pub(crate) mod messages;
mod page;
mod picture;
mod plan;
mod series;
mod shift;
mod specimen;

pub use analyze::{analyze_csv, analyze_page, analyze_table};
pub use compare::{compare_csv, compare_page, compare_table};
pub use fit::{fit_csv, fit_page, fit_table};
pub use groups::group_table;
pub use hold_out::{hold_out_csv, hold_out_page, hold_out_table};
pub use picture::{figure, plotted};
pub use plan::{plan_programme, plan_table};
pub use series::{fit_series, readings_series};
pub use shift::{shift_csv, shift_table};
