//! What a trend remembers from one session to the next.

use super::baseline_error::BaselineError;
use super::component::Component;
use super::record::{Event, TrendEntry};
use super::softened::Softened;
use super::stiffness::Stiffness;

/// What a trend remembers: the filters before the last records, and those.
#[derive(Debug, Clone, PartialEq)]
pub struct TrendState {
    /// [`super::Prior::fingerprint`].
    pub fingerprint: u64,
    /// Time of the filters, s.
    pub time_s: f64,
    /// The filters.
    pub components: Vec<Component>,
    /// The stiffness since the last jump before the last entries, if there was one.
    pub softened: Option<Softened>,
    /// What sessions since the baseline get wrong together, before the last entries.
    pub baseline: BaselineError,
    /// The stiffness before the last entries.
    pub stiffness: Stiffness,
    /// Last entries.
    pub entries: Vec<TrendEntry>,
    /// Events so far.
    pub events: Vec<Event>,
    /// Records with an offset so far.
    pub records: u64,
}
