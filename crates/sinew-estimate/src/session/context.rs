//! What a session's result is made from.

use super::late_step::is_late;
use super::predictive::NEGLIGIBLE;
use super::recorder::Recorded;
use super::result::TendonChange;
use super::segments::Segments;
use sinew_model::offset::{MapEstimator, SharedError};
use sinew_model::robot::Robot;

/// What a result is made from.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub(super) estimator: &'a MapEstimator,
    pub(super) robot: &'a Robot,
    pub(super) recorded: &'a Recorded,
    pub(super) segments: &'a Segments,
    /// What is unknown of every joint's offset and looks the same in every block, rad; empty: nothing.
    pub(super) added_rad: &'a [f64],
    /// What of every joint's error comes with the baseline; empty: all of it.
    pub(super) shared: &'a [SharedError],
    /// By how much the lag between the sides was opened, s.
    pub(super) lag_s: f64,
}

impl Context<'_> {
    /// Whether a joint's change may be a contact that had not ended yet.
    pub(super) fn may_end(&self, joint: usize, change: &TendonChange) -> bool {
        is_late(change, self.recorded) && 1.0 - self.lasts(joint, change) > NEGLIGIBLE
    }

    /// Probability that a late change of a joint is none that ends: by the check of the last seconds, where that was made.
    pub(super) fn lasts(&self, joint: usize, change: &TendonChange) -> f64 {
        const UNKNOWN: f64 = 0.5;
        let step = self.segments.step.filter(|step| step.is(joint, change));
        step.map_or(UNKNOWN, |step| step.probability)
    }
}
