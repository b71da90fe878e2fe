//! State of a trend between sessions.

use super::baseline_error::BaselineError;
use super::component::Component;
use super::record::{Event, TrendEntry};
use super::stiffness::Stiffness;
use super::stiffness_loss::StiffnessLossStats;

/// State of a trend: the filters before the last records, and those records.
#[derive(Debug, Clone, PartialEq)]
pub struct TrendState {
    /// Hash of the prior ([`super::Prior::fingerprint`]).
    pub fingerprint: u64,
    /// Time of the filters, s.
    pub time_s: f64,
    /// Filters before the last entries.
    pub components: Vec<Component>,
    /// Statistics of the stiffness since the last step change before the last entries, if any.
    pub stiffness_loss: Option<StiffnessLossStats>,
    /// Common error of the sessions since the baseline, before the last entries.
    pub baseline: BaselineError,
    /// Time of the last re-tensioning before the last entries, s.
    pub retensioned_s: Option<f64>,
    /// Stiffness before the last entries.
    pub stiffness: Stiffness,
    /// Entries of the window.
    pub entries: Vec<TrendEntry>,
    /// Confirmed and specified events so far.
    pub events: Vec<Event>,
    /// Number of records with an offset so far.
    pub records: u64,
}
