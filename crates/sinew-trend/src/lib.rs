//! Months of offsets: when to tension again, when to replace, and what happened suddenly.
//!
//! [`read_records`] and [`sort`] take the records of many sessions, [`analyze`] gives each tendon's
//! present state, its events and the day it will pass its limits, with intervals. The estimator is
//! [`filter`]; [`prior`] makes the rope's law its prior.

mod analyze;
mod clock;
mod error;
pub mod filter;
mod given;
mod limits;
mod passage;
pub mod prior;
mod read;
mod records;
mod result;
mod stiffness;
pub mod stored;
pub mod survival;

pub use analyze::{GoneOn, TrendRequest, analyze, analyze_joint, go_on, mean_temperature_c};
pub use clock::Stated;
pub use error::{AnalyzeError, RecordError};
pub use given::KeptTrend;
pub use passage::{Passage, PassageTimes};
pub use read::{read_records, read_sessions, records_from_csv, records_from_json, sort_of};
pub use records::{SessionRecord, Sorted, sort};
pub use result::{
    CycleClock, ForecastPoint, JointTrend, JumpCause, LifeNotUsed, Limit, LimitForecast,
    LimitState, MissingFromRobot, PriorBasis, SessionPoint, Suspicion, TrendEvent, TrendEventKind,
    TrendNote, TrendReport, TrendVerdict,
};
