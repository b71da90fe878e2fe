//! Why there is no estimate.

/// Why there is no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Nothing to estimate from.
    #[error("the recording has no complete block of data")]
    NoData,
    /// The prior's covariance is not one.
    #[error("the prior's covariance is not positive definite at entry {0}")]
    Prior(usize),
    /// Prior and robot don't go together.
    #[error("the prior has {found} entries, this robot needs {expected}")]
    Dimension {
        /// Entries needed.
        expected: usize,
        /// Entries given.
        found: usize,
    },
}
