//! Search for poses that make the offsets identifiable.
//!
//! An offset is separable from a mass error, a payload or a stiffness error only by the change of the torque
//! from pose to pose. [`propose`] searches a short list of poses within the limits that
//! minimises the interval of the absolute estimate: each list is
//! visited in a synthetic recording of the nominal robot ([`Visit`]), and the interval that
//! the estimator returns for it is the figure of merit.
//!
//! The paths between the poses are not checked for collisions, and nothing here commands a robot.

mod proposal;
mod search;
mod visit;

pub use proposal::{BaselineSource, Expected, Pose, Proposal};
pub use search::{Options, propose};
pub use visit::{Sensors, Visit};

use crate::session::SessionError;
use sinew_model::StepError;

/// Error of a pose search.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExcitationError {
    /// The robot has no elastic joint.
    #[error(
        "{robot} has no elastic joint; specify stiffness_nm_per_rad of its joints in robot.toml"
    )]
    Rigid {
        /// Name of the robot.
        robot: String,
    },
    /// Tendons are estimated with one equation per joint, which the search does not support.
    #[error(
        "{robot}: pose search does not support tendons with one equation per joint ({tendons}); record a motion over the range of every joint that varies the co-contraction, with the torque of every motor or the tension of every tendon"
    )]
    JointEquations {
        /// Name of the robot.
        robot: String,
        /// Names of the tendons.
        tendons: String,
    },
    /// No pose within the limits can be held statically.
    #[error(
        "{robot}: none of {tried} random poses within the limits of the URDF can be held with {share:.0} % of the effort limits; check effort limits and masses"
    )]
    TooHeavy {
        /// Name of the robot.
        robot: String,
        /// Number of poses tried.
        tried: usize,
        /// Maximum share of the effort limit for holding a pose, %.
        share: f64,
    },
    /// The model of the arm cannot be evaluated.
    #[error("{robot}: {error}")]
    Model {
        /// Name of the robot.
        robot: String,
        /// Error of the model.
        error: StepError,
    },
    /// The estimator has no solution.
    #[error(transparent)]
    Absolute(#[from] Box<SessionError>),
}
