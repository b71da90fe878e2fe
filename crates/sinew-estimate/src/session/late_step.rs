//! Changes in the last seconds of a recording, which a contact that has not ended may imitate.

use super::recorder::Recorded;
use super::result::TendonChange;
use sinew_model::offset::Onset;

/// Maximum duration of a contact, s: a longer one is indistinguishable from a permanent change.
pub(super) const LASTING_S: f64 = 8.0;

/// Whether a change is so close to the end that it may be a contact that has not ended. A contact never imitates an
/// encoder slip.
pub(super) fn is_late(change: &TendonChange, recorded: &Recorded) -> bool {
    change.probability.is_some()
        && !is_encoder(change)
        && recorded.duration_s > 0.0
        && recorded.end_s() - change.time_s < LASTING_S
}

/// Whether a change is a step of an encoder reading, which neither a contact nor a rope causes.
pub(super) fn is_encoder(change: &TendonChange) -> bool {
    change.cause.is_some_and(|cause| cause.is_encoder())
}

/// Step change in the last seconds of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LateStep {
    pub(super) joint: usize,
    /// Start of the first block that shows the step, s.
    pub(super) since_s: f64,
    /// Posterior probability of a step rather than a contact.
    pub(super) probability: f64,
}

impl LateStep {
    /// Maximum difference of two time estimates of one step, s: low-pass filter, friction and block length.
    const MAX_TIME_DIFFERENCE_S: f64 = 1.5;

    /// Whether a detected change of a joint is this step.
    pub(super) fn is(&self, joint: usize, change: &TendonChange) -> bool {
        joint == self.joint && (change.time_s - self.since_s).abs() < Self::MAX_TIME_DIFFERENCE_S
    }

    pub(super) fn onset(&self) -> Onset {
        Onset {
            joint: self.joint,
            at_s: self.since_s,
        }
    }
}
