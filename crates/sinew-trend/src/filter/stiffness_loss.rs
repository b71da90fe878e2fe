//! Common error of stiffness and offset in the sessions after a strand failure.

use super::record::Record;

/// Minimum number of sessions before the stiffness error of a session is used.
const MIN_SESSIONS: u64 = 6;
/// Maximum effective number of sessions, so that a changing stiffness is tracked.
const MEMORY: f64 = 50.0;
/// Maximum stiffness error of a session, in its standard deviations; a larger one is not an error.
const MAX_ERROR_STDS: f64 = 2.0;

/// Statistics of a tendon's stiffness since its last step change.
///
/// A session that has to estimate a lost stiffness again distributes its error between stiffness
/// and offset: a stiffness that is too high gives an elongation that is too large. The stiffness
/// itself is constant, so that the difference of a session from the mean is its error, and
/// indicates the sign of its offset error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StiffnessLossStats {
    /// Mean stiffness over nominal less 1.
    pub mean: f64,
    /// Sum of the sessions' information about the offset, 1/rad².
    pub information: f64,
    /// Number of sessions so far.
    pub sessions: u64,
}

impl StiffnessLossStats {
    pub(super) fn new() -> Self {
        Self {
            mean: 0.0,
            information: 0.0,
            sessions: 0,
        }
    }

    /// Whether all values are valid.
    pub(super) fn is_possible(&self) -> bool {
        self.mean.is_finite() && self.information.is_finite() && self.information >= 0.0
    }

    /// Stiffness error of a session; 0 if unknown.
    pub(super) fn off(&self, record: &Record) -> f64 {
        match record.credible_stiffness() {
            Some(s) if self.sessions >= MIN_SESSIONS => {
                (s.mean - self.mean).clamp(-MAX_ERROR_STDS * s.std, MAX_ERROR_STDS * s.std)
            }
            _ => 0.0,
        }
    }

    /// Updates the statistics with a session, weighted by its information about the offset, so that
    /// the level does not depend on the correlation of the errors.
    pub(super) fn take(&mut self, record: &Record) {
        let (Some(stiffness), Some(offset)) = (record.credible_stiffness(), record.offset_rad)
        else {
            return;
        };
        let own = 1.0 / (offset.std * offset.std);
        if !own.is_finite() {
            return;
        }
        self.sessions += 1;
        self.information = (self.information * (1.0 - 1.0 / MEMORY)) + own;
        self.mean += own / self.information * (stiffness.mean - self.mean);
    }
}
