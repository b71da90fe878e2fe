//! What a session's result is made from.

use super::recorder::Recorded;
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
