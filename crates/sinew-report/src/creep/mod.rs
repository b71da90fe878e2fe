//! Creep tests as terminal tables, CSV and an HTML page.

mod answers;
mod csv;
mod fit_tables;
mod group_table;
mod isochronous;
mod page;
mod page_tables;
mod picture;
mod plan;
mod series;
mod terminal;
mod words;

pub use csv::{analyze_csv, compare_csv, fit_csv, shift_csv, withhold_csv};
pub use fit_tables::fit_table;
pub use group_table::group_table;
pub use page::{analyze_page, compare_page, fit_page, withhold_page};
pub use picture::{figure, plotted};
pub use plan::{plan_programme, plan_table};
pub use series::{fit_series, readings_series};
pub use terminal::{analyze_table, compare_table, shift_table, withhold_table};
