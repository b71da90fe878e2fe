//! Which poses to visit so that the offsets show.
//!
//! An offset is told from a wrong mass, a payload or a wrong stiffness only by how the torque
//! changes from pose to pose. [`propose`] looks for a short list of poses within the limits that
//! makes the interval of the absolute estimate small, by asking the estimator itself: each list is
//! visited in a synthetic recording of the nominal robot ([`Visit`]), and the interval that
//! `watch` gives on it is the figure of merit.
//!
//! Poses only: whether the way between them is free is not checked, and nothing here commands a
//! robot.

mod proposal;
mod search;
mod visit;

pub use proposal::{BaselineSource, Expected, Pose, Proposal};
pub use search::{Options, propose};
pub use visit::{Sensors, Visit};

use crate::session::SessionError;
use sinew_model::StepError;

/// Why no poses can be proposed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExcitationError {
    /// The robot has nothing to watch.
    #[error("{robot} has no elastic joint; give its joints stiffness_nm_per_rad in robot.toml")]
    Rigid {
        /// The robot.
        robot: String,
    },
    /// No pose within the limits can be held.
    #[error(
        "{robot}: none of {tried} random poses within the limits of the URDF can be held with {share:.0} % of the efforts there; check effort and masses"
    )]
    TooHeavy {
        /// The robot.
        robot: String,
        /// Poses tried.
        tried: usize,
        /// Share of the effort that holding may take, %.
        share: f64,
    },
    /// The model can't be evaluated.
    #[error("{robot}: {error}")]
    Model {
        /// The robot.
        robot: String,
        /// Why.
        error: StepError,
    },
    /// The estimator refused.
    #[error(transparent)]
    Absolute(#[from] Box<SessionError>),
}
