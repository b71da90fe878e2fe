//! Why a creep test can't be analysed.

/// What was wrong, with the numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CreepError {
    /// Fewer readings than numbers to fit.
    #[error("{law} needs {needed} readings, there are {readings}")]
    TooFew {
        /// The law.
        law: &'static str,
        /// Readings there are.
        readings: usize,
        /// Readings needed.
        needed: usize,
    },
    /// The strain doesn't change.
    #[error("{0}: the strain doesn't change: not connected, or the wrong column?")]
    Flat(String),
    /// No start of the search had a finite cost.
    #[error("{0}: no finite cost from any start of the search")]
    NotFinite(&'static str),
    /// A specimen's readings don't make a creep test.
    #[error("{specimen}: {reason}")]
    Specimen {
        /// Name of the specimen.
        specimen: String,
        /// What was found, and what to do.
        reason: String,
    },
    /// A wrong request.
    #[error("{0}")]
    Request(String),
}
