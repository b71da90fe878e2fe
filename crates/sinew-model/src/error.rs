//! What a step can refuse.

/// Why a step was refused. Cheap to copy; the state is unchanged whenever one is returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A slice doesn't have one entry per joint, or the workspace belongs to another arm.
    #[error("an input does not have one entry per joint of this arm")]
    Length,
    /// An input (or what follows from it) is NaN or infinite.
    #[error("an input is NaN or infinite")]
    NotFinite,
    /// A time step of zero, below zero, or not finite.
    #[error("the time step must be finite and above 0 s")]
    TimeStep,
    /// The mass matrix is not positive definite at this joint.
    #[error(
        "the mass matrix is not positive definite at joint {joint}: a joint carries no mass, or an inertia is not physical"
    )]
    NotPositiveDefinite {
        /// Index of the joint.
        joint: usize,
    },
    /// No link of that name.
    #[error("the arm has no link of that name")]
    UnknownLink,
}
