//! Errors of construction and of evaluation.

use alloc::string::String;

/// Reason why a description of joints, motors and tendons is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// The number of transmissions differs from the number of joints.
    #[error(
        "{transmissions} transmissions for {joints} joints: pass one per joint, `None` for a rigid one"
    )]
    Transmissions {
        /// Number of joints.
        joints: usize,
        /// Number of transmissions.
        transmissions: usize,
    },
    /// A name is empty or occurs twice among elements of its kind.
    #[error("{of} name '{name}' is empty or occurs twice: give each {of} its own name")]
    Name {
        /// Kind of the element: joint, motor or tendon.
        of: &'static str,
        /// Name that is empty or not unique.
        name: String,
    },
    /// A tendon names a joint or motor that does not exist.
    #[error(
        "tendon '{tendon}' names {of} '{name}', which does not exist; choose one of: {existing}"
    )]
    Unknown {
        /// Name of the tendon.
        tendon: String,
        /// Kind of the element: joint or motor.
        of: &'static str,
        /// Name that was not found.
        name: String,
        /// Existing names, separated by commas.
        existing: String,
    },
    /// A tendon names a joint or motor twice.
    #[error("tendon '{tendon}' names {of} '{name}' twice: add the two values to one entry")]
    Twice {
        /// Name of the tendon.
        tendon: String,
        /// Kind of the element: joint or motor.
        of: &'static str,
        /// Name that occurs twice.
        name: String,
    },
    /// A tendon crosses no joint.
    #[error("tendon '{tendon}' crosses no joint: add a moment arm or remove the tendon")]
    NoJoint {
        /// Name of the tendon.
        tendon: String,
    },
    /// A value is out of range.
    #[error("{quantity} of {of} '{name}' is {value} {unit}: it must be {expected}")]
    Value {
        /// Kind of the element: joint or tendon.
        of: &'static str,
        /// Name of the element.
        name: String,
        /// Quantity, with the joint or motor it belongs to.
        quantity: String,
        /// Value that is out of range.
        value: f64,
        /// Unit of the value.
        unit: &'static str,
        /// Valid range, in words.
        expected: &'static str,
    },
    /// A strand that another strand pulls against has no pretension.
    #[error(
        "strand '{tendon}' pulls against '{other}' at joint '{joint}' and has no pretension: specify it"
    )]
    NoPretension {
        /// Name of the strand.
        tendon: String,
        /// Name of the strand that pulls the other way.
        other: String,
        /// Name of the joint that both cross.
        joint: String,
    },
    /// A joint has no tendon, no spring and no rigid drive.
    #[error("joint '{joint}' is not driven: add a tendon or a spring, or make it rigid")]
    NotDriven {
        /// Name of the joint.
        joint: String,
    },
    /// All tendons of a joint are strands that pull it the same way, and no spring pulls back.
    #[error(
        "all strands pull joint '{joint}' the same way and no spring pulls back: add a strand or a spring, or check the signs"
    )]
    OneSided {
        /// Name of the joint.
        joint: String,
    },
}

/// Reason why an evaluation was rejected. Cheap to copy; the state is unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// A slice has the wrong length, or the state belongs to another coupling.
    #[error("{input} has {found} entries, expected {expected}")]
    Length {
        /// Name of the argument.
        input: &'static str,
        /// Length that the coupling needs.
        expected: usize,
        /// Length that was passed.
        found: usize,
    },
    /// An input is NaN, infinite, or above 1e60 in size.
    #[error("{input} holds a value that is NaN, infinite or above 1e60")]
    NotFinite {
        /// Name of the argument.
        input: &'static str,
    },
    /// The moment arms of a group do not determine all of its joints.
    #[error("the moment arms of the group of joint {joint} have no full rank: no unique solution")]
    Singular {
        /// Index of the group's first joint.
        joint: usize,
    },
    /// A group has more or fewer tendons than joints, so that torques do not determine tensions.
    #[error("{tendons} tendons for {joints} joints: torques do not determine tensions")]
    NotSquare {
        /// Number of tendons.
        tendons: usize,
        /// Number of elastic joints.
        joints: usize,
    },
    /// A strand is slack, so that its elongation has a bound and no value.
    #[error("strand {tendon} is slack: its elongation turns no joint")]
    Slack {
        /// Index of the tendon.
        tendon: usize,
    },
}

/// Checks the length of an argument.
#[inline]
pub(super) fn check_length(
    input: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), EvaluationError> {
    if found == expected {
        return Ok(());
    }
    Err(EvaluationError::Length {
        input,
        expected,
        found,
    })
}
