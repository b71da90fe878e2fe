//! Months of offsets: when to tension again, when to replace, and what happened suddenly.
//!
//! [`read_records`] and [`sort`] take the records of many sessions, [`analyze`] gives each tendon's
//! present state, its events and the day it will pass its limits, with intervals. The estimator is
//! [`sinew_model::trend`]; [`prior`] makes the rope's law its prior. [`year`] lives through simulated
//! years of robots and says how good all that is.

mod analyze;
mod limits;
pub mod prior;
mod read;
mod records;
mod result;
mod stiffness;
pub mod stored;
mod table;

pub use analyze::{AnalyzeError, Stated, TrendRequest, analyze};
pub use read::{read_records, records_from_csv, records_from_json};
pub use records::{RecordError, SessionRecord, Sorted, sort};
pub use result::{EventSaid, JointTrend, LimitSaid, Series, Suspicion, TrendReport, With95};
pub use table::write_csv;
