//! What a correction can refuse when it is built or changed.

use crate::observer::GainError;

/// Why a correction could not be built or changed. Cheap to copy: changing is part of a step's life.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CorrectionError {
    /// Not one entry per joint.
    #[error("{found} entries given for an arm of {expected} joints")]
    Length {
        /// Joints of the arm.
        expected: usize,
        /// Entries given.
        found: usize,
    },
    /// A stiffness nobody has.
    #[error(
        "stiffness of joint {joint} is {stiffness_nm_per_rad} N·m/rad; it must lie between 1e-9 and 1e12"
    )]
    Stiffness {
        /// Index of the joint.
        joint: usize,
        /// Stiffness, factor included, N·m/rad.
        stiffness_nm_per_rad: f64,
    },
    /// A stiffening nobody has.
    #[error(
        "stiffening of joint {joint} is {cubic_per_rad2} 1/rad²; it must be at most 1e6 in size"
    )]
    Cubic {
        /// Index of the joint.
        joint: usize,
        /// Stiffening, 1/rad².
        cubic_per_rad2: f64,
    },
    /// An offset that is no offset.
    #[error("offset of joint {joint} is {delta_e} rad; it must be at most 1e6 rad in size")]
    Offset {
        /// Index of the joint.
        joint: usize,
        /// Offset, rad.
        delta_e: f64,
    },
    /// A standard deviation, share or bound that is negative, NaN or out of range.
    #[error("{what} of joint {joint} is {value}; it must be finite and {must}")]
    Tolerance {
        /// Which one.
        what: &'static str,
        /// Index of the joint.
        joint: usize,
        /// Value given.
        value: f64,
        /// What it may be.
        must: &'static str,
    },
    /// A correction for a joint without an elastic transmission, or past the last.
    #[error("joint {joint} has no elastic transmission to correct")]
    Rigid {
        /// Index of the joint.
        joint: usize,
    },
    /// A gain of the observer.
    #[error(transparent)]
    Gain(#[from] GainError),
    /// A filter frequency nobody can use.
    #[error(
        "the velocity filter's cut-off is {cutoff_rad_per_s} rad/s; it must lie above 0 and at most 1e6"
    )]
    VelocityFilter {
        /// Cut-off given, rad/s.
        cutoff_rad_per_s: f64,
    },
}

impl CorrectionError {
    /// The same, of another joint.
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
