//! Inputs of the result of a session.

use super::late_step::is_late;
use super::predictive::NEGLIGIBLE;
use super::recorder::Recorded;
use super::result::TendonChange;
use super::segments::Segments;
use super::transmission_loss::TransmissionLoss;
use sinew_model::offset::{MapEstimator, SharedError};
use sinew_model::robot::Robot;

/// Inputs of the result of a session.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub(super) estimator: &'a MapEstimator,
    pub(super) robot: &'a Robot,
    pub(super) recorded: &'a Recorded,
    pub(super) segments: &'a Segments,
    /// Standard deviation of each joint's offset from errors that are constant over all blocks, rad; empty if there are
    /// none.
    pub(super) added_rad: &'a [f64],
    /// Systematic error of each joint from the baseline; empty if the whole error is systematic.
    pub(super) shared: &'a [SharedError],
    /// Prior standard deviation of the time offset between the encoders, s.
    pub(super) lag_s: f64,
    /// Whether offsets are elongations ([`super::result::SessionEstimate::is_elongation`]).
    pub(super) is_elongation: bool,
    /// Standard deviation of the encoder zeros, rad, if offsets are elongations because of it.
    pub(super) zero_std_rad: Option<f64>,
    /// Transmissions that were lost.
    pub(super) losses: &'a [TransmissionLoss],
}

impl Context<'_> {
    /// Loss of the transmission of a joint; `None` if it transmits torque.
    pub(super) fn loss(&self, joint: usize) -> Option<TransmissionLoss> {
        self.losses.iter().copied().find(|loss| loss.joint == joint)
    }

    /// Whether a change of a joint may be a contact that has not ended.
    pub(super) fn may_end(&self, joint: usize, change: &TendonChange) -> bool {
        is_late(change, self.recorded) && 1.0 - self.lasts(joint, change) > NEGLIGIBLE
    }

    /// Probability that a late change of a joint is permanent, from the check of the last seconds; 0.5 without that
    /// check.
    pub(super) fn lasts(&self, joint: usize, change: &TendonChange) -> f64 {
        const UNKNOWN: f64 = 0.5;
        let step = self.segments.step.filter(|step| step.is(joint, change));
        step.map_or(UNKNOWN, |step| step.probability)
    }
}
