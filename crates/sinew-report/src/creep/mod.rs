//! Creep tests as terminal tables, CSV and an HTML page, a file a result.

mod analyze;
mod compare;
mod fit;
mod groups;
mod isochronous;
mod page;
mod picture;
mod plan;
mod series;
mod shift;
mod specimen;
mod withhold;
mod words;

pub use analyze::{analyze_csv, analyze_page, analyze_table};
pub use compare::{compare_csv, compare_page, compare_table};
pub use fit::{fit_csv, fit_page, fit_table};
pub use groups::group_table;
pub use picture::{figure, plotted};
pub use plan::{plan_programme, plan_table};
pub use series::{fit_series, readings_series};
pub use shift::{shift_csv, shift_table};
pub use withhold::{withhold_csv, withhold_page, withhold_table};
