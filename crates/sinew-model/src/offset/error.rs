//! Errors of the estimate.

/// Reason why there is no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Nothing to estimate from.
    #[error("the recording has no complete block of data")]
    NoData,
    /// The prior's covariance is not one.
    #[error("the prior's covariance is not positive definite at entry {0}")]
    Prior(usize),
    /// The prior belongs to another robot.
    #[error("the prior has {found} entries, this robot needs {expected}")]
    Dimension {
        /// Number of entries that the robot requires.
        expected: usize,
        /// Number of entries that were passed.
        found: usize,
    },
}
