//! Errors of a step.

/// Reason why a step was rejected. Cheap to copy; the state is unchanged whenever one is returned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// A slice does not have one entry per joint, or the workspace belongs to another arm.
    #[error("an input does not have one entry per joint of this arm")]
    Length,
    /// An input (or what follows from it) is NaN or infinite.
    #[error("an input is NaN or infinite")]
    NotFinite,
    /// A time step that is not between 1e-9 s and 1e9 s.
    #[error("the time step must lie between 1e-9 s and 1e9 s")]
    TimeStep,
    /// The mass matrix is not positive definite at this joint.
    #[error(
        "the mass matrix is not positive definite at joint {joint}: a joint carries no mass, or an inertia is not physical"
    )]
    NotPositiveDefinite {
        /// Index of the joint.
        joint: usize,
    },
    /// The torque exceeds the maximum of a softening spring.
    #[error("the torque exceeds the maximum of the softening spring of joint {joint}")]
    Spring {
        /// Index of the joint.
        joint: usize,
    },
    /// No link of that name.
    #[error("the arm has no link of that name")]
    UnknownLink,
}

/// Whether a step can be taken: from the nanosecond of a recording's clock to thirty years.
/// Beyond, quotients and products of finite inputs could overflow.
#[inline]
pub(crate) fn is_time_step(dt_s: f64) -> bool {
    (1e-9..=1e9).contains(&dt_s)
}

/// Whether an input (rad, rad/s, N·m) is a number that no pass overflows on. Seventy orders of
/// magnitude above any robot, far enough below 1e308 for squares divided by a nanosecond.
#[inline]
pub(crate) fn is_input(value: f64) -> bool {
    value.abs() < 1e60
}
