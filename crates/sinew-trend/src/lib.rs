//! Trend of offsets over months: re-tensioning and replacement dates, and sudden events.
//!
//! [`read_records`] and [`sort`] load the records of many sessions, [`analyze`] returns each
//! tendon's present state, its events and the date of each limit exceedance, with intervals. The
//! estimator is [`filter`]; [`prior`] converts a rope creep law to its prior.

mod analyze;
mod clock;
mod error;
pub mod filter;
pub mod fleet;
mod inputs;
mod limits;
mod passage;
pub mod prior;
mod read;
mod records;
mod result;
mod stiffness;
pub mod stored;
pub mod survival;

pub use analyze::{
    ResumedTrend, TrendRequest, analyze, analyze_joint, analyze_with_progress, mean_temperature_c,
    resume_joint,
};
pub use clock::Stated;
pub use error::{AnalyzeError, RecordError};
pub use inputs::LoadedTrend;
pub use passage::{FirstPassage, Passage};
pub use read::{read_records, read_sessions, records_from_csv, records_from_json, sort_of};
pub use records::{SessionRecord, Sorted, sort};
pub use result::{
    CycleClock, ForecastPoint, JointTrend, LifeNotUsed, Limit, LimitForecast, LimitState,
    MissingFromRobot, PriorBasis, SessionPoint, StepCause, SuspectedStep, TrendEvent,
    TrendEventKind, TrendNote, TrendReport, TrendVerdict,
};
