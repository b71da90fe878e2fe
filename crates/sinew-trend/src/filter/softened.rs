//! What sessions after a failed strand get wrong together: stiffness and offset.

use super::record::Record;

/// Sessions before which the stiffness is not known well enough to say what is off.
const FEWEST: u64 = 6;
/// Sessions that count at most, so that a stiffness that goes on changing is followed.
const MEMORY: f64 = 50.0;
/// At most so many of its own standard deviations of a session count: beyond that it is no error.
const MOST: f64 = 2.0;

/// The stiffness of a tendon since its last jump.
///
/// A session that has to find a lost stiffness anew shares its error out between stiffness and offset:
/// one that finds too stiff a tendon finds too long a rope. The stiffness itself stays, so that what a
/// session has it off the mean by is its error, and says which way its offset is off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softened {
    /// Mean, over nominal less 1.
    pub mean: f64,
    /// Sum of the sessions' information about the offset, 1/rad².
    pub information: f64,
    /// Sessions so far.
    pub sessions: u64,
}

impl Softened {
    pub(super) fn new() -> Self {
        Self {
            mean: 0.0,
            information: 0.0,
            sessions: 0,
        }
    }

    /// Whether it can be one.
    pub(super) fn is_possible(&self) -> bool {
        self.mean.is_finite() && self.information.is_finite() && self.information >= 0.0
    }

    /// By how much a session has the stiffness off; 0 where that isn't known.
    pub(super) fn off(&self, record: &Record) -> f64 {
        match record.credible_stiffness() {
            Some(s) if self.sessions >= FEWEST => {
                (s.mean - self.mean).clamp(-MOST * s.deviation, MOST * s.deviation)
            }
            _ => 0.0,
        }
    }

    /// Takes a session in: it counts by what it says of the offset, so that where the level stands does
    /// not depend on how the errors go together.
    pub(super) fn take(&mut self, record: &Record) {
        let (Some(stiffness), Some(offset)) = (record.credible_stiffness(), record.offset_rad)
        else {
            return;
        };
        let own = 1.0 / (offset.deviation * offset.deviation);
        if !own.is_finite() {
            return;
        }
        self.sessions += 1;
        self.information = (self.information * (1.0 - 1.0 / MEMORY)) + own;
        self.mean += own / self.information * (stiffness.mean - self.mean);
    }
}
