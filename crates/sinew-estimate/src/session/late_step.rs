//! Changes in the last seconds of a recording: a contact that has not ended may look like one.

use super::recorder::Recorded;
use super::result::TendonChange;
use sinew_model::offset::Onset;

/// A contact longer than this looks like something that happened for good, s.
pub(super) const LASTING_S: f64 = 8.0;

/// Whether a change came so late that it may be a contact that had not ended yet. No encoder's slip looks like that.
pub(super) fn is_late(change: &TendonChange, recorded: &Recorded) -> bool {
    change.probability.is_some()
        && !is_encoder(change)
        && recorded.duration_s > 0.0
        && recorded.end_s() - change.time_s < LASTING_S
}

/// Whether an encoder's reading jumped: no contact looks like that, nor a rope.
pub(super) fn is_encoder(change: &TendonChange) -> bool {
    change.cause.is_some_and(|cause| cause.is_encoder())
}

/// A step in the last seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LateStep {
    pub(super) joint: usize,
    /// Beginning of the first block that shows it, s.
    pub(super) since_s: f64,
    /// Posterior probability that it is one, and no contact.
    pub(super) probability: f64,
}

impl LateStep {
    /// Two dates of one step differ by less, s: low-pass, friction, and the block.
    const NEAR_S: f64 = 1.5;

    /// Whether a change that was found is this step.
    pub(super) fn is(&self, joint: usize, change: &TendonChange) -> bool {
        joint == self.joint && (change.time_s - self.since_s).abs() < Self::NEAR_S
    }

    pub(super) fn onset(&self) -> Onset {
        Onset {
            joint: self.joint,
            at_s: self.since_s,
        }
    }
}
