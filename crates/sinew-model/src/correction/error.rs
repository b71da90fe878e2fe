//! Errors of creating or changing a correction.

use crate::observer::GainError;

/// Reason why a correction could not be created or changed. Cheap to copy, because parameters also
/// change during operation.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CorrectionError {
    /// Not one entry per joint.
    #[error("{found} entries for an arm of {expected} joints")]
    Length {
        /// Joints of the arm.
        expected: usize,
        /// Number of entries passed.
        found: usize,
    },
    /// Stiffness outside the permitted range.
    #[error(
        "stiffness of joint {joint} is {stiffness_nm_per_rad} N·m/rad; it must lie between 1e-9 and 1e12"
    )]
    Stiffness {
        /// Index of the joint.
        joint: usize,
        /// Stiffness, factor included, N·m/rad.
        stiffness_nm_per_rad: f64,
    },
    /// Stiffening outside the permitted range.
    #[error(
        "stiffening of joint {joint} is {cubic_per_rad2} 1/rad²; it must be at most 1e6 in size"
    )]
    Cubic {
        /// Index of the joint.
        joint: usize,
        /// Stiffening coefficient, 1/rad².
        cubic_per_rad2: f64,
    },
    /// An offset that is no offset.
    #[error("offset of joint {joint} is {delta_e} rad; it must be at most 1e6 rad in size")]
    Offset {
        /// Index of the joint.
        joint: usize,
        /// Offset of the joint, rad.
        delta_e: f64,
    },
    /// A standard deviation, share or bound that is negative, NaN or out of range.
    #[error("{what} of joint {joint} is {value}; it must be finite and {must}")]
    Tolerance {
        /// Name of the tolerance.
        what: &'static str,
        /// Index of the joint.
        joint: usize,
        /// Value that was passed.
        value: f64,
        /// Requirement on the value.
        must: &'static str,
    },
    /// A correction for a joint without an elastic transmission, or past the last.
    #[error("joint {joint} has no elastic transmission to correct")]
    Rigid {
        /// Index of the joint.
        joint: usize,
    },
    /// A tendon of a group with one equation per joint, as strands that pull against each other.
    #[error(
        "the tendon of axis {axis} pulls together with others at a joint: its elongation changes their tensions, which no position of a single motor compensates"
    )]
    JointEquations {
        /// Axis of the tendon.
        axis: usize,
    },
    /// A gain of the observer.
    #[error(transparent)]
    Gain(#[from] GainError),
    /// Filter cut-off outside the permitted range.
    #[error(
        "the velocity filter's cut-off is {cutoff_rad_per_s} rad/s; it must lie above 0 and at most 1e6"
    )]
    VelocityFilter {
        /// Cut-off given, rad/s.
        cutoff_rad_per_s: f64,
    },
}

impl CorrectionError {
    /// Returns the error with another joint index.
    pub(super) fn of_joint(self, at: usize) -> Self {
        match self {
            Self::Stiffness {
                stiffness_nm_per_rad,
                ..
            } => Self::Stiffness {
                joint: at,
                stiffness_nm_per_rad,
            },
            Self::Cubic { cubic_per_rad2, .. } => Self::Cubic {
                joint: at,
                cubic_per_rad2,
            },
            other => other,
        }
    }
}
